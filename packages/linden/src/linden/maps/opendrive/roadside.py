"""OpenDRIVE records: signals, signal references, objects and controllers. Frame as in model.py."""

from dataclasses import dataclass
from typing import NamedTuple

# LibCarla 0.9.16, carla/road/SignalType.cpp, IsTrafficLight
TRAFFIC_LIGHT_TYPES = frozenset({"1000001", "1000002", "F", "W", "A", *map(str, range(1000007, 1000021))})
STOP_SIGN_TYPE = "206"
YIELD_SIGN_TYPE = "205"
SPEED_LIMIT_TYPE = "274"


class Validity(NamedTuple):
    """Lanes a signal speaks to, from and to inclusive."""

    from_lane: int
    to_lane: int


class InertialPose(NamedTuple):
    """A pose given in the map's frame instead of along a road."""

    x_m: float
    y_m: float
    z_m: float
    heading_rad: float
    pitch_rad: float
    roll_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """A sign or a light. ``orientation`` is "+", "-" or "none", as written."""

    id: str
    name: str
    s_m: float
    t_m: float
    z_offset_m: float
    heading_offset_rad: float
    pitch_rad: float
    roll_rad: float
    orientation: str
    is_dynamic: bool
    country: str
    type: str
    subtype: str
    value: float | None
    unit: str
    height_m: float
    width_m: float
    text: str
    validities: tuple[Validity, ...]
    inertial: InertialPose | None
    source_line: int

    @property
    def is_light(self) -> bool:
        """Whether CARLA counts this type among the traffic lights."""
        return self.type in TRAFFIC_LIGHT_TYPES


class SignalReference(NamedTuple):
    """A signal that stands elsewhere but speaks to this road too."""

    signal_id: str
    s_m: float
    t_m: float
    orientation: str
    validities: tuple[Validity, ...]


class Corner(NamedTuple):
    """A corner of an object's outline: u, v, z in m in the object's frame, or s, t, dz in m along the road."""

    first_m: float
    second_m: float
    z_m: float
    height_m: float
    is_along_road: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadObject:
    """A thing on or beside the road; ``outline`` as in the file, empty where it gives only sizes."""

    id: str
    type: str
    name: str
    s_m: float
    t_m: float
    z_offset_m: float
    heading_rad: float
    length_m: float
    width_m: float
    height_m: float
    radius_m: float
    orientation: str
    outline: tuple[Corner, ...]
    user_data: tuple[tuple[str, str], ...]
    source_line: int

    @property
    def is_crosswalk(self) -> bool:
        """Whether LibCarla counts it among the crosswalks (ObjectParser.cpp: by type, or by name in any case)."""
        return self.type == "crosswalk" or "crosswalk" in self.name.lower()


class Controller(NamedTuple):
    """A set of signals that change together."""

    id: str
    name: str
    sequence: int
    signals: tuple[str, ...]
