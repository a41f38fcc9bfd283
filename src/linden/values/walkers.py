"""What a client says to a walker. Source: ``carla/rpc/WalkerControl.h``."""

from typing import NamedTuple

from linden.values.space import Vector3D


class WalkerControl(NamedTuple):
    """Unit direction in the world, speed in m/s, and whether to jump."""

    direction: Vector3D = Vector3D(1.0, 0.0, 0.0)
    speed: float = 0.0
    jump: bool = False
