"""Spaces, observations and actions of the gymnasium environment; `basu.gym` describes shapes and units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import gymnasium
import numpy as np

from basu.conditions import STEP_S
from basu.errors import UserError
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

PREVIEW_POINTS, PREVIEW_M = 10, 5.0  # of the route ahead, and between them
OTHERS = 8  # road users in an observation
FASTEST_MPS, HARDEST_MPS2, FASTEST_TURN_RADPS = 40.0, 20.0, 4.0  # bounds of the boxes, beyond any shuttle's
FARTHEST_M = 60.0  # likewise, of places


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
        many = self._ahead.observed(
            rows,
            s_m,
            np.array([progress.lateral_m]),
            np.array([limit_mps]),
            table,
            np.ones(table.shape[:2], np.bool_),
            self._stopped,
        )
        return {name: values[0] for name, values in many.items()}


class EgoRows(NamedTuple):
    """The motion of E vehicles under test: fields of `VehicleMotion`, each an array (E,)."""

    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    velocity_x_mps: NDArray[np.float64]
    velocity_y_mps: NDArray[np.float64]
    velocity_z_mps: NDArray[np.float64]
    acceleration_x_mps2: NDArray[np.float64]
    acceleration_y_mps2: NDArray[np.float64]
    angular_velocity_z_radps: NDArray[np.float64]

    @property
    def speed_mps(self) -> NDArray[np.float64]:
        """(E,) speeds over ground."""
        speed_mps: NDArray[np.float64] = np.sqrt(
            self.velocity_x_mps**2 + self.velocity_y_mps**2 + self.velocity_z_mps**2
        )
        return speed_mps

    @property
    def push_mps2(self) -> NDArray[np.float64]:
        """(E,) horizontal accelerations."""
        push_mps2: NDArray[np.float64] = np.sqrt(self.acceleration_x_mps2**2 + self.acceleration_y_mps2**2)
        return push_mps2


class RouteAhead:
    """Makes observations of vehicles on one route.

    Attributes:
        signs_m: (S,) places of the lines of the stop signs along the route.
    """

    def __init__(self, route: Route, vehicle: Vehicle) -> None:
        """Take the route, and the box of the vehicles."""
        self.signs_m = np.array([control.s_m for control in route.controls if control.kind is ControlKind.STOP_SIGN])
        self._front_m, self._half_m = vehicle.front_m, (vehicle.front_m + vehicle.rear_m) / 2.0
        self._s_m, self._xy_m = route.s_m, route.points_m[:, :2]
        self._yaw_rad = np.unwrap(route.yaw_rad)
        self._ahead_m = PREVIEW_M * np.arange(1, PREVIEW_POINTS + 1)
        self._boxes = _boxes()

    def observed(
        self,
        ego: EgoRows,
        s_m: NDArray[np.float64],
        lateral_m: NDArray[np.float64],
        limit_mps: NDArray[np.float64],
        others: NDArray[np.float64],
        is_there: NDArray[np.bool_],
        stopped: NDArray[np.bool_],
    ) -> dict[str, NDArray[np.float32]]:
        """Return the observations of E vehicles, each array with E as its first axis.

        Args:
            ego: their motion.
            s_m: (E,) places along the route.
            lateral_m: (E,) offsets from it, positive to the right.
            limit_mps: (E,) what is posted to them; 0 for none.
            others: (E, K, 6) x, y, z, yaw, velocity x and y of the road users near each, CARLA's frame.
            is_there: (E, K) whether a row of ``others`` counts.
            stopped: (E, S) whether each has stopped at each sign until now, by `stops_at`.
        """
        cos, sin = np.cos(ego.yaw_rad), np.sin(ego.yaw_rad)
        at_m = s_m[:, None] + self._ahead_m
        x_m, y_m = (np.interp(at_m, self._s_m, self._xy_m[:, axis]) for axis in (0, 1))
        heading = _turned(ego.yaw_rad - np.interp(s_m, self._s_m, self._yaw_rad))
        forward_mps2 = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
        state = (ego.speed_mps, forward_mps2, ego.angular_velocity_z_radps, lateral_m, heading, limit_mps)
        found = {
            "ego": np.stack(state, axis=-1),
            "route": _in_frame(x_m, y_m, ego, cos, sin),
            "others": self._others(ego, cos, sin, others, is_there),
            "stop_sign": self._next_sign(s_m, stopped),
        }
        return {name: _clipped(values, self._boxes[name]) for name, values in found.items()}

    def to_signs_m(self, s_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (E, S) the way from the front bumpers of vehicles at ``s_m`` to the lines, negative beyond them."""
        ahead_m: NDArray[np.float64] = self.signs_m - (s_m[:, None] + self._front_m)
        return ahead_m

    def _next_sign(self, s_m: NDArray[np.float64], stopped: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return (E, 2) 1 and the way to the next line at which the vehicle has to stop; zeros where none is near."""
        if not len(self.signs_m):
            return np.zeros((len(s_m), 2))
        ahead_m = self.to_signs_m(s_m)
        due = ~stopped & (ahead_m >= -self._half_m) & (ahead_m <= FARTHEST_M)
        nearest_m = np.where(due, ahead_m, np.inf).min(axis=1)
        there = np.isfinite(nearest_m)
        return np.stack([there, np.where(there, nearest_m, 0.0)], axis=-1)

    @staticmethod
    def _others(
        ego: EgoRows,
        cos: NDArray[np.float64],
        sin: NDArray[np.float64],
        others: NDArray[np.float64],
        is_there: NDArray[np.bool_],
    ) -> NDArray[np.float64]:
        """Return (E, 8, 6) the nearest road users of each vehicle."""
        table = np.zeros((len(cos), OTHERS, 6))
        kept = min(OTHERS, others.shape[1])
        if not is_there.any():
            return table
        place = _in_frame(others[..., 0], others[..., 1], ego, cos, sin)
        away_m = np.where(is_there, np.hypot(place[..., 0], place[..., 1]), np.inf)
        velocity = np.stack(
            [
                others[..., 4] * cos[:, None] + others[..., 5] * sin[:, None],
                others[..., 5] * cos[:, None] - others[..., 4] * sin[:, None],
            ],
            axis=-1,
        )
        turned = _turned(others[..., 3] - ego.yaw_rad[:, None])[..., None]
        rows = np.concatenate([np.ones_like(turned), place, turned, velocity], axis=-1)
        rows[~is_there] = 0.0
        nearest = np.argsort(away_m, axis=1, kind="stable")[:, :kept]
        table[:, :kept] = np.take_along_axis(rows, nearest[..., None], axis=1)
        return table


def _in_frame(
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    ego: EgoRows,
    cos: NDArray[np.float64],
    sin: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return places (E, K) as (E, K, 2) in the vehicles' frames: forward, right."""
    to_x_m, to_y_m = x_m - ego.x_m[:, None], y_m - ego.y_m[:, None]
    cos, sin = cos[:, None], sin[:, None]
    return np.stack([to_x_m * cos + to_y_m * sin, to_y_m * cos - to_x_m * sin], axis=-1)


def _turned(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return angles within -pi..pi."""
    turned: NDArray[np.float64] = np.remainder(angle_rad + math.pi, math.tau) - math.pi
    return turned


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


def _clipped(values: NDArray[np.float64], box: gymnasium.spaces.Box) -> NDArray[np.float32]:
    """The values within the bounds of their box."""
    clipped: NDArray[np.float32] = np.clip(values.astype(np.float32), box.low, box.high)
    return clipped


def _boxes() -> dict[str, gymnasium.spaces.Box]:
    """The boxes that `basu.gym` describes."""
    turn, far = math.pi + 1e-3, FARTHEST_M
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
