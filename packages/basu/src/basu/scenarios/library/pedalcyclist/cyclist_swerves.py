"""A cyclist swerves round an opening door into the ego's lane."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from basu.scenarios.actions import CloseDoor, DriveAlong, InTurn, OpenDoor, ReachAtEgosArrival, Together, Wait
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedalcyclist.bicycles import BICYCLE, CAR, HINGE_M, SWAY_M
from basu.scenarios.library.road_users import FRONT_M, ego_is_due
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, parked_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.stage import Pose

RIDES_S = 5.0  # from setting out to the swerve
OVER_M = 7.0  # the swerve
CLEAR_M = 2.5  # before the door's hinge they are all the way out, and so far behind it they turn back
BACK_M = 14.0  # the way back to the edge
OPEN_S = 2.5  # the door is shut again before the ego comes to it


class CyclistSwerves(Scenario):
    """A cyclist at the edge of the street swerves into the ego's lane, round a door that opens before them.

    The ego comes up from behind, faster than they are: it must brake behind them, or have kept enough room. NHTSA 2007,
    scenario 14: pedalcyclist, no prior vehicle maneuver; what leads to it is a dooring. A hard one. The door takes no
    space, unlike that of ``dooring``, and is shut again before the ego comes to it. So a driver that sees the door and
    no cyclist gains nothing.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("ahead", 65.0, 50.0, 90.0, "m", "from the trigger point to the door's hinge"),
        Number("speed", 4.0, 2.5, 5.5, "m/s", "of the cyclist"),
        Number("notice", 1.3, 0.6, 3.0, "s", "by which they are where they swerve before the ego would be"),
        Number("edge", 2.2, 1.9, 2.6, "m", "to the right of the ego's lane, where they ride"),
        Number("into", 0.1, -0.4, 0.6, "m", "to the right of the lane's middle, where the swerve takes them"),
    )
    needs_m = 110.0

    @property
    def _car(self) -> Pose:
        at_m = self.number("ahead") - HINGE_M
        return self.place.at(at_m, parked_m(self.place, at_m))

    @property
    def _swerve_m(self) -> float:
        """Where it begins, ahead of the trigger point."""
        return self.number("ahead") - CLEAR_M - OVER_M

    @property
    def _begin_m(self) -> float:
        """Where they wait for the ego, likewise."""
        return max(5.0, self._swerve_m - RIDES_S * self.number("speed"))

    @cached_property
    def _way(self) -> Path:
        """At the edge, out, and back."""
        place, edge_m, into_m = self.place, self.number("edge"), self.number("into")
        edge = Path.of_route(place.route, place.trigger_s_m + self._begin_m)
        swerve_m = self._swerve_m - self._begin_m
        out = edge.swerved(swerve_m, OVER_M, edge_m, into_m)
        return out.swerved(swerve_m + OVER_M + 2.0 * CLEAR_M, BACK_M, 0.0, edge_m - into_m)

    def actors(self) -> Sequence[ActorSpec]:
        """The cyclist at the edge, and the parked car."""
        return [ActorSpec("cyclist", BICYCLE, self._way.at(0.0)), ActorSpec("parked", CAR, self._car)]

    def trigger(self) -> Behaviour:
        """The ego will come by when they swerve."""
        return ego_is_due(self.place, self._swerve_m, RIDES_S + self.number("notice") + 1.0, "the swerve")

    def conflict(self) -> Behaviour:
        """They ride up, the door opens, they swerve, and go on at the edge; the door shuts."""
        speed_mps, swerve_m = self.number("speed"), self._swerve_m - self._begin_m
        door = InTurn(OpenDoor("parked"), Wait(OPEN_S), CloseDoor("parked"), name="the door")
        on_m = swerve_m + OVER_M + 2.0 * CLEAR_M + BACK_M
        return InTurn(
            ReachAtEgosArrival(
                "cyclist",
                self._way,
                swerve_m,
                self.place.trigger_s_m + self._swerve_m - FRONT_M,
                -self.number("notice"),
                low_mps=0.7 * speed_mps,
                high_mps=1.4 * speed_mps,
                settled_s=1.0,
            ),
            Together(door, DriveAlong("cyclist", self._way, speed_mps, to_m=on_m + 5.0)),
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, no near miss of the cyclist, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="cyclist", while_moving=True), Arrives(), InTime()]
