"""The street facts a map is built from, as frozen values in metres: streets, intersections, stops, buildings, ground.

Points are in OpenDRIVE's frame, x east and y north. :mod:`linden_maps.streets.geojson` reads them from a file.
"""

from collections.abc import Mapping
from enum import Enum
from typing import NamedTuple, Protocol

from linden_maps.streets.curves import Point

NARROWEST_M = 2.0  # of a lane; a car is 1.8 m wide
MOST_LEVELS = 5
"""Of bridges over each other, and of tunnels."""
WIDEST_M = 100.0
"""Between the kerbs of a street; Buenos Aires' Avenida 9 de Julio, of several carriageways, has 140 m in all."""
CYCLE_LANES = ("none", "right", "both")
FURNITURE = ("bench", "bin", "mailbox")


class Control(Enum):
    """What governs an intersection."""

    SIGNAL = "signal"
    TWO_WAY_STOP = "two_way_stop"
    ALL_WAY_STOP = "all_way_stop"
    ROUNDABOUT = "roundabout"
    GIVE_WAY = "give_way"
    NONE = "none"


MPS_PER_UNIT = {"mph": 0.44704, "km/h": 1.0 / 3.6}


class Speed(NamedTuple):
    """A speed limit as signs show it; ``unit`` is "mph" or "km/h"."""

    value: float
    unit: str

    @property
    def mps(self) -> float:
        """The limit in m/s."""
        return self.value * MPS_PER_UNIT[self.unit]


def slower(one: Speed, other: Speed) -> Speed:
    """Return the lower of two limits, in its own unit."""
    return min(one, other, key=lambda speed: speed.mps)


class Street(NamedTuple):
    """One centre-line with what lies across it. ``width_m`` is between the kerbs.

    ``confidences``: which fact, how sure ("width_confidence", "estimated"). ``lanes_forward``: how many of the lanes
    run along the points; None stands for half of them, the odd one too. ``cycle_lanes``: one of ``CYCLE_LANES``.
    """

    id: str
    name: str
    points: tuple[Point, ...]
    street_class: str
    lanes: int
    width_m: float
    speed_limit: Speed
    oneway: bool
    parking: str
    sidewalk: str
    confidences: tuple[tuple[str, str], ...]
    lanes_forward: int | None = None
    speed_posted: bool = False  # whether signs show the limit
    cycle_lanes: str = "none"
    level: int = 0  # of a bridge 1 or more, of a tunnel -1 or less


class Intersection(NamedTuple):
    """A place where streets meet, and the streets that must wait there: ``stops`` holds their names or ids."""

    id: str
    name: str
    point: Point
    control: Control
    stops: frozenset[str]
    confidence: str
    control_confidence: str


class Stop(NamedTuple):
    """A shuttle stop near its kerb; ``forward`` tells whether it serves the traffic along its street's points."""

    id: str
    name: str
    point: Point
    street_id: str
    forward: bool
    confidence: str


class CrossingPlace(NamedTuple):
    """A place near which people cross."""

    name: str
    point: Point


class Crossing(NamedTuple):
    """A painted crossing of a street, where people cross it."""

    id: str
    point: Point
    street_id: str
    confidence: str


class Building(NamedTuple):
    """A building on its footprint: a ring of corners, closed (the first corner stands at the end again).

    ``sign_confidence`` says how sure it is that a sign before the building bears its name; empty: there is no sign.
    """

    id: str
    name: str
    kind: str
    ring: tuple[Point, ...]
    height_m: float
    confidence: str
    sign_confidence: str = ""


class Furniture(NamedTuple):
    """A small thing beside a street; ``kind`` is one of ``FURNITURE``."""

    id: str
    kind: str
    name: str
    point: Point
    confidence: str


class Railroad(NamedTuple):
    """The middle of a track."""

    points: tuple[Point, ...]
    confidence: str


class Route(NamedTuple):
    """A way along streets, through points of theirs; ``stops`` are the ids of the stops called at, in their order.

    ``timetable`` names a file that is to lie beside the route's; empty where there is none.
    """

    id: str
    points: tuple[Point, ...]
    closed: bool
    stops: tuple[str, ...]
    timetable: str = ""


class Profile(NamedTuple):
    """How closely roads follow the ground.

    A road finds back to the ground over ``ramp_m`` from a junction. Its height is given every ``knot_m``. No road
    between junctions rises by more than ``steepest`` on the whole. A road too short for two ramps rises nowhere by more
    than ``steepest_spot``. ``tilt`` is the greatest slope of a junction; with 0 all junctions are level.
    """

    ramp_m: float
    knot_m: float
    steepest: float
    steepest_spot: float
    tilt: float


class Ground(NamedTuple):
    """A plane: height in m at the origin, and its rise per metre north and east."""

    base_m: float
    north: float
    east: float
    confidence: str
    profile: Profile = Profile(ramp_m=30.0, knot_m=60.0, steepest=0.012, steepest_spot=0.018, tilt=0.0)

    def height_m(self, x_m: float, y_m: float) -> float:
        """Return the height in m at a place."""
        return self.base_m + self.north * y_m + self.east * x_m

    def rise(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return the rise per metre east and north at a place."""
        del x_m, y_m
        return self.east, self.north


class AnyGround(Protocol):
    """Ground that roads are laid on: a plane, or measured terrain."""

    @property
    def confidence(self) -> str:
        """Where the heights are known from."""

    @property
    def profile(self) -> Profile:
        """How closely roads follow the ground."""

    def height_m(self, x_m: float, y_m: float) -> float:
        """Return the height in m at a place."""

    def rise(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return the rise per metre east and north at a place."""


class Facts(NamedTuple):
    """All that a map is built from.

    ``turning_circles``: whether traffic can turn where a street leaves the map. ``street_name_signs``: how sure it is
    that signs at junctions name the streets; empty where there are to be none. ``simplify_roundabouts``: whether a
    roundabout without room for its island becomes a plain junction; else the build refuses it.
    """

    name: str
    longitude_deg: float
    latitude_deg: float
    ground: AnyGround
    turning_circles: bool
    streets: tuple[Street, ...]
    intersections: tuple[Intersection, ...]
    stops: tuple[Stop, ...]
    schools: tuple[CrossingPlace, ...]
    routes: Mapping[str, Route]
    crossings: tuple[Crossing, ...] = ()
    buildings: tuple[Building, ...] = ()
    furniture: tuple[Furniture, ...] = ()
    railroads: tuple[Railroad, ...] = ()
    street_name_signs: str = ""
    simplify_roundabouts: bool = False
