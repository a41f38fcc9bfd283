"""Validity of a frame: whether the vehicle is on its route, and how much of the route it validly drove.

A frame counts where three conditions hold:

- Place: the vehicle's origin is at most `BEYOND_M` beyond the edge of the planned lane. Another lane of the planned
  road in the planned direction will do, such as a parking lane.
- Direction: the vehicle neither points nor moves against the route.
- Progress: the place along the route did not jump ahead of the way that the vehicle moved.

Valid progress is the way along the route in such frames. A vehicle may leave its lane for a while: round an obstacle
through the lane beside (`PASSING_M`), anywhere by a slip (`SLIP_M`). Where it returns farther ahead than that, the way
between was not driven, and the drive cannot arrive any more. `Follower` checks one frame at a time: the run feeds it
while it drives, and `validity` feeds it with the record.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.stretches import stretches
from basu.records.history.model import once
from basu.records.structured import StructuredArray
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.routing import Route

BEYOND_M = 0.5  # ALLOWED_OUT_DISTANCE of leaderboard 2.0 and 2.1 (OutsideRouteLanesTest); 1.0 has 1.3
AGAINST_RAD = math.radians(120.0)  # between two directions; MAX_VEHICLE_ANGLE of the same test
LOST_M = 30.0  # from the route: a run ends there (the leaderboard's InRouteTest)
PASSING_M = 50.0
"""Way through the lane beside, to pass an obstacle: two shifting tapers of 19 m (MUTCD 2009, tables 6C-3 and 6C-4: half
of W S²/60 for a shift of 12 ft at 25 mph) beside a city bus of 12.2 m (AASHTO 2011, table 2-1b). As much way in the own
lane earns it anew. BASU's own drivers need up to 26 m in the shipped cases."""
SLIP_M = 5.0
"""Way off the lane and off the road that is forgiven. The progress may also lead the vehicle by so much.

The nearest point of the route leaps by a lane's width where a route changes lanes or bends sharply."""
NEAR_POINTS = (
    5  # points of the route, a metre apart, to both sides: a planned road's end need not be the lane's to the metre
)
LEAP = 2.0  # inside a bend, the nearest point of the route moves faster than the vehicle
_AGAINST = math.cos(AGAINST_RAD)


class Moment(NamedTuple):
    """What decides about one frame: columns of ``history.FRAME``, by their names."""

    route_s_m: float
    lateral_m: float
    x_m: float
    y_m: float
    yaw_rad: float
    velocity_x_mps: float
    velocity_y_mps: float
    road_id: int
    lane_id: int
    in_junction: int
    off_lane_m: float


class Check(NamedTuple):
    """The answer for one frame; it counts where no reason speaks against it."""

    beyond_m: float  # beyond the edge of the lane, where that is too far; 0 otherwise
    against: bool  # pointing or moving against the route
    jump_m: float  # that the progress grew by, where that was a jump; 0 otherwise
    beside: bool  # off its lane, but in the lane beside, as a vehicle is that passes an obstacle

    @property
    def in_lane(self) -> bool:
        """Whether place and direction are those of the route."""
        return not (self.beyond_m or self.against)

    @property
    def valid(self) -> bool:
        """Whether the frame counts."""
        return not (self.beyond_m or self.against or self.jump_m)

    @property
    def sentence(self) -> str:
        """The reasons in words; empty for a frame that counts."""
        return "; ".join(
            words
            for words in (
                f"{self.beyond_m:.1f} m beyond the edge of its lane" if self.beyond_m else "",
                "against the direction of its route" if self.against else "",
                f"{self.jump_m:.0f} m of the route skipped at once" if self.jump_m else "",
            )
            if words
        )


class Gap(NamedTuple):
    """A piece of the route that was not validly driven."""

    from_s_m: float
    to_s_m: float
    tick: int  # in which the vehicle was back on its route

    @property
    def length_m(self) -> float:
        """The length of the piece."""
        return self.to_s_m - self.from_s_m


