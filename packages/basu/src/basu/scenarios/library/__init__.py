"""The scenarios that come with BASU: one file a scenario, found by themselves (`library`)."""
