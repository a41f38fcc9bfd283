"""Spaces, observations and actions of the gymnasium environment; `basu.gym` describes shapes and units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import carla
import gymnasium
import numpy as np

from basu.conditions import STEP_S
from basu.errors import UserError
from basu.gym_view import (
    FARTHEST_M,
    FASTEST_MPS,
    FASTEST_TURN_RADPS,
    HARDEST_MPS2,
    OTHERS,
    PREVIEW_POINTS,
    TURN_RAD,
    EgoRows,
    Others,
    Places,
    RouteColumns,
    Views,
    put_view,
)
from basu.managers.observations import vehicle_of
from basu.metrics.passengers.felt import STEP_MPS2
from basu.metrics.stop_signs import stops_at
from basu.outcome import Status
from basu.routing import ControlKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from basu.episode import Observation, VehicleUnderTest
    from basu.records.history import Vehicle
    from basu.records.motion import VehicleMotion
    from basu.routing import Route
    from basu.routing.planned_route import Progress

JUDGED_TICKS = 10  # from one look for infractions to the next, which takes the time of half a step
TRUNCATED = frozenset({Status.ROUTE_TIMEOUT, Status.SCENARIO_TIMEOUT})
FAILED = frozenset({Status.ROUTE_DEVIATION, Status.ROUTE_BLOCKED})


@dataclass(frozen=True, slots=True, kw_only=True)
class Reward:
    """What a step is worth: the sum of these."""

    progress: float = 0.1  # for a metre along the route
    time: float = -0.01  # for a second
    infraction: float = -10.0  # for an infraction of the thesis's: collisions, lights, stop signs, speeding
    arrival: float = 10.0  # for the end of the route
    failure: float = -10.0  # for leaving the route, or standing still for too long
    discomfort: float = -0.3  # for a second with 1 m/s² more than standing passengers balance without a step
    offset: float = -0.2  # for a second 1 m off the middle of the planned lane

    def parts(
        self,
        driven_m: Any,  # noqa: ANN401 - all are numbers or arrays
        infractions: Any,  # noqa: ANN401
        arrived: Any,  # noqa: ANN401
        failed: Any,  # noqa: ANN401
        push_mps2: Any,  # noqa: ANN401
        lateral_m: Any,  # noqa: ANN401
    ) -> dict[str, Any]:
        """Return the parts of a step's reward by field; for numbers, and for arrays of many environments.

        ``push_mps2`` is the horizontal acceleration of the vehicle in the step's last frame, ``lateral_m`` its offset
        from the route.
        """
        return {
            "progress": self.progress * driven_m,
            "time": self.time * STEP_S,
            "infraction": self.infraction * infractions,
            "arrival": self.arrival * arrived,
            "failure": self.failure * failed,
            "discomfort": self.discomfort * STEP_S * np.maximum(0.0, push_mps2 - STEP_MPS2),
            "offset": self.offset * STEP_S * np.abs(lateral_m),
        }


class Preview:
    """Turns frames of one vehicle under test into observations."""

    def __init__(self, vehicle: VehicleUnderTest) -> None:
        self._vehicle = vehicle
        self._view = DriversView(vehicle.run.route, vehicle_of(vehicle.run.vehicle))

    def of(self, seen: Observation) -> dict[str, NDArray[np.float32]]:
        """Return the observation of the next frame."""
        limit_mps = self._vehicle.run.vehicle.get_speed_limit() / 3.6
        others = [row[2:] for row in self._vehicle.metrics.others(seen.frame)]
        return self._view.of(seen.frame.ego, seen.progress, limit_mps, others, in_lane=seen.in_lane)


class DriversView:
    """Makes the observations of one drive, frame by frame, and remembers at which signs the vehicle has stopped."""

    def __init__(self, route: Route, vehicle: Vehicle) -> None:
        self._ahead = RouteAhead(route, vehicle)
        self._stopped = np.zeros((1, len(self._ahead.signs_m)), np.bool_)

    def of(
        self,
        ego: VehicleMotion,
        progress: Progress,
        limit_mps: float,
        others: Sequence[Sequence[float]],
        *,
        in_lane: bool,
    ) -> dict[str, NDArray[np.float32]]:
        """Return the observation of the next frame.

        Args:
            ego: the motion of the vehicle.
            progress: its place along the route.
            limit_mps: what is posted to it; 0 for none.
            others: x, y, z, yaw, velocity x and y of each road user near it, CARLA's frame.
            in_lane: whether it is on its route, so that a stop counts (`basu.metrics.validity`).
        """
        rows = EgoRows(*(np.array([getattr(ego, name)]) for name in EgoRows._fields))
        s_m, table = np.array([progress.s_m]), np.array(others, np.float64).reshape(1, -1, 6)
        self._stopped |= stops_at(self._ahead.to_signs_m(s_m), rows.speed_mps[:, None], in_lane)
        places = Places(s_m, np.array([progress.lateral_m]), np.array([limit_mps]), self._stopped)
        many = self._ahead.observed(rows, places, Others(table, np.ones(table.shape[:2], np.bool_)))
        return {name: values[0] for name, values in many.items()}


class RouteAhead:
    """Makes observations of vehicles on one route.

    Attributes:
        signs_m: (S,) places of the lines of the stop signs along the route.
        columns: the route as `basu.gym_view.put_view` reads it.
    """

    def __init__(self, route: Route, vehicle: Vehicle) -> None:
        """Take the route, and the box of the vehicles."""
        self.signs_m = np.array([control.s_m for control in route.controls if control.kind is ControlKind.STOP_SIGN])
        self._front_m = vehicle.front_m
        self.columns = RouteColumns(
            np.ascontiguousarray(route.s_m),
            np.ascontiguousarray(route.points_m[:, 0]),
            np.ascontiguousarray(route.points_m[:, 1]),
            np.unwrap(route.yaw_rad).astype(np.float64),
            self.signs_m,
            np.array([vehicle.front_m, (vehicle.front_m + vehicle.rear_m) / 2.0]),
        )

    def observed(self, ego: EgoRows, places: Places, others: Others) -> dict[str, NDArray[np.float32]]:
        """Return the observations of E vehicles from their motion, their places and the road users near each."""
        found, away_m = empty_views(len(ego.x_m)), np.empty(OTHERS)
        for k in range(len(ego.x_m)):
            put_view(k, self.columns, ego, places, others, away_m, found)
        return found._asdict()

    def to_signs_m(self, s_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (E, S) the way from the front bumpers of vehicles at ``s_m`` to the lines, negative beyond them."""
        ahead_m: NDArray[np.float64] = self.signs_m - (s_m[:, None] + self._front_m)
        return ahead_m


