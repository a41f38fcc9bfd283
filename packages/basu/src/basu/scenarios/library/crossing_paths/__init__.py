"""Scenarios with vehicles that cross or join the ego's way at a junction."""
