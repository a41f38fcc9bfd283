"""Traffic scenarios: actors, a behaviour tree and criteria at a place of a town, told to a ``Stage``."""
