"""A CARLA 0.9.16 server in Python: no Unreal, no GPU, the same answer every time."""

__version__ = "0.1.0"
CARLA_VERSION = "0.9.16"
"""The release of the wire protocol; the official client compares it with its own."""
