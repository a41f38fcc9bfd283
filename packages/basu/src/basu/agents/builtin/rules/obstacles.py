"""Keeps clear of obstacles: follows leaders at a distance, waits for walkers, stops for standing actors.

The model is Treiber, Hennecke and Helbing 2000, "Congested traffic states in empirical observations and microscopic
simulations", equations 2 and 3, without its term for the free road, which is the planner's own affair; so a leader is
followed at exactly ``standoff + headway * speed``. The model does not promise to avoid collisions where a leader brakes
harder than expected; the floor does (Gipps 1981; "responsibility-sensitive safety", Shalev-Shwartz et al. 2017,
definition 1): the leader may at any moment brake as hard as tyres allow, and there is still room to stop behind it.

A leader is taken to brake no harder than ``LEADER_BRAKING_MPS2`` in comfort; where it does, firmer braking follows. The
distance this keeps is that of "responsibility-sensitive safety" (Shalev-Shwartz et al. 2017, definition 1) with our own
comfortable stopping distance in the place of the worst case.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.rules.corridor import AHEAD_M, Strip
from basu.agents.builtin.scene import ActorKind, Restriction, Urgency
from basu.thresholds import IN_MOTION_MPS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from basu.agents.builtin.driving.manner import Following
    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.rules.corridor import Footprint
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry


LEADER_LIMIT_MPS2 = 8.0  # the most that a leader brakes: a car on dry asphalt, 0.8 g
CLOSEST_M = 1.0  # what is left between the bumpers when it does
LEAST_GAP_M = 0.1  # nearer than this the model's quotient means nothing any more


def follow_mps2(gap_m: float, speed_mps: float, leader_mps: float, following: Following) -> float:
    """The most acceleration behind a leader; ``gap_m`` is from bumper to bumper."""
    closing_mps = speed_mps - leader_mps
    root = 2.0 * math.sqrt(following.accel_mps2 * following.brake_mps2)
    wanted_m = following.standoff_m + max(0.0, following.headway_s * speed_mps + speed_mps * closing_mps / root)
    return following.accel_mps2 * (1.0 - (wanted_m / max(gap_m, LEAST_GAP_M)) ** 2)


def floor(gap_m: float, leader_mps: float) -> Restriction:
    """Stop behind where the leader would come to rest if it braked from now on as hard as it can."""
    rests_m = leader_mps * leader_mps / (2.0 * LEADER_LIMIT_MPS2)
    return Restriction(gap_m - CLOSEST_M + rests_m, 0.0, Urgency.RESERVE, "leader braking hard", CLOSEST_M / 2)


SIDE_MARGIN_M = 0.3  # beside the vehicle
STANDOFF_M = 2.0  # kept to what stands ahead
CONTACT_M = 0.4  # the last of it, kept even in an emergency
LEADER_BRAKING_MPS2 = 1.5
WORST_BRAKING_MPS2 = 6.0
REACTION_S, ONCOMING_BRAKING_MPS2 = 1.0, 4.0  # of an oncoming actor in our own way
STEP_IN_M = 1.5  # kept to the place where a person is about to step in
SLOWEST_MPS = 0.2  # a slower person is not about to step in
PULL_AWAY_MPS2 = 0.9  # the soonest one can be somewhere
AFTERWARDS_S = 1.0  # between one leaving a place and the other reaching it
# how far ahead in time movement is followed: a walker may keep on, a car coming out of a side street will stop there
WALKER_TIMES_S = tuple(0.5 * n for n in range(1, 9))
VEHICLE_TIMES_S = (0.5, 1.0, 1.5)
ONCOMING_RAD = math.radians(120.0)  # a vehicle that comes towards us in its own lane keeps to it


class LookAhead(NamedTuple):
    """What one step's look ahead is made with."""

    ego: DrivenVehicle
    front_s_m: float
    half_width_m: float
    body_length_m: float
    strip: Strip


