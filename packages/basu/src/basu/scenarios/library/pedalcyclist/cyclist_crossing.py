"""A cyclist comes out of a side street."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, cast

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedalcyclist.bicycles import BICYCLE, SWAY_M
from basu.scenarios.library.road_users import FRONT_M, other_side
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import crossing, crossings, next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.paths import Crossing
    from basu.scenarios.paths.crossings import Side

RIDES_S = 6.0  # from setting out to the ego's lane


class CyclistCrossing(Scenario):
    """A cyclist crosses the ego's street at a junction without minding the stop sign.

    They ride up the side street, in view, and cross so as to be before the ego when it comes. The ego has the right of
    way and would still hit them. NHTSA 2007, scenario 14: pedalcyclist, no prior vehicle maneuver. The clear one of its
    group: a straight way at a steady pace.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("speed", 4.0, 2.5, 6.0, "m/s", "of the cyclist, about which they time themselves"),
        Number("early", 0.2, -0.8, 1.0, "s", "by which they are in the lane's middle before the ego"),
        Number("settled", 2.0, 1.2, 3.5, "s", "for which at last they ride on without looking at the ego"),
        Choice("side", ("right", "left"), "from which they come, where a street leads there"),
    )
    needs_m = 90.0
    needs_junction = True

    @cached_property
    def _way(self) -> Crossing:
        junction, side = next_junction(self.place), cast("Side", self.choice("side"))
        if side not in {way.side for way in crossings(self.place, junction)}:
            side = other_side(side)
        return crossing(self.place, side, junction=junction, approach_m=50.0, leave_m=30.0)

    @property
    def _ego_s_m(self) -> float:
        return self._way.ego_s_m - FRONT_M

    def actors(self) -> Sequence[ActorSpec]:
        """The cyclist in the side street, so far away as to need some seconds."""
        far_m = max(0.0, self._way.meet_s_m - self.number("speed") * RIDES_S)
        return [ActorSpec("cyclist", BICYCLE, self._way.path.at(far_m))]

    def trigger(self) -> Behaviour:
        """The ego needs as long as they do, and a moment to get going."""
        return TimeToArrival(self._ego_s_m, RIDES_S + 0.8, "the cyclist's way")

    def conflict(self) -> Behaviour:
        """They ride up, cross, and ride on."""
        speed_mps, way = self.number("speed"), self._way
        return InTurn(
            ReachAtEgosArrival(
                "cyclist",
                way.path,
                way.meet_s_m,
                self._ego_s_m,
                -self.number("early"),
                low_mps=0.6 * speed_mps,
                high_mps=1.6 * speed_mps,
                settled_s=self.number("settled"),
            ),
            DriveAlong("cyclist", way.path, speed_mps, to_m=way.meet_s_m + 25.0),
        )

    def criteria(self) -> Sequence[Criterion]:
        """They are not touched or nearly so, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="cyclist", while_moving=True), Arrives(), InTime()]
