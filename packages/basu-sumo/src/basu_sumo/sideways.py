"""`Sideways`: spreads SUMO's sudden sideways steps, at lane changes and parking, over several simulated steps.

The shown pose follows SUMO's. After a step aside, the distance that is left is kept as a shift, which then shrinks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from basu_sumo.frames import Pose

JUMP_M = 0.3  # aside in one step: less is driven along a curve
FARTHEST_M = 6.0  # aside in one step: more is no change of lanes or parking, but another place
ALONG_M = 5.0  # ahead in one step, likewise
TURNED_DEG = 15.0  # in one step: a vehicle that turns has moved along a curve
STANDING_MPS = 1.0  # aside, of a vehicle that stands: 3 m to a parking space take 3 s
STEEPEST, FASTEST_MPS = 0.35, 1.2
"""Aside for each metre ahead, as at the kerb, and at most: a change of lanes of 3.3 m takes 2.8 s; estimates."""
TURN_DEG_S = 30.0  # of the nose towards the way that is shown


class _State(NamedTuple):
    """What is kept of a vehicle: SUMO's last pose, and how far what was shown lay from it."""

    pose: Pose
    shift_m: tuple[float, float]
    turned_deg: float


class Sideways:
    """The shown poses of all vehicles."""

    def __init__(self, step_s: float) -> None:
        """Look at no vehicle yet; ``step_s`` is SUMO's step."""
        self._step_s = step_s
        self._states: dict[str, _State] = {}

    def shown(self, name: str, pose: Pose) -> Pose:
        """Return where a vehicle is to be shown that SUMO has at ``pose``; called once a step."""
        before = self._states.get(name)
        if before is None:
            self._states[name] = _State(pose, (0.0, 0.0), 0.0)
            return pose
        state = _next(before, pose, self._step_s)
        self._states[name] = state
        if state.shift_m == (0.0, 0.0) and state.turned_deg == 0.0:
            return pose
        x_m, y_m = pose.x_m + state.shift_m[0], pose.y_m + state.shift_m[1]
        return pose._replace(x_m=x_m, y_m=y_m, yaw_deg=pose.yaw_deg + state.turned_deg)

    def forget(self, name: str) -> None:
        """Forget a vehicle that has left."""
        self._states.pop(name, None)


def _next(before: _State, pose: Pose, step_s: float) -> _State:
    """Return the state a step later."""
    yaw = math.radians(pose.yaw_deg)
    dx_m, dy_m = pose.x_m - before.pose.x_m, pose.y_m - before.pose.y_m
    ahead_m, aside_m = dx_m * math.cos(yaw) + dy_m * math.sin(yaw), dy_m * math.cos(yaw) - dx_m * math.sin(yaw)
    turned_deg = abs((pose.yaw_deg - before.pose.yaw_deg + 180.0) % 360.0 - 180.0)
    shift_m = before.shift_m
    if JUMP_M < abs(aside_m) < FARTHEST_M and abs(ahead_m) < ALONG_M and turned_deg < TURNED_DEG:
        shift_m = (shift_m[0] + aside_m * math.sin(yaw), shift_m[1] - aside_m * math.cos(yaw))
    left_m = math.hypot(*shift_m)
    if left_m == 0.0 and before.turned_deg == 0.0:
        return _State(pose, shift_m, 0.0)
    stands = abs(ahead_m) < 1e-3
    by_m = STANDING_MPS * step_s if stands else min(STEEPEST * abs(ahead_m), FASTEST_MPS * step_s)
    by_m = min(by_m, left_m)
    share = 0.0 if left_m == 0.0 else 1.0 - by_m / left_m
    to_right_m = shift_m[0] * math.sin(yaw) - shift_m[1] * math.cos(yaw)  # CARLA's y points south: right is positive
    wanted_deg = 0.0 if stands else math.degrees(math.atan2(math.copysign(by_m, to_right_m), abs(ahead_m)))
    most_deg = TURN_DEG_S * step_s
    nose_deg = before.turned_deg + min(max(wanted_deg - before.turned_deg, -most_deg), most_deg)
    if share == 0.0 and abs(nose_deg) < 1e-9:
        return _State(pose, (0.0, 0.0), 0.0)
    return _State(pose, (share * shift_m[0], share * shift_m[1]), nose_deg)
