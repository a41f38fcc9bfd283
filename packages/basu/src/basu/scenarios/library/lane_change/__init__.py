"""Scenarios with vehicles that change or drift into the ego's lane."""
