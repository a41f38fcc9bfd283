"""A passenger runs for the shuttle as it leaves its stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import WalkAlong
from basu.scenarios.criteria import Arrives, Gentle, InTime, LeastDistance, NoCollision
from basu.scenarios.library.road_users import facing_deg
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, pavement_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec, Pose
from basu.scenarios.triggers import Faster

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

SLANT_M = 3.0  # farther ahead than where they stop the shuttle, they set out
NEAR_M = 0.5


class RunningForTheShuttle(Scenario):
    """A pedestrian runs across the street for the shuttle as it leaves its stop, and stops in front of it.

    They come from the other pavement, stand before the shuttle and wave, and then give way to it. The hard one of the
    shuttle's own: the ego has just begun to move and looks after its doors. It must stop, and softly: passengers have
    not sat down yet.
    """

    group = Group.SHUTTLE
    parameters = (
        Number("ahead", 13.0, 9.0, 25.0, "m", "from the ego's place to where they stop before it"),
        Number("speed", 3.5, 2.0, 5.0, "m/s", "of their run"),
        Number("leaves", 0.5, 0.1, 3.0, "m/s", "the ego's speed at which they run"),
        Number("waves", 4.0, 1.0, 8.0, "s", "that they stand before it"),
    )
    needs_m = 60.0
    timeout_s = 60.0

    @property
    def _from_m(self) -> float:
        return pavement_m(self.place, self.number("ahead"), "left")

    @property
    def _begins(self) -> Pose:
        return self.place.at(self.number("ahead") + SLANT_M, self._from_m, facing_deg(-1.0))

    def actors(self) -> Sequence[ActorSpec]:
        """The late passenger across the street."""
        return [ActorSpec("passenger", "walker.pedestrian.0005", self._begins)]

    def trigger(self) -> Behaviour:
        """The ego moves off."""
        return Faster(self.number("leaves"))

    def conflict(self) -> Behaviour:
        """They run into its way, wave, and get out of it on the right."""
        ahead_m = self.number("ahead")
        stands = self.place.at(ahead_m)
        over = Path.through([self._begins[:3], stands[:3]])
        way = over.then(
            Path.through([stands[:3], self.place.at(ahead_m, pavement_m(self.place, ahead_m, "right"))[:3]])
        )
        return WalkAlong(
            "passenger", way, self.number("speed"), pause_at_m=over.length_m - 0.8, pause_s=self.number("waves")
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact and no near miss, no passenger aboard is thrown over (2.5 m/s²), and the ego goes on."""
        return [
            NoCollision(),
            LeastDistance(NEAR_M, to="passenger", while_moving=True),
            Gentle(2.5),
            Arrives(),
            InTime(),
        ]
