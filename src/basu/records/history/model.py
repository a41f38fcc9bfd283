"""The record of a run: its frames as one packed array, events, constant facts; the same as tables with units.

A frame's ``tick`` counts from 0 at the first step of the agent and ``t_s`` is ``tick`` times the step, so that two
runs of one seed leave the same bytes whatever the server's own frame counter says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pyarrow as pa
    from numpy.typing import NDArray

    from basu.records.history.sumo import SumoRecord
    from basu.routing import Route


UNITS = {"radps": "rad/s", "mps2": "m/s²", "mps": "m/s", "ns": "N s", "rad": "rad", "m": "m", "s": "s"}
TABLES = ("frames", "others", "collisions", "lane_invasions")


def unit_of(column: str) -> str:
    """The unit that ends a column's name; nothing for a column without one."""
    _, _, last = column.rpartition("_")
    return UNITS.get(last, "") if last != column else ""


def units() -> dict[str, str]:
    """The unit of each column of a frame."""
    return {name: unit_of(name) for name in FRAME.names or ()}


def to_arrow(history: History) -> pa.Table:
    """One row a tick, the unit of each column in its field's metadata; events and others are lists in their row."""
    import pyarrow as pa  # noqa: PLC0415 - slow to import, and only tables need it

    ticks = len(history.frames)
    columns = {name: pa.array(np.ascontiguousarray(history.frames[name])) for name in FRAME.names or ()}
    columns["others"] = _lists(_structs(history.others), history.others["tick"], ticks)
    contacts = pa.array(
        [
            {"other_id": c.other_id, "other_type": c.other_type, "impulse_ns": list(c.impulse_ns)}
            for c in history.collisions
        ],
        type=pa.struct(
            [("other_id", pa.uint32()), ("other_type", pa.string()), ("impulse_ns", pa.list_(pa.float64(), 3))]
        ),
    )
    columns["collisions"] = _lists(contacts, [c.tick for c in history.collisions], ticks)
    crossed = pa.array([list(e.markings) for e in history.lane_invasions], type=pa.list_(pa.string()))
    columns["lane_invasions"] = _lists(crossed, [e.tick for e in history.lane_invasions], ticks)
    fields = [_field(name, column.type) for name, column in columns.items()]
    return pa.Table.from_arrays(list(columns.values()), schema=pa.schema(fields))


def to_pandas(history: History, what: str = "frames") -> Any:  # noqa: ANN401 - a DataFrame; pandas is optional
    """A data frame with its units in ``attrs["units"]``: the frames, or one of the other `TABLES`.

    Raises:
        UserError: there is no such table, or pandas is not installed.
    """
    if what not in TABLES:
        raise UserError(f"a record has no table '{what}'; there are {', '.join(TABLES)}")
    try:
        import pandas as pd  # noqa: PLC0415 - optional
    except ImportError as error:
        raise UserError("pandas is not installed; install it, or use to_arrow()") from error
    rows: Any
    if what == "frames":
        rows = {name: history.frames[name] for name in FRAME.names or ()}
    elif what == "others":
        rows = {name: history.others[name] for name in OTHER.names or ()}
        rows["type"] = [history.facts.actor_types.get(int(key), "") for key in history.others["id"]]
    elif what == "collisions":
        rows = _collisions(history)
    else:
        rows = [{"tick": e.tick, "marking": marking} for e in history.lane_invasions for marking in e.markings]
    table = pd.DataFrame(rows)
    table.attrs["units"] = {str(name): unit_of(str(name)) for name in table.columns}
    return table


def _collisions(history: History) -> dict[str, Any]:
    """The messages of the collision sensor as columns."""
    impulse_ns = np.array([c.impulse_ns for c in history.collisions], dtype=np.float64).reshape(-1, 3)
    return {
        "tick": [c.tick for c in history.collisions],
        "other_id": [c.other_id for c in history.collisions],
        "other_type": [c.other_type for c in history.collisions],
        **{f"impulse_{axis}_ns": impulse_ns[:, index] for index, axis in enumerate("xyz")},
    }


def _field(name: str, kind: pa.DataType) -> pa.Field:
    """A column with its unit."""
    import pyarrow as pa  # noqa: PLC0415 - likewise

    unit = unit_of(name)
    return pa.field(name, kind, metadata={"unit": unit} if unit else None)


def _structs(others: NDArray[np.void]) -> pa.StructArray:
    """The rows of OTHER without their tick, which the list they stand in tells."""
    import pyarrow as pa  # noqa: PLC0415 - likewise

    names = [name for name in OTHER.names or () if name != "tick"]
    arrays = [pa.array(np.ascontiguousarray(others[name])) for name in names]
    return pa.StructArray.from_arrays(
        arrays, fields=[_field(name, array.type) for name, array in zip(names, arrays, strict=True)]
    )


def _lists(values: pa.Array, tick_of_value: NDArray[np.int64] | list[int], ticks: int) -> pa.ListArray:
    """Values gathered into one list a tick; ``tick_of_value`` ascends."""
    import pyarrow as pa  # noqa: PLC0415 - likewise

    counts = np.bincount(np.asarray(tick_of_value, dtype=np.int64), minlength=ticks)
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return pa.ListArray.from_arrays(pa.array(offsets), values)


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
    """The whole record of a run."""

    facts: Facts
    frames: NDArray[np.void]  # (T,) of FRAME, ticks ascending without a gap
    others: NDArray[np.void]  # (M,) of OTHER, ticks ascending
    collisions: tuple[Collision, ...]  # ticks ascending
    lane_invasions: tuple[LaneInvasion, ...]  # ticks ascending
    sumo: SumoRecord | None = None  # None for a run without SUMO

    def to_arrow(self) -> pa.Table:
        """The record as an Arrow table, one row a tick, with the unit of each column in its field's metadata."""
        return to_arrow(self)

    def to_pandas(self, what: str = "frames") -> Any:  # noqa: ANN401 - a DataFrame; pandas is optional
        """The frames as a data frame, or the "others", "collisions" or "lane_invasions"; units in ``attrs["units"]``.

        Raises:
            UserError: there is no such table, or pandas is not installed.
        """
        return to_pandas(self, what)

    def speed_mps(self) -> NDArray[np.float64]:
        """(T,) speed over ground."""
        frames = self.frames
        squared: NDArray[np.float64] = np.sum([frames[f"velocity_{axis}_mps"] ** 2 for axis in "xyz"], axis=0)
        return np.sqrt(squared)
