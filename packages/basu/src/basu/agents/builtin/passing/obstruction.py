"""`Standing` finds the next `StandingRow` of standing actors in the lane: extent, standing time, least waiting time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.rules.corridor import Strip
from basu.agents.builtin.rules.obstacles import SIDE_MARGIN_M
from basu.agents.builtin.scene import ActorKind
from basu.thresholds import STANDING_TRAFFIC_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.passing.road import RoadBesidePath
    from basu.agents.builtin.rules.corridor import Footprint
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry


LOOK_M = 65.0  # beyond what a strip reaches ahead
SAME_BLOCK_M = 10.0  # between two that stand in the lane: nearer than this one does not go back in between
LONGEST_BLOCK_M = 25.0  # more than this is a jam
QUEUE_M = 20.0  # a vehicle that stands this near before a line or a junction waits for its turn …
QUEUE_PATIENCE_S = 60.0  # … unless it stands for so long
DROVE_FACTOR = 4.0  # a vehicle seen driving has a driver, and gets so much more time


class StandingRow(NamedTuple):
    """Bodies that stand in the lane close behind one another: their extent along and across the path, m."""

    from_s_m: float
    to_s_m: float
    left_m: float
    right_m: float
    members: frozenset[int]
    patience_factor: float  # by how much longer than usual it is waited behind
    least_patience_s: float
    stood_s: float  # the one that came to rest last


class Standing:
    """Remembers since when other actors stand, and which of them were seen driving."""

    def __init__(self, body: VehicleGeometry) -> None:
        self._body = body
        self._since_s: dict[int, float] = {}
        self._drove: set[int] = set()

    def block(
        self, path: SampledPath, road: RoadBesidePath, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other]
    ) -> StandingRow | None:
        """The next block ahead on a path; None where nothing stands there, or what stands is on foot."""
        self._remember(ego.time_s, others)
        others = [o for o in others if o.id in self._since_s and math.hypot(o.x_m - ego.x_m, o.y_m - ego.y_m) < LOOK_M]
        if not others:
            return None
        reach_m = self._body.half_width_m + SIDE_MARGIN_M
        front_s_m = place.s_m + self._body.front_m
        strip = Strip(path, place)
        seen: list[tuple[Footprint, Other]] = []
        for other, away_m in zip(others, strip.away_m(others), strict=True):
            if away_m > other.half_length_m + other.half_width_m + reach_m:
                continue
            footprint = strip.footprint(other)
            if footprint is not None and footprint.overlaps(reach_m) and footprint.from_s_m > front_s_m - 0.5:
                seen.append((footprint, other))
        seen.sort(key=lambda one: (one[0].from_s_m, one[1].id))
        together = _joined(seen)
        if not together or any(other.kind is ActorKind.WALKER for _, other in together):
            return None
        to_s_m = max(footprint.to_s_m for footprint, _ in together)
        drove = any(other.id in self._drove for _, other in together)
        may_queue = any(other.kind is ActorKind.VEHICLE for _, other in together)
        return StandingRow(
            from_s_m=together[0][0].from_s_m,
            to_s_m=to_s_m,
            left_m=min(footprint.left_m for footprint, _ in together),
            right_m=max(footprint.right_m for footprint, _ in together),
            members=frozenset(other.id for _, other in together),
            patience_factor=DROVE_FACTOR if drove else 1.0,
            least_patience_s=QUEUE_PATIENCE_S if may_queue and road.next_line_s_m(to_s_m) < to_s_m + QUEUE_M else 0.0,
            stood_s=ego.time_s - max(self._since_s[other.id] for _, other in together),
        )

    def _remember(self, time_s: float, others: Sequence[Other]) -> None:
        """Keep the time at which each came to rest."""
        now = {}
        for other in others:
            if other.speed_mps < STANDING_TRAFFIC_MPS:
                now[other.id] = self._since_s.get(other.id, time_s)
            else:
                self._drove.add(other.id)
        self._since_s = now


def _joined(seen: Sequence[tuple[Footprint, Other]]) -> list[tuple[Footprint, Other]]:
    """The first of the visible actors in order, and each one that stands close behind another."""
    joined: list[tuple[Footprint, Other]] = []
    for one in seen:
        if joined and max(footprint.to_s_m for footprint, _ in joined) + SAME_BLOCK_M < one[0].from_s_m:
            break
        joined.append(one)
    return joined
