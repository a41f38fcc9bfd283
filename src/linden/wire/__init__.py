"""Bytes to values and back, as CARLA 0.9.16 speaks them. No socket, no thread."""
