"""Lead a vehicle along a path: by a profile of speeds, behind the ego, or so as to meet the ego."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.actions.path_follower import LOOK_M, AtEnd, FollowerLimits, PathFollower, minded
from basu.scenarios.stage import EGO
from basu.scenarios.triggers.along_route import LEAST_MPS, rests_in_s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.scenarios.paths import Path


Speeds = float | tuple[tuple[float, float], ...]  # m/s; or (m along the path, m/s) pairs, linear between them
COMFORT = 0.8  # of the brake is used for what is known beforehand


def bend_speeds_mps(path: Path, sideways_mps2: float, brake_mps2: float) -> NDArray[np.float64]:
    """(N,) the speeds at a path's points at which its bends throw outwards by no more, braked for beforehand.

    The curvature is taken over 4 m, as a lane's points have kinks that no vehicle follows.
    """
    ahead_m, behind_m = np.minimum(path.s_m + 2.0, path.length_m), np.maximum(path.s_m - 2.0, 0.0)
    turned_rad = np.interp(ahead_m, path.s_m, path.yaw_rad) - np.interp(behind_m, path.s_m, path.yaw_rad)
    curvature = np.abs(turned_rad) / (ahead_m - behind_m)
    speeds_mps: NDArray[np.float64] = np.sqrt(sideways_mps2 / np.maximum(curvature, 1e-4))
    for index in range(len(speeds_mps) - 2, -1, -1):
        step_m = float(path.s_m[index + 1] - path.s_m[index])
        speeds_mps[index] = min(speeds_mps[index], math.sqrt(speeds_mps[index + 1] ** 2 + 2.0 * brake_mps2 * step_m))
    return speeds_mps


class DriveAlong(PathFollower):
    """Lead a vehicle along a path.

    ``considerate`` makes it brake for the ego where that is ahead on its path, ``minds`` for others by name.
    ``at_end``: "hold" brakes to stand at the end of the path, "go on" leaves it rolling straight on, "vanish" takes
    it out of the world. ``to_m`` ends it before the end of the path. ``bends_mps2`` makes it slow down before bends,
    so that it is not thrown outwards by more.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        speed_mps: Speeds,
        *,
        to_m: float | None = None,
        considerate: bool = False,
        minds: Sequence[str] = (),
        at_end: AtEnd = "hold",
        accelerate_mps2: float = 2.5,
        brake_mps2: float = 4.0,
        bends_mps2: float = math.inf,
    ) -> None:
        self.bends_mps2 = bends_mps2
        self.speeds: tuple[tuple[float, float], ...] = (
            speed_mps if isinstance(speed_mps, tuple) else ((0.0, speed_mps),)
        )
        how_fast = " to ".join(f"{mps:g}" for _, mps in self.speeds)
        super().__init__(
            f"{actor} drives {path.length_m if to_m is None else to_m:.0f} m at {how_fast} m/s",
            actor,
            path if to_m is None else path.part(0.0, to_m),
            limits=FollowerLimits(accelerate_mps2, brake_mps2),
            at_end=at_end,
            minds=minded(considerate=considerate, minds=minds),
        )

    def begin(self) -> None:
        """Look at the bends ahead."""
        super().begin()
        self.bend_mps: NDArray[np.float64] | None = None
        if math.isfinite(self.bends_mps2):
            self.bend_mps = bend_speeds_mps(self.path, self.bends_mps2, COMFORT * self.limits.brake_mps2)

    def wanted_mps(self) -> float:
        """By the profile; slower in bends, and towards an end at which it is to stand."""
        s_m, mps = zip(*self.speeds, strict=True)
        wanted_mps = float(np.interp(self.s_m, s_m, mps))
        if self.bend_mps is not None:
            wanted_mps = min(wanted_mps, float(np.interp(self.s_m, self.path.s_m, self.bend_mps)))
        if self.at_end != "hold":
            return wanted_mps
        left_m = max(0.0, self.path.length_m - self.s_m)
        slow_mps = math.sqrt(2.0 * COMFORT * self.limits.brake_mps2 * left_m)
        return min(wanted_mps, max(slow_mps, 0.3))


CLOSE_PER_S = 0.6  # of what the gap is off, made good in a second


