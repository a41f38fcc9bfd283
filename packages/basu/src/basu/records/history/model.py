"""The record of a run: its frames as one packed array, events, constant facts.

A frame's ``tick`` counts from 0 at the first step of the agent and ``t_s`` is ``tick`` times the step, so that two
runs of one seed leave the same bytes whatever the server's own frame counter says.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from basu.records.structured import StructuredArray

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import pyarrow as pa
    from numpy.typing import NDArray

    from basu.records.history.sumo import SumoRecord
    from basu.routing import Route

Value = TypeVar("Value")

# One row a tick. World quantities in CARLA's frame (x east, y south, z up), angles in rad, yaw clockwise from above.
FRAME = np.dtype(
    [
        ("tick", "<i8"),
        ("t_s", "<f8"),
        ("x_m", "<f8"),
        ("y_m", "<f8"),
        ("z_m", "<f8"),
        ("roll_rad", "<f8"),
        ("pitch_rad", "<f8"),
        ("yaw_rad", "<f8"),
        ("velocity_x_mps", "<f8"),
        ("velocity_y_mps", "<f8"),
        ("velocity_z_mps", "<f8"),
        ("acceleration_x_mps2", "<f8"),
        ("acceleration_y_mps2", "<f8"),
        ("acceleration_z_mps2", "<f8"),
        ("angular_velocity_x_radps", "<f8"),
        ("angular_velocity_y_radps", "<f8"),
        ("angular_velocity_z_radps", "<f8"),
        ("throttle", "<f8"),  # requested: the agent's answer in this frame; its last one where it gave none
        ("steer", "<f8"),
        ("brake", "<f8"),
        ("hand_brake", "<i1"),
        ("reverse", "<i1"),
        ("applied_throttle", "<f8"),  # applied: what the vehicle was given, after a person and a scenario's effects
        ("applied_steer", "<f8"),
        ("applied_brake", "<f8"),
        ("applied_hand_brake", "<i1"),
        ("applied_reverse", "<i1"),
        ("speed_limit_mps", "<f8"),  # as the simulator posts it to the vehicle; 0 where it posts none
        (
            "traffic_light_state",
            "<i1",
        ),  # carla.TrafficLightState of the light the vehicle stands under, NO_LIGHT for none
        ("route_s_m", "<f8"),  # progress along the planned route
        ("lateral_m", "<f8"),  # off the route, positive to the right
        ("route_light", "<i1"),  # of the next light on the route with its line less than 1 m behind the rear, as above
        ("manual", "<i1"),  # a person drives
        ("road_id", "<i4"),  # the lane under the vehicle's origin, whatever its type
        ("lane_id", "<i4"),
        ("lane_type", "<i4"),  # carla.LaneType; 0 where there is no lane
        ("lane_offset_m", "<f8"),  # off that lane's middle, positive to the right; nan where there is none
        ("lane_heading_rad", "<f8"),  # the vehicle's yaw less the lane's; nan where there is none
        ("lane_width_m", "<f8"),  # nan where there is none
        ("in_junction", "<i1"),
        ("off_lane_m", "<f8"),  # beyond the edge of the nearest driving or parking lane; 0 within one
    ]
)

CONTROL = ("throttle", "steer", "brake", "hand_brake", "reverse")

# Vehicles and walkers that were near, then things, each nearest first: at most NEAREST rows of each a tick. Places are
# those of the middles of their boxes.
OTHER = np.dtype(
    [
        ("tick", "<i8"),
        ("id", "<u4"),
        ("x_m", "<f8"),
        ("y_m", "<f8"),
        ("z_m", "<f8"),
        ("yaw_rad", "<f8"),
        ("velocity_x_mps", "<f8"),
        ("velocity_y_mps", "<f8"),
    ]
)
NO_LIGHT = -1
NEAREST, NEAR_M = 16, 60.0  # how many moving others and how many things are recorded, and out to which distance


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """One message of the collision sensor: a contact lasts for many."""

    tick: int
    other_id: int  # 0 for scenery
    other_type: str  # blueprint id, `static.<tag>` for scenery
    impulse_ns: tuple[float, float, float]  # world frame


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneInvasion:
    """One message of the client's lane-invasion sensor."""

    tick: int
    markings: tuple[str, ...]  # what was crossed, as `type/colour`


@dataclass(frozen=True, slots=True, kw_only=True)
class Vehicle:
    """The vehicle under test; distances from its origin in m."""

    type_id: str
    front_m: float  # to the front bumper
    rear_m: float  # to the rear bumper, positive
    width_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """What does not change during a run."""

    step_s: float  # simulated time from tick to tick
    vehicle: Vehicle
    route: Route
    actor_types: Mapping[int, str]  # blueprint ids of all actors that were ever near
    actor_sizes: Mapping[int, tuple[float, float]]  # half the length and half the width of their boxes, m


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """The whole record of a run; its arrays do not change once it is made.

    Attributes:
        computed: what functions with the decorator `once` have returned for this record, by the function.
    """

    facts: Facts
    frames: StructuredArray  # (T,) of FRAME, ticks ascending without a gap
    others: StructuredArray  # (M,) of OTHER, ticks ascending
    collisions: tuple[Collision, ...]  # ticks ascending
    lane_invasions: tuple[LaneInvasion, ...]  # ticks ascending
    sumo: SumoRecord | None = None  # None for a run without SUMO
    computed: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def to_arrow(self) -> pa.Table:
        """The record as an Arrow table, one row a tick, with the unit of each column in its field's metadata."""
        from basu.records.history.tables import to_arrow  # noqa: PLC0415 - slow to import, and few need tables

        return to_arrow(self)

    def to_pandas(self, what: str = "frames") -> Any:  # noqa: ANN401 - a DataFrame; pandas is optional
        """The frames as a data frame, or the "others", "collisions" or "lane_invasions"; units in ``attrs["units"]``.

        Raises:
            UserError: there is no such table, or pandas is not installed.
        """
        from basu.records.history.tables import to_pandas  # noqa: PLC0415 - likewise

        return to_pandas(self, what)

    def window(self, first: int, end: int) -> History:
        """Return the frames from ``first`` until before ``end`` with their contacts; ticks count from ``first``."""
        contacts = (contact for contact in self.collisions if first <= contact.tick < end)
        return replace(
            self,
            frames=self.frames[first:end],
            others=self.others[:0],
            collisions=tuple(replace(contact, tick=contact.tick - first) for contact in contacts),
            lane_invasions=(),
        )

    def speed_mps(self) -> NDArray[np.float64]:
        """(T,) speed over ground."""
        frames = self.frames
        squared: NDArray[np.float64] = np.sum([frames[f"velocity_{axis}_mps"] ** 2 for axis in "xyz"], axis=0)
        return np.sqrt(squared)


def once(compute: Callable[[History], Value]) -> Callable[[History], Value]:
    """Decorate a function of a record alone: it computes once for each record, and metrics share what it returns."""

    @functools.wraps(compute)
    def kept(history: History) -> Value:
        if compute not in history.computed:
            history.computed[compute] = compute(history)
        found: Value = history.computed[compute]
        return found

    return kept
