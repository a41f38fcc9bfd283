"""A cyclist goes straight on where the ego turns right."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedalcyclist.bicycles import BICYCLE, SWAY_M
from basu.scenarios.library.road_users import FRONT_M
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoPasses

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

BEGINS_M = 32.0  # before the junction, where the cyclist waits for the ego to come
BEYOND_M = 40.0  # behind the beginning of the junction, where their way ends
EGO_BEFORE_M = 45.0  # before the junction, the ego when they set out


class CyclistAtRightTurn(Scenario):
    """A cyclist on the ego's right goes straight on where the ego turns right, across their way.

    They ride beside the ego's lane and reach the ego's turning way when it does: the right hook. Ohio Revised Code
    4511.36 leaves the right of way to them. NHTSA 2007, scenario 13: pedalcyclist, prior vehicle maneuver. The hard one
    of its group. An ego that never steers stays beside them and fails by leaving its way; an ego that follows the route
    blindly rides them down.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("beside", 1.9, 1.6, 2.4, "m", "from the middle of the ego's lane to the cyclist"),
        Number("speed", 4.0, 2.5, 5.5, "m/s", "of the cyclist, about which they time themselves"),
        Number("early", -0.1, -1.0, 1.0, "s", "by which they are on the ego's way before it"),
    )
    needs_m = 90.0
    aliases = ("VehicleTurningRight",)

    @cached_property
    def _way(self) -> Path:
        """Straight on, beside the ego's lane."""
        from_m = next_junction(self.place).from_m
        start = self.place.at(from_m - BEGINS_M, self.number("beside"))
        return Path.straight(start, BEGINS_M + BEYOND_M)

    @cached_property
    def _meeting(self) -> tuple[float, float]:
        """Return where both paths cross: m along the cyclist's path, and m along the route."""
        route, junction = self.place.route, next_junction(self.place)
        behind = route.s_m >= self.place.trigger_s_m + junction.from_m - 1.0
        x_m, y_m = route.points_m[behind, 0], route.points_m[behind, 1]
        right_m = [self._way.nearest(float(x), float(y)).right_m for x, y in zip(x_m, y_m, strict=True)]
        over = int(np.argmax(np.array(right_m) >= 0.0))  # the first point of the route beyond their way
        return self._way.nearest(float(x_m[over]), float(y_m[over])).s_m, float(route.s_m[behind][over])

    def actors(self) -> Sequence[ActorSpec]:
        """The cyclist at the edge of the ego's lane, ahead of it."""
        return [ActorSpec("cyclist", BICYCLE, self._way.at(0.0))]

    def trigger(self) -> Behaviour:
        """The ego comes near the junction."""
        near_m = self.place.trigger_s_m + next_junction(self.place).from_m - EGO_BEFORE_M
        return EgoPasses(max(near_m, self.place.trigger_s_m + 2.0), f"{EGO_BEFORE_M:.0f} m before the junction")

    def conflict(self) -> Behaviour:
        """They ride up to the ego's turning way, over it, and on."""
        meet_s_m, ego_s_m = self._meeting
        speed_mps = self.number("speed")
        return InTurn(
            ReachAtEgosArrival(
                "cyclist",
                self._way,
                meet_s_m,
                ego_s_m - FRONT_M,
                -self.number("early"),
                low_mps=0.6 * speed_mps,
                high_mps=1.5 * speed_mps,
                settled_s=2.0,
            ),
            DriveAlong("cyclist", self._way, speed_mps, to_m=meet_s_m + 12.0),
        )

    def criteria(self) -> Sequence[Criterion]:
        """They are not touched or nearly so, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="cyclist", while_moving=True), Arrives(), InTime()]