class Follower:
    """The valid progress of a vehicle along its route; ``step`` takes one frame after the other.

    The ``check`` is that of the latest frame. The place ``reached_m`` is the farthest one in a frame that counts. The
    ``gaps`` are the pieces of the route before it that were not driven.
    """

    def __init__(self, route: Route) -> None:
        self._lanes = PlannedLanes(route)
        self._before: Moment | None = None
        self._ticks = 0
        self._spare_m = PASSING_M  # that the vehicle may still drive off its lane
        self._all_beside = True  # since it left its lane
        self.check = Check(beyond_m=0.0, against=False, jump_m=0.0, beside=False)
        self.reached_m = 0.0
        self.gaps: list[Gap] = []

    @property
    def driven_m(self) -> float:
        """How much of the route was validly driven; the way before the first frame is the benchmark's, and counts."""
        return self.reached_m - sum(gap.length_m for gap in self.gaps)

    def step(self, moment: Moment) -> Check:
        """Check a frame and add its way."""
        before, was_valid, self._before = self._before, self.check.valid, moment
        check = self.check = self._lanes.check(moment, before)
        if before is None:
            self.reached_m = moment.route_s_m
        else:
            begin_m = self.reached_m
            self._spare_m, self._all_beside, self.reached_m, gap_m = followed(
                moment.route_s_m,
                check.in_lane,
                check.valid,
                check.beside,
                was_valid,
                self._spare_m,
                self._all_beside,
                begin_m,
            )
            if gap_m:
                self.gaps.append(Gap(begin_m, self.reached_m, self._ticks))
        self._ticks += 1
        return check


class PlannedLanes:
    """The planned lanes as plain lists: one frame is faster to check with them than with arrays."""

    def __init__(self, route: Route) -> None:
        self._s_m: list[float] = route.s_m.tolist()
        self._width_m: list[float] = widths_m(route).tolist()
        self._yaw_rad: list[float] = route.yaw_rad.tolist()
        self._side = [
            (road, lane > 0) for road, lane in zip(route.road_id.tolist(), route.lane_id.tolist(), strict=True)
        ]

    def check(self, moment: Moment, before: Moment | None) -> Check:
        """Check one frame; ``before`` is the frame before it, None for the first."""
        at = max(0, bisect_right(self._s_m, moment.route_s_m) - 1)
        width_m = self._width_m[at]
        against = is_against(moment.yaw_rad, moment.velocity_x_mps, moment.velocity_y_mps, self._yaw_rad[at])
        beyond_m = too_far_beyond_m(moment.lateral_m, width_m)
        if beyond_m and self.in_lane_of_same_side(
            at, moment.road_id, moment.lane_id, moment.in_junction, moment.off_lane_m
        ):
            beyond_m = 0.0
        jump_m = 0.0
        if before is not None:
            jump_m = jumped_m(moment.route_s_m - before.route_s_m, moment.x_m - before.x_m, moment.y_m - before.y_m)
        return Check(beyond_m, against, jump_m, is_beside(moment.off_lane_m, beyond_m, width_m, against, jump_m))

    def in_lane_of_same_side(self, at: int, road_id: int, lane_id: int, in_junction: int, off_lane_m: float) -> bool:
        """Whether a vehicle at point ``at`` is in any lane of the planned road in the planned direction."""
        if off_lane_m > BEYOND_M or in_junction or lane_id == 0:
            return False
        near = self._side[max(0, at - NEAR_POINTS) : at + NEAR_POINTS + 1]
        return (road_id, lane_id > 0) in near


# Numbers to numbers: `linden_gym` compiles these for many vehicles at once.


def is_against(yaw_rad: float, velocity_x_mps: float, velocity_y_mps: float, planned_rad: float) -> bool:
    """Return whether a vehicle points or moves against the route's direction ``planned_rad``."""
    if math.cos(yaw_rad - planned_rad) < _AGAINST:
        return True
    speed_mps = math.hypot(velocity_x_mps, velocity_y_mps)
    along_mps = velocity_x_mps * math.cos(planned_rad) + velocity_y_mps * math.sin(planned_rad)
    return speed_mps > AT_REST_MPS and along_mps < _AGAINST * speed_mps


def too_far_beyond_m(lateral_m: float, width_m: float) -> float:
    """Return how far a vehicle is beyond the edge of the planned lane, where that is too far; 0 otherwise."""
    beyond_m = abs(lateral_m) - width_m / 2.0
    return beyond_m if beyond_m > BEYOND_M else 0.0


def jumped_m(grown_m: float, moved_x_m: float, moved_y_m: float) -> float:
    """Return the growth of the progress in one frame, where it is far ahead of the vehicle's own way; 0 otherwise."""
    if grown_m <= SLIP_M:
        return 0.0
    return grown_m if grown_m > LEAP * math.hypot(moved_x_m, moved_y_m) + SLIP_M else 0.0


def is_beside(off_lane_m: float, beyond_m: float, width_m: float, against: bool, jump_m: float) -> bool:  # noqa: FBT001 - compiled
    """Return whether a vehicle off its lane is in the lane beside."""
    on_lanes = off_lane_m <= BEYOND_M and beyond_m <= width_m + BEYOND_M
    return on_lanes and beyond_m > 0.0 and not against and jump_m == 0.0


