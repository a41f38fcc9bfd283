"""The state of an episode and the functions that change it; no sensors, no network."""
