"""Pedestrians: groups 11 and 12 of NHTSA's 37 pre-crash scenarios."""
