"""CARLA 0.9.16's protocol without a socket: typed values, and their encoding as bytes."""
