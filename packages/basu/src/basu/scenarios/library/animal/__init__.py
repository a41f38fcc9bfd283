"""Animals: groups 9 and 10 of NHTSA's 37 pre-crash scenarios. On the original CARLA walkers stand in."""
