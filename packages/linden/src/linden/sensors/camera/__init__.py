"""Cameras: attributes, pixel rays, and images of what the rays hit."""