def followed(
    s_m: float,
    in_lane: bool,  # noqa: FBT001 - compiled
    valid: bool,  # noqa: FBT001 - likewise
    beside: bool,  # noqa: FBT001 - likewise
    was_valid: bool,  # noqa: FBT001 - likewise
    spare_m: float,
    all_beside: bool,  # noqa: FBT001 - likewise
    reached_m: float,
) -> tuple[float, bool, float, float]:
    """Return the spare way, whether all since the lane was left lay beside it, the place reached, and a new gap in m.

    The first four describe a frame, as `Check` has them. The others describe the drive until then, as `Follower` has
    them.
    """
    if not in_lane:
        return spare_m, beside and (was_valid or all_beside), reached_m, 0.0
    way_m = s_m - reached_m
    if way_m <= 0.0:
        return spare_m, all_beside, reached_m, 0.0
    if was_valid and valid:
        return min(PASSING_M, spare_m + way_m), all_beside, s_m, 0.0
    if way_m <= min(spare_m, PASSING_M if all_beside and valid else SLIP_M):
        return spare_m - way_m, all_beside, s_m, 0.0
    return spare_m, all_beside, s_m, way_m


def widths_m(route: Route) -> NDArray[np.float64]:
    """Return (N,) the widths of the lanes under the route, 0 if unknown: then the plan is the track of the drive."""
    return np.nan_to_num(route.lane_width_m, nan=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Validity:
    """The validity of a whole drive; all arrays have a value for each frame, (T,)."""

    checks: tuple[Check, ...]
    valid: NDArray[np.bool_]  # the frame counts
    unbroken: NDArray[np.bool_]  # no piece of the route before it was left out
    driven_m: NDArray[np.float64]  # how much of the route was validly driven until then
    gaps: tuple[Gap, ...]
    length_m: float  # of the route

    @property
    def share(self) -> float:
        """The share of the route that was validly driven, 0 to 1."""
        return min(1.0, max(0.0, float(self.driven_m[-1])) / self.length_m) if len(self.driven_m) else 0.0

    @property
    def reached_m(self) -> float:
        """The place along the route to which the vehicle drove without leaving any of it out."""
        return self.gaps[0].from_s_m if self.gaps else float(self.driven_m[-1]) if len(self.driven_m) else 0.0

    def intervals(self) -> list[tuple[int, int]]:
        """(first, end) of each stretch of frames that do not count; ``checks[first].sentence`` says why."""
        return stretches(~self.valid)


@once
def validity(history: History) -> Validity:
    """Check every frame of a record."""
    follower, frames = Follower(history.facts.route), history.frames
    checks, driven_m, unbroken = [], [], []
    for moment in moments(frames):
        checks.append(follower.step(moment))
        driven_m.append(follower.driven_m)
        unbroken.append(not follower.gaps)
    return Validity(
        checks=tuple(checks),
        valid=np.array([check.valid for check in checks], dtype=np.bool_),
        unbroken=np.array(unbroken, dtype=np.bool_),
        driven_m=np.array(driven_m, dtype=np.float64),
        gaps=tuple(follower.gaps),
        length_m=history.facts.route.length_m,
    )


def moments(frames: StructuredArray) -> Iterator[Moment]:
    """Return what decides about each frame of a record."""
    return map(Moment._make, zip(*(frames[name].tolist() for name in Moment._fields), strict=True))


def counts_at(history: History, ticks: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(K,) whether each frame of ``ticks`` counts, judged by itself: cheaper than `validity` for a few of them."""
    lanes = PlannedLanes(history.facts.route)
    return np.array([lanes.check(moment, None).valid for moment in moments(history.frames[ticks])], dtype=np.bool_)


def beyond_edge_m(history: History) -> NDArray[np.float64]:
    """(T,) how far the vehicle's origin is beyond the edge of the planned lane; negative within it."""
    route, frames = history.facts.route, history.frames
    index = np.clip(np.searchsorted(route.s_m, frames["route_s_m"], side="right") - 1, 0, None)
    beyond_m: NDArray[np.float64] = np.abs(frames["lateral_m"]) - widths_m(route)[index] / 2.0
    return beyond_m


def in_planned_lane(history: History) -> NDArray[np.bool_]:
    """(T,) whether the vehicle is in the planned lane, whichever way it goes: its limits and controls hold there."""
    within: NDArray[np.bool_] = beyond_edge_m(history) <= BEYOND_M
    return within
