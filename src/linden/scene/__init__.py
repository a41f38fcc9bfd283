"""What stands in the world besides actors, and what a ray meets."""
