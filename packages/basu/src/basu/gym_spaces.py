"""Spaces, observations and actions of the gymnasium environment; `basu.gym` describes shapes and units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla
import gymnasium
import numpy as np

from basu.errors import UserError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from basu.episode import Episode, Observation

PREVIEW_POINTS, PREVIEW_M = 10, 5.0  # of the route ahead, and between them
OTHERS = 8  # road users in an observation
FASTEST_MPS, HARDEST_MPS2, FASTEST_TURN_RADPS = 40.0, 20.0, 4.0  # bounds of the boxes, beyond any shuttle's
FARTHEST_M = 60.0  # likewise, of places


class Preview:
    """Turns frames of one episode into observations."""

    def __init__(self, episode: Episode) -> None:
        self.episode = episode
        route = episode.run.route
        self._s_m, self._xy_m = route.s_m, route.points_m[:, :2]
        self._yaw_rad = np.unwrap(route.yaw_rad)
        self._ahead_m = PREVIEW_M * np.arange(1, PREVIEW_POINTS + 1)
        self._boxes = _boxes()

    def of(self, seen: Observation) -> dict[str, NDArray[np.float32]]:
        """The observation of a frame."""
        ego = seen.frame.ego
        cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
        to_vehicle = np.array([[cos, -sin], [sin, cos]])  # world vector @ this = forward, right
        s_m = seen.progress.s_m + self._ahead_m
        ahead = np.column_stack([np.interp(s_m, self._s_m, self._xy_m[:, axis]) for axis in (0, 1)])
        heading = math.remainder(ego.yaw_rad - float(np.interp(seen.progress.s_m, self._s_m, self._yaw_rad)), math.tau)
        forward_mps2 = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
        limit_mps = self.episode.run.vehicle.get_speed_limit() / 3.6
        state = (
            ego.speed_mps,
            forward_mps2,
            ego.angular_velocity_z_radps,
            seen.progress.lateral_m,
            heading,
            limit_mps,
        )
        found = {
            "ego": np.array(state),
            "route": (ahead - (ego.x_m, ego.y_m)) @ to_vehicle,
            "others": self._others(seen, to_vehicle),
        }
        return {name: _clipped(values, self._boxes[name]) for name, values in found.items()}

    def _others(self, seen: Observation, to_vehicle: NDArray[np.float64]) -> NDArray[np.float64]:
        """(8, 6) the nearest road users."""
        ego, table = seen.frame.ego, np.zeros((OTHERS, 6))
        rows = self.episode.metrics.others(seen.frame)
        if rows:
            given = np.array([row[2:] for row in rows])  # x, y, z, yaw, velocity x, y
            away_m = np.hypot(given[:, 0] - ego.x_m, given[:, 1] - ego.y_m)
            given = given[np.argsort(away_m, kind="stable")[:OTHERS]]
            turned = np.remainder(given[:, 3] - ego.yaw_rad + math.pi, math.tau) - math.pi
            place = (given[:, :2] - (ego.x_m, ego.y_m)) @ to_vehicle
            table[: len(given)] = np.column_stack([np.ones(len(given)), place, turned, given[:, 4:6] @ to_vehicle])
        return table


def control_from(action: ArrayLike) -> carla.VehicleControl:
    """Return the control of an action ``[pedals, steer]``, both in -1..1.

    Raises:
        UserError: the action has another shape, is no number, or lies outside of the space.
    """
    try:
        values = np.asarray(action, dtype=np.float64)
    except (TypeError, ValueError):
        raise UserError(f"the action is {action!r}; give two numbers in -1..1, [pedals, steer]") from None
    if values.shape != (2,):
        raise UserError(f"the action has the shape {values.shape}; give (2,), [pedals, steer]")
    if not np.all(np.abs(values) <= 1.0):  # false for NaN
        given = ", ".join(f"{value:g}" for value in values)
        raise UserError(
            f"the action is [{given}]; both numbers must be in -1..1 (to clip them: gymnasium.wrappers.ClipAction)"
        )
    pedals, steer = values.tolist()
    return carla.VehicleControl(throttle=max(0.0, pedals), brake=max(0.0, -pedals), steer=steer)


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
    }


def _symmetric(high: NDArray[np.float64]) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box((-high).astype(np.float32), high.astype(np.float32), dtype=np.float32)
