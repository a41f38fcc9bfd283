"""Road departure without prior manoeuvre: gusts push the ego towards the edge of a straight road."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import InTurn, PullSteering, Wait
from basu.scenarios.criteria import Arrives, InTime, KeepsLane, NoCollision, Regains
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoPasses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

LULL_S = 0.8  # between two gusts
WINDY: dict[str, float] = {"cloudiness": 70.0, "wind_intensity": 90.0, "sun_altitude_angle": 35.0}


class CrossWind(Scenario):
    """Gusts push the ego towards the edge of a straight road.

    Wind is not part of CARLA's physics: a gust is a steady pull of the steering to one side, which is what a driver has
    to hold against. NHTSA pre-crash scenario: road edge departure without prior vehicle maneuver. An ego that
    does not steer against it drives over the kerb or into the oncoming lane.
    """

    group = Group.ROAD_DEPARTURE
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", ("right", "left"), "to which it is pushed"),
        Number("push", 0.22, 0.05, 0.5, "", "share of the full steering that a gust is worth"),
        Number("gust", 2.0, 0.5, 2.5, "s", "a gust lasts"),
        Number("gusts", 2.0, 1.0, 3.0, "", "in a row; rounded"),
        Number("first", 25.0, 10.0, 35.0, "m", "from the trigger point to where the first gust begins"),
    )
    weather: ClassVar[Mapping[str, float]] = WINDY
    timeout_s = 40.0
    needs_m = 75.0

    def trigger(self) -> Behaviour:
        """The ego is where the wind begins."""
        return EgoPasses(self.place.trigger_s_m + self.number("first"), "where the wind begins")

    def conflict(self) -> Behaviour:
        """Gust after gust."""
        push = self.number("push") if self.choice("side") == "right" else -self.number("push")
        steps: list[Behaviour] = []
        for number in range(round(self.number("gusts"))):
            steps += [Wait(LULL_S)] * bool(number) + [PullSteering(push, self.number("gust"))]
        return InTurn(*steps, name="gusts")

    def criteria(self) -> Sequence[Criterion]:
        """The middle stays in the lane, and is back in the middle of it soon after the last gust."""
        return [KeepsLane(0.0), Regains(), NoCollision(), Arrives(), InTime()]
