"""Which contacts the leaderboard counts as collisions.

Sources: ``CollisionTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branches leaderboard-1.0 and
leaderboard-2.0 (2.1 is the same). In all of them a party that was just hit is not counted again for 5 s. Version 1.0
forgets a place when the vehicle is 5 m away and counts nothing within 3 m of one it remembers. Version 2 remembers the
last place only, counts nothing within 5 m of it, and nothing that happens to a vehicle at rest, which is not its fault.
Both ignore pavements. The two seconds of silence that divide contacts in BASU's own score are another rule: there, a
wall that is scraped along for 20 m is hit once, here every 5 m.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from basu.metrics.leaderboard.rules import Event, Kind, Version

if TYPE_CHECKING:
    from basu.records.history import Collision, History

Place = tuple[float, float]
SAME_PLACE_M, FORGOTTEN_M, SAME_PARTY_S = 3.0, 5.0, 5.0  # 1.0: MIN_AREA, MAX_AREA, MAX_ID_TIME
RADIUS_M, AT_REST_MPS = 5.0, 0.1  # 2.x: COLLISION_RADIUS, EPSILON


@dataclass(slots=True)
class _Memory:
    """What a version still knows of earlier collisions."""

    places: list[Place] = field(default_factory=list)
    party: int | None = None
    party_t_s: float = 0.0

    def forget(self, here: Place, t_s: float) -> None:
        """Drop what is far away or long ago."""
        self.places = [place for place in self.places if math.dist(place, here) <= FORGOTTEN_M]
        if self.party is not None and t_s - self.party_t_s > SAME_PARTY_S:
            self.party = None


def collisions(history: History, version: Version) -> tuple[Event, ...]:
    """The collisions that ``version`` counts."""
    frames, speed_mps = history.frames, history.speed_mps()
    near_m = SAME_PLACE_M if version is Version.V1_0 else RADIUS_M
    memory = _Memory()
    found = []
    messages: dict[int, list[Collision]] = defaultdict(list)
    for event in history.collisions:
        messages[event.tick].append(event)
    for tick in range(min(messages, default=0), len(frames) if messages else 0):
        here: Place = (float(frames["x_m"][tick]), float(frames["y_m"][tick]))
        t_s = float(frames["t_s"][tick])
        for event in messages.get(tick, ()):
            if memory.party == event.other_id or any(math.dist(place, here) <= near_m for place in memory.places):
                continue
            if version is not Version.V1_0 and speed_mps[max(0, tick - 1)] < AT_REST_MPS:
                continue
            kind = _kind(event)
            if version is Version.V1_0 and kind is None:
                continue
            memory.places = [*memory.places, here] if version is Version.V1_0 else [here]
            memory.party_t_s = t_s
            if event.other_id != 0:
                memory.party = event.other_id
            if kind is not None:
                found.append(Event(kind=kind, tick=tick))
        memory.forget(here, t_s)
    return tuple(found)


def _kind(event: Collision) -> Kind | None:
    """What was hit, None for what does not count."""
    what = event.other_type
    if ("static" in what or "traffic" in what) and "sidewalk" not in what:
        return Kind.COLLISION_STATIC
    if "vehicle" in what:
        return Kind.COLLISION_VEHICLE
    return Kind.COLLISION_PEDESTRIAN if "walker" in what else None