class Obstacles:
    """All other bodies; remembers only which of them it waits for, so as not to waver.

    Attributes:
        path: the driven line; a detour replaces it.
        follow_mps2: after a step, the most acceleration that keeps the distance to a moving leader; inf without one.
    """

    def __init__(self, path: SampledPath, body: VehicleGeometry, following: Following | None = None) -> None:
        """Without ``following``, leaders are kept off like everything else: at the distance comfort stops in."""
        self.path = path
        self.follow_mps2 = math.inf
        self._body = body
        self._following = following
        self._waited_for: frozenset[int] = frozenset()

    def step(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other]) -> list[Restriction]:
        """What the others ask for now."""
        self.follow_mps2 = math.inf
        near = [other for other in others if self._is_near(ego, other)]
        if not near:
            self._waited_for = frozenset()
            return []
        body = self._body
        sight = LookAhead(
            ego,
            place.s_m + body.front_m,
            body.half_width_m + SIDE_MARGIN_M,
            body.front_m + body.rear_m,
            Strip(self.path, place),
        )
        found: list[Restriction] = []
        waited_for: list[int] = []
        for other, away_m in zip(near, sight.strip.away_m(near), strict=True):
            if away_m > _reach_m(other) + sight.half_width_m:
                continue
            now = sight.strip.footprint(other)
            if now is not None and now.overlaps(sight.half_width_m):
                found.extend(self._in_the_way(sight, now, other))
            elif (restriction := self._about_to_step_in(sight, other)) is not None:
                found.append(restriction)
                waited_for.append(other.id)
        self._waited_for = frozenset(waited_for)
        return found

    def _in_the_way(self, sight: LookAhead, now: Footprint, other: Other) -> Iterable[Restriction]:
        """What a body asks for that reaches into the strip: nothing beside or behind us, else to follow or to stop."""
        gap_m = now.from_s_m - sight.front_s_m
        if gap_m < -2.0 * CONTACT_M:
            return
        ahead_mps = other.velocity_x_mps * math.cos(now.heading_rad) + other.velocity_y_mps * math.sin(now.heading_rad)
        if self._following is not None and other.kind is ActorKind.VEHICLE and ahead_mps > IN_MOTION_MPS:
            following = follow_mps2(gap_m, max(sight.ego.speed_mps, 0.0), ahead_mps, self._following)
            self.follow_mps2 = min(self.follow_mps2, following)
            yield floor(gap_m, ahead_mps)
        elif self._following is not None and ahead_mps < -IN_MOTION_MPS and _stays(sight, other, gap_m, ahead_mps):
            # it comes towards us: it needs a moment to see that, and its way to stop
            comes_m = -ahead_mps * REACTION_S + ahead_mps * ahead_mps / (2.0 * ONCOMING_BRAKING_MPS2)
            yield _stopping_for(gap_m - comes_m, 0.0, other)
        else:
            yield _stopping_for(gap_m, ahead_mps, other)

    @staticmethod
    def _is_near(ego: DrivenVehicle, other: Other) -> bool:
        """A cheap first look: neither far away nor well behind."""
        dx_m, dy_m = other.x_m - ego.x_m, other.y_m - ego.y_m
        reach_m = AHEAD_M + other.half_length_m
        return dx_m * dx_m + dy_m * dy_m < reach_m * reach_m

    def _about_to_step_in(self, sight: LookAhead, other: Other) -> Restriction | None:
        """The restriction for an actor that is not in the way yet and will be on our arrival."""
        if other.speed_mps < SLOWEST_MPS:
            return None
        if other.kind is ActorKind.VEHICLE and sight.strip.leads_against(other.yaw_rad, ONCOMING_RAD):
            return None  # wherever it comes to be, it keeps to its own lane
        times_s = WALKER_TIMES_S if other.kind is ActorKind.WALKER else VEHICLE_TIMES_S
        seen = [(after_s, sight.strip.footprint(other, after_s)) for after_s in times_s]
        inside = [(t, f) for t, f in seen if f is not None and f.overlaps(sight.half_width_m)]
        if not inside or (other.kind is ActorKind.VEHICLE and _is_oncoming(other, inside[0][1])):
            return None
        enters_s, leaves_s = inside[0][0], inside[-1][0] + 0.5
        left_m = min(f.from_s_m for _, f in inside) - sight.front_s_m
        beyond_m = max(f.to_s_m for _, f in inside) - sight.front_s_m + sight.body_length_m
        if left_m < -CONTACT_M:
            return None  # it walks or drives into our side, where braking does not help
        slack_s = 2.0 * AFTERWARDS_S if other.id in self._waited_for else AFTERWARDS_S
        soonest_s = _soonest_s(left_m, sight.ego.speed_mps)
        gone_s = beyond_m / max(sight.ego.speed_mps, 0.5)
        if soonest_s > leaves_s + slack_s or gone_s < enters_s - slack_s:
            return None
        return Restriction(
            left_m - STEP_IN_M, 0.0, Urgency.VITAL, f"{other.kind.value} stepping in", STEP_IN_M - CONTACT_M
        )


def _stays(sight: LookAhead, other: Other, gap_m: float, ahead_mps: float) -> bool:
    """Whether an oncoming actor will still reach into the strip when we meet, or in a moment if that is later.

    An actor that turns into the other lane cuts its corner, and is out of our way by then.
    """
    meets_s = gap_m / (max(sight.ego.speed_mps, 0.0) - ahead_mps)
    later = sight.strip.footprint(other, max(0.0, min(meets_s, VEHICLE_TIMES_S[-1])))
    return later is not None and later.overlaps(sight.half_width_m)


def _stopping_for(gap_m: float, ahead_mps: float, other: Other) -> Restriction:
    """Stop behind a body, which itself drives on for what comfortable braking takes it."""
    square = max(ahead_mps, 0.0) ** 2
    drives_on_m = square / (2.0 * LEADER_BRAKING_MPS2)
    drives_on_at_least_m = square / (2.0 * WORST_BRAKING_MPS2)
    return Restriction(
        gap_m - STANDOFF_M + drives_on_m,
        0.0,
        Urgency.VITAL,
        f"{other.kind.value} ahead",
        STANDOFF_M - CONTACT_M + drives_on_at_least_m - drives_on_m,
    )


def _reach_m(other: Other) -> float:
    """How far from its centre a body is felt: its own size, and where it gets within the time that is looked ahead."""
    times_s = WALKER_TIMES_S if other.kind is ActorKind.WALKER else VEHICLE_TIMES_S
    return other.half_length_m + other.half_width_m + other.speed_mps * times_s[-1]


def _soonest_s(distance_m: float, speed_mps: float) -> float:
    """When one is there at the earliest, pulling away as fast as comfort allows."""
    reach = max(distance_m, 0.0)
    return (math.sqrt(max(speed_mps, 0.0) ** 2 + 2.0 * PULL_AWAY_MPS2 * reach) - max(speed_mps, 0.0)) / PULL_AWAY_MPS2


def _is_oncoming(other: Other, where: Footprint) -> bool:
    """Whether a vehicle comes the other way."""
    return abs(math.remainder(other.yaw_rad - where.heading_rad, math.tau)) > ONCOMING_RAD
