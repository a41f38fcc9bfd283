"""Be at a point when the ego is at its own: the meeting that most conflicts are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions.puppet import AtEnd, Limits, Puppet
from basu.scenarios.triggers.along_route import LEAST_MPS, rests_in_s

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.paths import Path


class ReachAtEgosArrival(Puppet):
    """Lead a vehicle to be ``meet_s_m`` along its path ``offset_s`` after the ego is ``ego_s_m`` along its route.

    A negative offset is before the ego. Each frame the ego is taken to go on at the speed it has, and the vehicle makes
    for the speed that meets it, between ``low_mps`` and ``high_mps``; in the last ``settled_s`` seconds before the
    point it keeps its speed, as a driver who does not see the ego would. Done at the point; the vehicle goes on
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
            limits=Limits(accelerate_mps2, brake_mps2),
            at_end=at_end,
            minds=minds,
        )
        self.meet_s_m, self.ego_s_m, self.offset_s = meet_s_m, ego_s_m, offset_s
        self.low_mps, self.high_mps, self.settled_s, self.ego_stops = low_mps, high_mps, settled_s, ego_stops

    def begin(self) -> None:
        """Nobody is there yet."""
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
