"""Cameras: what their attributes mean, which rays their pixels are, and the pictures made of what the rays meet."""
