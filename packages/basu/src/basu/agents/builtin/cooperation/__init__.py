"""Texts by which shuttles cooperate: people in the way, the order at stop signs, departures from stops."""