class FollowEgo(PathFollower):
    """Lead a vehicle behind the ego on a path, ``gap_m`` from bumper to bumper, for ``for_s`` seconds.

    It answers to what the ego did ``reaction_s`` before, so that a stop without cause may be too much for it.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        gap_m: float,
        for_s: float = math.inf,
        *,
        reaction_s: float = 0.0,
        top_mps: float = 15.0,
        accelerate_mps2: float = 2.5,
        brake_mps2: float = 6.0,
    ) -> None:
        super().__init__(
            f"{actor} follows the ego at {gap_m:g} m", actor, path, limits=FollowerLimits(accelerate_mps2, brake_mps2)
        )
        self.gap_m, self.for_s, self.reaction_s, self.top_mps = gap_m, for_s, reaction_s, top_mps

    def begin(self) -> None:
        """Begin to watch the ego."""
        super().begin()
        self.began_s = self.stage.time_s
        self.seen: deque[tuple[float, float]] = deque(maxlen=1 + round(self.reaction_s / self.stage.step_s))

    def wanted_mps(self) -> float:
        """The ego's speed as it was seen, and more or less as the gap is too wide or too narrow."""
        ego, body = self.stage.body(EGO), self.stage.body(self.actor)
        place_m = self.path.nearest(ego.x_m, ego.y_m, self.s_m, LOOK_M).s_m
        self.seen.append((place_m - self.s_m - ego.half_length_m - body.half_length_m, ego.forward_mps))
        gap_m, ego_mps = self.seen[0]
        return min(max(0.0, ego_mps + CLOSE_PER_S * (gap_m - self.gap_m)), self.top_mps)

    def over(self) -> str | None:
        """When the time is over or the path ends."""
        if self.stage.time_s - self.began_s >= self.for_s - 1e-6:
            return f"followed for {self.for_s:g} s"
        return super().over()


class ReachAtEgosArrival(PathFollower):
    """Lead a vehicle to be ``meet_s_m`` along its path ``offset_s`` after the ego is ``ego_s_m`` along its route.

    A negative offset is before the ego. Each frame the ego is taken to go on at the speed it has, and the vehicle makes
    for the speed that meets it, between ``low_mps`` and ``high_mps``; in the last ``settled_s`` seconds before the
    point it keeps its speed, as a driver with no view of the ego would. Done at the point; the vehicle goes on
    straight, so let a ``DriveAlong`` on the same path follow. ScenarioRunner has the idea as ``SyncArrival``.

    ``ego_stops`` is for an ego that has a stop sign: it is taken to come to rest at its place, and the offset counts
    from then on. So the vehicle meets an ego that drives off again without a look, however slowly it came.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        meet_s_m: float,
        ego_s_m: float,
        offset_s: float = 0.0,
        *,
        low_mps: float = 1.0,
        high_mps: float = 12.0,
        settled_s: float = 1.5,
        accelerate_mps2: float = 3.0,
        brake_mps2: float = 4.0,
        at_end: AtEnd = "go on",
        minds: Sequence[str] = (),
        ego_stops: bool = False,
    ) -> None:
        when = f"{abs(offset_s):.3g} s {'after' if offset_s > 0 else 'before'} the ego" if offset_s else "with the ego"
        when += " has come to rest" * ego_stops
        super().__init__(
            f"{actor} gets to the meeting point {when}",
            actor,
            path,
            limits=FollowerLimits(accelerate_mps2, brake_mps2),
            at_end=at_end,
            minds=minds,
        )
        self.meet_s_m, self.ego_s_m, self.offset_s = meet_s_m, ego_s_m, offset_s
        self.low_mps, self.high_mps, self.settled_s, self.ego_stops = low_mps, high_mps, settled_s, ego_stops

    def begin(self) -> None:
        """The vehicle is not there yet."""
        super().begin()
        self.settled_mps: float | None = None
        self.rested_at_s: float | None = None

    def wanted_mps(self) -> float:
        """The speed at which it meets the ego."""
        if self.settled_mps is not None:
            return self.settled_mps
        due_s = self._ego_in_s() + self.offset_s
        left_m = self.meet_s_m - self.s_m
        wanted_mps = left_m / due_s if due_s > 0.0 else self.high_mps
        wanted_mps = min(max(wanted_mps, self.low_mps), self.high_mps)
        if left_m <= self.settled_s * self.speed_mps and self.speed_mps >= self.low_mps:
            self.settled_mps = self.speed_mps
        return wanted_mps

    def over(self) -> str | None:
        """How far the ego was, once it is at the point."""
        if self.s_m < self.meet_s_m:
            return None
        left_m = self.ego_s_m - self.stage.ego_s_m
        where = f"{left_m:.1f} m before its own" if left_m >= 0.0 else f"{-left_m:.1f} m past its own"
        return f"there at {self.speed_mps:.1f} m/s, the ego {where} at {self.stage.ego.speed_mps:.1f} m/s"

    def _ego_in_s(self) -> float:
        """When the ego is at its place, from now on; negative after it has come to rest there."""
        left_m, speed_mps = self.ego_s_m - self.stage.ego_s_m, self.stage.ego.forward_mps
        if not self.ego_stops:
            return left_m / max(speed_mps, LEAST_MPS)
        if self.rested_at_s is None and rests_in_s(left_m, speed_mps) == 0.0:
            self.rested_at_s = self.stage.time_s
        if self.rested_at_s is not None:
            return self.rested_at_s - self.stage.time_s
        return rests_in_s(left_m, speed_mps)
