"""Pedalcyclists: groups 13 and 14 of NHTSA's 37 pre-crash scenarios."""
