"""What CARLA's server tells of a recording as text: its contents, its collisions, who was blocked in it."""
