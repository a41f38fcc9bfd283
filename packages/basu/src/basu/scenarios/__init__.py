"""Traffic scenarios: actors, a behaviour tree and criteria at a place of a town, played on a ``Stage``."""
