"""Scenarios with oncoming vehicles in the ego's own lane."""
