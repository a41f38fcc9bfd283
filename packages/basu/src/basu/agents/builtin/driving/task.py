"""The driving task: the path, the speeds along it, and every sign, light and stop that will be met."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.agents.builtin.driving.manner import BASIC, LEFT_FROM_MAJOR_S, ROUNDABOUT_S
from basu.agents.builtin.driving.path import SPACING_M, SampledPath, make_path
from basu.agents.builtin.driving.speed_profile import SpeedProfile, make_profile
from basu.agents.builtin.rules.gap_acceptance import GapRule, Movement, make_rule, make_zone, movement
from basu.agents.builtin.rules.right_of_way import StopSign, YieldSign
from basu.agents.builtin.rules.stopping_lines import ServiceStop, TrafficLight
from basu.routing import ControlKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.scene import VehicleGeometry
    from basu.routing import Route

JUNCTION_AFTER_M = 15.0  # the crossing a line belongs to begins within this
CROSSING_M = (8.0, 30.0)  # the shortest and longest stretch that is taken for a crossing
MERGE_M = 10.0  # after a yield line: the stretch on which one joins the circulating traffic


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """The path with its speeds, signs, lights and stops, planned once."""

    path: SampledPath
    profile: SpeedProfile
    stop_signs: tuple[StopSign, ...]
    yield_signs: tuple[YieldSign, ...]
    lights: tuple[TrafficLight, ...]
    stops: tuple[ServiceStop, ...]


def make_task(route: Route, body: VehicleGeometry, cap_mps: float, manner: Manner = BASIC) -> Task:
    """Plan the task of a route for a vehicle that drives ``cap_mps`` at most."""
    path = make_path(route.points_m, route.s_m, route.lane_width_m, body)
    nearest = np.searchsorted(route.s_m, path.s_m).clip(0, len(route.s_m) - 1)
    profile = make_profile(path, route.speed_limit_mps[nearest], cap_mps, SPACING_M, manner)
    lines = _Lines(route, path, profile, body, manner)
    of = {kind: [c for c in route.controls if c.kind is kind] for kind in ControlKind}
    return Task(
        path,
        profile,
        tuple(lines.stop_sign(c.s_m) for c in of[ControlKind.STOP_SIGN]),
        (*(lines.yield_sign(c.s_m) for c in of[ControlKind.YIELD_SIGN]), *lines.left_turns()),
        tuple(TrafficLight(c.s_m, c.landmark_id) for c in of[ControlKind.TRAFFIC_LIGHT]),
        tuple(ServiceStop(stop.s_m, stop.name) for stop in route.stops),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Lines:
    """Makes the lines at which one lets others go."""

    route: Route
    path: SampledPath
    profile: SpeedProfile
    body: VehicleGeometry
    manner: Manner

    @property
    def _length_m(self) -> float:
        return self.body.front_m + self.body.rear_m

    def stop_sign(self, s_m: float) -> StopSign:
        """A stop sign with the crossing behind it."""
        end_s_m = _crossing_end_s_m(self.route, s_m)
        zone = make_zone(self.path, s_m, end_s_m, self.body)
        rule = self._rule(movement(self.path, s_m, end_s_m).value, s_m, end_s_m)
        return StopSign(s_m, zone, self._length_m, rule)

    def yield_sign(self, s_m: float) -> YieldSign:
        """A yield sign with the stretch on which one joins the others."""
        zone = make_zone(self.path, s_m + 1.0, s_m + MERGE_M, self.body)
        return YieldSign(s_m, zone, self._length_m, self._rule(ROUNDABOUT_S, s_m, s_m + MERGE_M))

    def left_turns(self) -> Iterator[YieldSign]:
        """Junctions in which the path turns left past no sign and no light; known to those with a sense of gaps."""
        if self.manner.gaps is None:
            return
        for from_s_m, to_s_m in junctions(self.route):
            ruled = any(-JUNCTION_AFTER_M < c.s_m - from_s_m < to_s_m - from_s_m for c in self.route.controls)
            if not ruled and movement(self.path, from_s_m, to_s_m) is Movement.LEFT:
                zone = make_zone(self.path, from_s_m, to_s_m, self.body)
                rule = self._rule(LEFT_FROM_MAJOR_S, from_s_m, to_s_m)
                yield YieldSign(from_s_m, zone, self._length_m, rule, self.path.heading_at_rad(from_s_m))

    def _rule(self, critical_s: float, from_s_m: float, to_s_m: float) -> GapRule | None:
        """The manner's own rule for a line, as fast as the bend behind it allows."""
        if self.manner.gaps is None:
            return None
        first, end = self.path.index_at(from_s_m), self.path.index_at(to_s_m) + 1
        return make_rule(self.manner.gaps, self.manner, critical_s, min(self.profile.limit_mps[first:end]))


def junctions(route: Route) -> list[tuple[float, float]]:
    """Where the route is inside of a junction: pairs of arc lengths, m."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], route.is_junction, [False]]).astype(np.int8)))
    return [(float(route.s_m[a]), float(route.s_m[b - 1])) for a, b in edges.reshape(-1, 2).tolist()]


def _crossing_end_s_m(route: Route, line_s_m: float) -> float:
    """Where the junction behind a line is left."""
    shortest_m, longest_m = CROSSING_M
    after = (route.s_m >= line_s_m) & (route.s_m <= line_s_m + longest_m)
    s_m, inside = route.s_m[after], route.is_junction[after]
    if not inside.any() or s_m[inside][0] > line_s_m + JUNCTION_AFTER_M:
        return line_s_m + shortest_m
    begins = int(np.argmax(inside))
    left = np.flatnonzero(~inside[begins:])
    end_s_m = float(s_m[begins + left[0]]) if len(left) else float(s_m[-1])
    return max(end_s_m, line_s_m + shortest_m)
