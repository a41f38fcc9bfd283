"""Shapes that a client draws into the world. Source: ``carla/rpc/DebugShape.h``, 0.9.16. Metres, seconds."""

from typing import NamedTuple, TypeAlias

from linden.protocol.values.space import BoundingBox, Rotation, Vector3D


class Point(NamedTuple):
    """A dot."""

    location: Vector3D
    size: float


class Line(NamedTuple):
    """A line."""

    begin: Vector3D
    end: Vector3D
    thickness: float


class Arrow(NamedTuple):
    """A line with a tip at its end."""

    line: Line
    arrow_size: float


class Box(NamedTuple):
    """The edges of a box; ``rotation`` is what turns it, not the box's own."""

    box: BoundingBox
    rotation: Rotation
    thickness: float


class Text(NamedTuple):
    """Words on the screen, at a place in the world."""

    location: Vector3D
    text: str
    draw_shadow: bool


class HudPoint(NamedTuple):
    """A dot on the screen; its size is in pixels."""

    location: Vector3D
    size: float


class HudLine(NamedTuple):
    """A line on the screen; its thickness is in pixels."""

    begin: Vector3D
    end: Vector3D
    thickness: float


class HudArrow(NamedTuple):
    """An arrow on the screen."""

    line: HudLine
    arrow_size: float


class HudBox(NamedTuple):
    """A box on the screen."""

    box: BoundingBox
    rotation: Rotation
    thickness: float


Primitive: TypeAlias = Point | Line | Arrow | Box | Text | HudPoint | HudLine | HudArrow | HudBox
"""In the order of the variant on the wire."""


class DebugShape(NamedTuple):
    """One shape; the colour has bytes of red, green and blue."""

    primitive: Primitive
    color: tuple[int, int, int]
    life_time: float
    persistent_lines: bool
