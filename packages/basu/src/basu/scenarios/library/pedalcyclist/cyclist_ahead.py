"""A slow cyclist rides ahead in the ego's lane."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from basu.scenarios.actions import DriveAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedalcyclist.bicycles import BICYCLE, EASY_MPS2, PASSING_M
from basu.scenarios.library.road_users import ego_is_due
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

ASIDE_M = 2.5  # to the right of the ego's lane, where they let it pass
OVER_M = 12.0  # on which they get there
AFTERWARDS_M = 20.0  # that they ride on


class CyclistAhead(Scenario):
    """A cyclist rides ahead in the ego's lane, slower than the ego, and makes room after a while.

    The ego may follow, or overtake with the three feet that Ohio asks for. NHTSA 2007, scenario 14: pedalcyclist, no
    prior vehicle maneuver.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("ahead", 35.0, 25.0, 60.0, "m", "from the trigger point to where they set out"),
        Number("speed", 3.0, 1.5, 5.0, "m/s", "of the cyclist"),
        Number("right", 0.4, 0.0, 0.9, "m", "of the lane's middle, where they ride"),
        Number("rides", 40.0, 20.0, 60.0, "m", "that they ride in the lane"),
        Number("notice", 3.5, 2.0, 6.0, "s", "that the ego needs to them when they set out"),
    )
    timeout_s = 80.0
    needs_m = 130.0
    aliases = ("HazardAtSideLane",)

    @cached_property
    def _way(self) -> Path:
        """In the lane, then to its right."""
        from_m, right_m = self.place.trigger_s_m + self.number("ahead"), self.number("right")
        lane = Path.of_route(self.place.route, from_m)
        return lane.swerved(self.number("rides"), OVER_M, right_m, ASIDE_M)

    def actors(self) -> Sequence[ActorSpec]:
        """The cyclist in the lane."""
        pose = self.place.at(self.number("ahead"), self.number("right"))
        return [ActorSpec("cyclist", BICYCLE, pose)]

    def trigger(self) -> Behaviour:
        """The ego comes up behind."""
        return ego_is_due(self.place, self.number("ahead"), self.number("notice"), "the cyclist")

    def conflict(self) -> Behaviour:
        """They ride."""
        return DriveAlong(
            "cyclist",
            self._way,
            self.number("speed"),
            to_m=self.number("rides") + OVER_M + AFTERWARDS_M,
            accelerate_mps2=EASY_MPS2,
        )

    def criteria(self) -> Sequence[Criterion]:
        """They are not touched, three feet are kept, and the ego goes on."""
        return [NoCollision(), LeastDistance(PASSING_M, to="cyclist", while_moving=True), Arrives(), InTime()]
