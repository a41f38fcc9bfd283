"""The ego turns left through oncoming traffic: NHTSA's "left turn across path", with the ego turning."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from basu.scenarios.library.crossing_paths.stream import LEAVES_M, NOTICE_S, Lane, Stream, Way
from basu.scenarios.library.road_users import run_up_m
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, along_lane, crossing, next_junction

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.stage import Pose

TURNS_MPS = 5.0
NEARER_S = 0.8  # by so much of its way the first stands nearer than it has time for: the next needs room behind it
NEXT_S = 0.4  # the second meets an ego that turns without waiting, so long after its arrival
BEHIND_M = 8.5  # from the first's middle to the second's at the least
LOOK_M = 30.0


class EgoTurnsLeft(Stream):
    """The ego turns left through oncoming vehicles: the first turns left as well, the rest go straight on.

    NHTSA pre-crash scenarios 27 and 29, left turn across path from opposite directions, with the ego
    turning. It has to let all of them go first, or to take a gap that is long enough; an ego that drives straight on
    meets the first in its turn.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Number("cars", 3.0, 2.0, 5.0, "", "how many come, rounded, the one that turns among them"),
        Number("speed", 8.0, 5.0, 11.0, "m/s", "of the oncoming vehicles"),
        Number("headway", 2.5, 1.8, 4.0, "s", "from one to the next"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 0.0, "sun_altitude_angle": 12.0}
    aliases: ClassVar[Sequence[str]] = ("SignalizedJunctionLeftTurn", "NonSignalizedJunctionLeftTurn")

    def ways(self) -> Sequence[Lane]:
        """Straight on towards the ego."""
        way = crossing(self.place, "opposite", "straight", approach_m=self.back_m, leave_m=LEAVES_M)
        return [Lane(Way(way.path, way.meet_s_m, way.ego_s_m), NEXT_S)]

    @cached_property
    def meeting(self) -> Way:
        """The way of the first, and where it crosses the ego's lane, drawn on straight through the junction."""
        way = self.lanes[0].way
        entered = next_junction(self.place)
        before_m = way.path.length_m - LEAVES_M - LOOK_M
        stops = along_lane(self.place.carla_map, way.path.at(before_m), 2.0 * LOOK_M + 20.0, ("left",))
        path = way.path.part(0.0, before_m - 1.0).then(stops)
        ahead = Path.straight(self.place.at(entered.from_m), LOOK_M)
        s_m = np.arange(before_m, path.length_m, 0.25)
        near = [ahead.nearest(path.at(float(s)).x_m, path.at(float(s)).y_m) for s in s_m]
        best = int(np.argmin([place.distance_m for place in near]))
        return Way(path, float(s_m[best]), self.place.trigger_s_m + entered.from_m + near[best].s_m)

    def _begins(self, lane: Lane, index: int) -> Pose:
        """The first is nearest; the second is timed by the ego as well, and stands a little behind it at the least."""
        first_m = self.meeting.meet_s_m - run_up_m(TURNS_MPS, NOTICE_S - NEARER_S)
        if index == 0:
            return self.meeting.path.at(first_m)
        speed_mps = self.number("speed")
        second_m = min(lane.way.meet_s_m - run_up_m(speed_mps, NOTICE_S + lane.first_s), first_m - BEHIND_M)
        return lane.way.path.at(second_m - (index - 1) * self.number("headway") * speed_mps)

    def _drives(self, lane: Lane, names: Sequence[str], index: int) -> Behaviour:
        """The first turns left in front of an ego that goes straight on; the second meets one that turns at once."""
        if index > 1:
            return super()._drives(lane, names, index)
        if index == 1:
            return self._timed(names[1], lane, self.number("speed"))
        return self._timed(names[0], Lane(self.meeting, 0.0), TURNS_MPS, name=f"{names[0]} turns left")
