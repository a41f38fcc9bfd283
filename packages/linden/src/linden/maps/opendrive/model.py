"""An OpenDRIVE map as frozen values. Frame: x east, y north, z up; headings counter-clockwise in rad.

``s_m`` runs along a road's reference line, ``t_m`` to its left. Lane ids are positive on the left. Source of names and
meaning: ASAM OpenDRIVE 1.4 to 1.7. Superelevation and crossfall are left out, as LibCarla does. Values derived from a
map are computed once and kept as long as the map, since many modules use them.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, wraps
from types import MappingProxyType
from typing import NamedTuple, TypeVar
from weakref import WeakKeyDictionary

from linden.maps.opendrive.georeference import read_origin
from linden.maps.opendrive.roadside import Controller, RoadObject, Signal, SignalReference
from linden.protocol.values.enums import LaneType

NO_JUNCTION = -1


class Cubic(NamedTuple):
    """``a + b·d + c·d² + d·d³`` from ``start_m`` on, where d is the distance from there in m."""

    start_m: float
    a: float
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0


class StraightLine(NamedTuple):
    """Straight on."""


class Arc(NamedTuple):
    """Constant curvature in 1/m, positive to the left."""

    curvature: float


class Spiral(NamedTuple):
    """Clothoid: the curvature in 1/m changes linearly along the way."""

    curvature_start: float
    curvature_end: float


class ParamPoly3(NamedTuple):
    """Cubics u(p), v(p) in the frame of the geometry's start, p from 0 to ``p_end``; walked by arc length.

    LibCarla does so too, whatever the pRange. OpenDRIVE's ``poly3`` is the same with u(p) = p.
    """

    u: tuple[float, float, float, float]
    v: tuple[float, float, float, float]
    p_end: float


class Geometry(NamedTuple):
    """One piece of a reference line: where it starts and how it goes on."""

    s_m: float
    x_m: float
    y_m: float
    heading_rad: float
    length_m: float
    shape: StraightLine | Arc | Spiral | ParamPoly3


class RoadMark(NamedTuple):
    """The marking on a lane's outer edge (the centre line for lane 0), from ``offset_m`` into the section on."""

    offset_m: float
    type: str
    weight: str
    colour: str
    width_m: float
    lane_change: str | None


class Speed(NamedTuple):
    """A limit from ``start_m`` on; None where the file says that there is none, or nothing that can be read."""

    start_m: float
    limit_mps: float | None


class Height(NamedTuple):
    """How far a lane's inner and outer edge are lifted above the road, from ``offset_m`` into the section on."""

    offset_m: float
    inner_m: float
    outer_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """One lane of one section. Links name lanes of the neighbouring section, or of the road next to this one."""

    id: int
    type: LaneType
    predecessor: int | None
    successor: int | None
    widths: tuple[Cubic, ...]
    borders: tuple[Cubic, ...]
    marks: tuple[RoadMark, ...]
    speeds: tuple[Speed, ...]
    heights: tuple[Height, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneSection:
    """A stretch of road with one set of lanes, from ``s_m`` to ``end_m``; from left to right, lane 0 among them."""

    s_m: float
    end_m: float
    lanes: tuple[Lane, ...]

    def lane(self, lane_id: int) -> Lane | None:
        """Return the lane of that id, None where the section has no such lane."""
        return next((lane for lane in self.lanes if lane.id == lane_id), None)


class RoadType(NamedTuple):
    """What kind of road this is from ``s_m`` on, and its speed limit."""

    s_m: float
    type: str
    limit_mps: float | None
    has_speed: bool


class RoadLink(NamedTuple):
    """What a road's end touches: a road at its ``contact`` ("start" or "end"), or a junction (contact None)."""

    is_junction: bool
    id: int
    contact: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Road:
    """A reference line with all that is laid along it."""

    id: int
    name: str
    length_m: float
    junction_id: int
    is_right_hand: bool
    predecessor: RoadLink | None
    successor: RoadLink | None
    types: tuple[RoadType, ...]
    geometries: tuple[Geometry, ...]
    elevations: tuple[Cubic, ...]
    lane_offsets: tuple[Cubic, ...]
    sections: tuple[LaneSection, ...]
    signals: tuple[Signal, ...]
    signal_references: tuple[SignalReference, ...]
    objects: tuple[RoadObject, ...]
    user_data: tuple[tuple[str, str], ...]
    source_line: int

    @property
    def is_in_junction(self) -> bool:
        """Whether this road connects others inside a junction."""
        return self.junction_id != NO_JUNCTION

    def section_at(self, s_m: float) -> LaneSection:
        """Return the lane section that holds at ``s_m``."""
        return self.sections[self.section_index_at(s_m)]

    def section_index_at(self, s_m: float) -> int:
        """Return the index of the lane section that holds at ``s_m``, counted from 0."""
        return max(0, bisect_right(self.sections, s_m, key=lambda section: section.s_m) - 1)


class Connection(NamedTuple):
    """One way through a junction; ``lane_links`` pair a lane of the incoming road with one of the connecting road."""

    id: str
    incoming_road: int
    connecting_road: int
    contact: str | None
    lane_links: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction:
    """Where roads meet. ``priorities`` pair connecting roads, the one with right of way first."""

    id: int
    name: str
    connections: tuple[Connection, ...]
    controllers: tuple[str, ...]
    priorities: tuple[tuple[int, int], ...]
    user_data: tuple[tuple[str, str], ...]
    source_line: int


@dataclass(frozen=True, eq=False, kw_only=True)
class OpenDrive:
    """A whole map. Compared by identity, so what is derived from it can be kept."""

    name: str
    geo_reference: str
    roads: tuple[Road, ...]
    junctions: tuple[Junction, ...]
    controllers: tuple[Controller, ...]

    @property
    def geo_origin(self) -> tuple[float, float]:
        """Latitude and longitude of the origin in degrees, as LibCarla reads them (42 and 2 where it cannot)."""
        return read_origin(self.geo_reference)[:2]

    @cached_property
    def road_by_id(self) -> MappingProxyType[int, Road]:
        """Return the roads by their id."""
        return MappingProxyType({road.id: road for road in self.roads})

    @cached_property
    def junction_by_id(self) -> MappingProxyType[int, Junction]:
        """Return the junctions by their id."""
        return MappingProxyType({junction.id: junction for junction in self.junctions})

    def signals(self) -> Iterator[tuple[Road, Signal]]:
        """Yield every signal with the road it stands at, in the order of the file."""
        for road in self.roads:
            for signal in road.signals:
                yield road, signal


Derived = TypeVar("Derived")


def kept(derive: Callable[[OpenDrive], Derived]) -> Callable[[OpenDrive], Derived]:
    """Let ``derive`` compute once for each map. What it returns must not hold the map, or neither would ever go."""
    known: WeakKeyDictionary[OpenDrive, Derived] = WeakKeyDictionary()

    @wraps(derive)
    def once(opendrive: OpenDrive) -> Derived:
        if opendrive not in known:
            known[opendrive] = derive(opendrive)
        return known[opendrive]

    return once
