"""OpenDRIVE 1.4 as values: what the builder makes and ``linden_maps.streets.writing`` turns into text."""

from typing import NamedTuple

from linden_maps.streets.curves import Path, Point
from linden_maps.streets.street_facts import Speed


class Cubic(NamedTuple):
    """a + b s + c s² + d s³ from ``s_m`` on."""

    s_m: float
    a: float
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0


def eased(s_m: float, over_m: float, values: tuple[float, float], slopes: tuple[float, float] = (0.0, 0.0)) -> Cubic:
    """Return the cubic that goes from one value and slope to another over a length (Hermite)."""
    rise = (values[1] - values[0]) / over_m
    return Cubic(
        s_m,
        values[0],
        slopes[0],
        (3 * rise - 2 * slopes[0] - slopes[1]) / over_m,
        (slopes[0] + slopes[1] - 2 * rise) / over_m**2,
    )


def value(cubics: tuple[Cubic, ...], s_m: float) -> float:
    """Return the value of piecewise cubics at a distance, 0 where there are none."""
    valid = [cubic for cubic in cubics if cubic.s_m <= s_m + 1e-9]
    if not valid:
        return 0.0
    start_m, a, b, c, d = valid[-1]
    ds = s_m - start_m
    return a + ds * (b + ds * (c + ds * d))


class Mark(NamedTuple):
    """A road mark on a lane's outer edge (the centre lane's: on the axis)."""

    kind: str = "none"
    color: str = "standard"
    lane_change: str = "none"


class EdgeHeights(NamedTuple):
    """How far a lane's inner and outer edge lie above the road's height, from ``s_m`` on."""

    s_m: float
    inner_m: float
    outer_m: float


class LaneRecord(NamedTuple):
    """One lane of a road's only lane section. ``heights`` are those of a lane that is not level from side to side."""

    id: int
    kind: str
    widths: tuple[Cubic, ...]
    mark: Mark = Mark()
    predecessor: int | None = None
    successor: int | None = None
    height_m: float = 0.0
    heights: tuple[EdgeHeights, ...] = ()


class Link(NamedTuple):
    """What a road's end touches; ``contact`` is None where it is a junction."""

    element: str
    id: int
    contact: str | None = None


class Signal(NamedTuple):
    """A sign or light beside a road, valid for the lanes between two ids."""

    id: int
    name: str
    s_m: float
    t_m: float
    kind: str
    lanes: tuple[int, int]
    confidence: str
    dynamic: bool = False
    subtype: str = "-1"
    value: float = -1.0
    unit: str | None = None


class SignalReference(NamedTuple):
    """A light that stands on another road and governs all lanes of this one from its begin on."""

    signal: int
    lanes: tuple[int, int]


class Object(NamedTuple):
    """A painted or built thing beside or on a road; the outline is in its own frame (u along the road, v left).

    ``notes`` are further facts, written as ``userData``.
    """

    id: int
    name: str
    kind: str
    s_m: float
    t_m: float
    heading_rad: float
    outline: tuple[Point, ...]
    confidence: str
    height_m: float = 0.0
    notes: tuple[tuple[str, str], ...] = ()


class RoadRecord(NamedTuple):
    """A road with one lane section; ``left`` and ``right`` from the axis outward."""

    id: int
    name: str
    junction: int
    path: Path
    predecessor: Link | None
    successor: Link | None
    speed: Speed | None
    elevation: tuple[Cubic, ...]
    axis: tuple[Cubic, ...]
    left: tuple[LaneRecord, ...]
    right: tuple[LaneRecord, ...]
    centre: Mark
    signals: tuple[Signal, ...] = ()
    objects: tuple[Object, ...] = ()
    references: tuple[SignalReference, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()


class Connection(NamedTuple):
    """From an incoming road into a connecting road, lane by lane."""

    incoming: int
    connecting: int
    lanes: tuple[tuple[int, int], ...]


class JunctionRecord(NamedTuple):
    """A junction; ``priorities`` are pairs of connecting roads, the first before the second."""

    id: int
    name: str
    connections: tuple[Connection, ...]
    priorities: tuple[tuple[int, int], ...]
    controllers: tuple[int, ...]
    notes: tuple[tuple[str, str], ...]


class Controller(NamedTuple):
    """Lights that show the same at the same time."""

    id: int
    name: str
    signals: tuple[int, ...]


class Document(NamedTuple):
    """A whole map."""

    name: str
    geo_reference: str
    roads: tuple[RoadRecord, ...]
    controllers: tuple[Controller, ...]
    junctions: tuple[JunctionRecord, ...]
    notes: tuple[tuple[str, str], ...]
