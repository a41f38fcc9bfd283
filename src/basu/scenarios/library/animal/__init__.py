"""Animals: groups 9 and 10 of NHTSA's 37 pre-crash scenarios. CARLA has none: walkers of a child's size stand in."""