def empty_views(count: int) -> Views:
    """Return room for the observations of so many vehicles."""
    shapes = (6,), (PREVIEW_POINTS, 2), (OTHERS, 6), (2,)
    return Views(*(np.empty((count, *shape), np.float32) for shape in shapes))


def control_from(action: ArrayLike) -> carla.VehicleControl:
    """Return the control of an action ``[pedals, steer]``, both in -1..1.

    Raises:
        UserError: the action has another shape, is no number, or lies outside of the space.
    """
    throttle, steer, brake = controls_from(action, ()).tolist()
    return carla.VehicleControl(throttle=throttle, brake=brake, steer=steer)


def controls_from(action: ArrayLike, batch: tuple[int, ...]) -> NDArray[np.float64]:
    """Return throttle, steer and brake (..., 3) of actions (..., 2), pedals and steer in -1..1, of a ``batch``.

    Raises:
        UserError: the actions have another shape, are no numbers, or lie outside of the space.
    """
    what, shape = ("the action", "two numbers") if not batch else ("an action", f"{batch[0]} pairs of numbers")
    try:
        values = np.asarray(action)
    except (TypeError, ValueError):
        values = np.array(None)
    if values.dtype.kind not in "biuf":
        raise UserError(f"{what} is {_short(action)}; give {shape} in -1..1, [pedals, steer]")
    if values.shape != (*batch, 2):
        raise UserError(f"{what} has the shape {values.shape}; give {(*batch, 2)}, [pedals, steer]")
    values = values.astype(np.float64)
    wrong = np.argwhere(~(np.abs(values) <= 1.0).all(axis=-1))  # NaN is wrong as well
    if len(wrong):
        given = ", ".join(f"{value:g}" for value in values[tuple(wrong[0])])
        where = f" of environment {wrong[0][0]}" if batch else ""
        raise UserError(
            f"{what}{where} is [{given}]; both numbers must be in -1..1 (to clip them: gymnasium.wrappers.ClipAction)"
        )
    pedals, steer = values[..., 0], values[..., 1]
    return np.stack([np.maximum(0.0, pedals), steer, np.maximum(0.0, -pedals)], axis=-1)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def action_space() -> gymnasium.spaces.Space[NDArray[np.float32]]:
    """The space of actions: pedals and steer."""
    return gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)


def observation_space() -> gymnasium.spaces.Dict:
    """The space of observations that `basu.gym` describes."""
    return gymnasium.spaces.Dict({**_boxes()})


def _boxes() -> dict[str, gymnasium.spaces.Box]:
    """The boxes that `basu.gym` describes."""
    turn, far = TURN_RAD, FARTHEST_M
    ego = [FASTEST_MPS, HARDEST_MPS2, FASTEST_TURN_RADPS, far, turn, FASTEST_MPS]
    other = [1.0, far, far, turn, FASTEST_MPS, FASTEST_MPS]
    return {
        "ego": _symmetric(np.array(ego)),
        "route": _symmetric(np.full((PREVIEW_POINTS, 2), far)),
        "others": _symmetric(np.tile(other, (OTHERS, 1))),
        "stop_sign": _symmetric(np.array([1.0, far])),
    }


def _symmetric(high: NDArray[np.float64]) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box((-high).astype(np.float32), high.astype(np.float32), dtype=np.float32)
