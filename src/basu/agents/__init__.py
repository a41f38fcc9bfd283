"""Drivers to be judged, and the base class of everybody's own."""
