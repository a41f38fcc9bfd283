"""Scenario IV of the thesis: the ego stops at a junction without lights and negotiates it with another vehicle."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn, Meanwhile, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, HeedsStopSigns, InTime, LeastDistance, NoCollision
from basu.scenarios.library.crossing_paths.stream import departs_s, passed_a_resting_ego, rest_s_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import crossing, next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoArrives, EgoPasses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.criteria.criterion import Played
    from basu.scenarios.exercise import Finding
    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths import Crossing, JunctionAhead
    from basu.scenarios.paths.crossings import Side

OTHER = "other"
SIDES: dict[str, Side] = {"left": "left", "right": "right"}
MODELS: dict[str, str] = {
    "car": "vehicle.nissan.micra",
    "van": "vehicle.volkswagen.t2",
    "motorcycle": "vehicle.kawasaki.ninja",
}
SPARE_M, LEAVE_M = 10.0, 40.0  # of the other's way, before where it waits and behind the junction
SLOWEST_MPS, UNHURRIED = 2.0, 0.6  # of the other while the ego comes: at the least, and of its speed at the most
HURRY = 1.3  # of its speed, once the ego is at the line
SETTLED_S = 1.8  # before they meet, the other keeps its speed
DAYLIGHT: dict[str, float] = {"cloudiness": 10.0, "sun_altitude_angle": 60.0}


class UnsignalizedIntersection(Scenario):
    """At a junction without lights another vehicle makes for the point that the ego has to cross.

    The other sets off when the ego reaches a first region before the junction; when the ego reaches a second one, at
    its line, the other accelerates and goes on. It is timed by the ego's rest at the line: an ego that drives off
    again without a look meets it. The ego has to stop at its sign, give way and pass. NHTSA pre-crash scenario:
    straight crossing paths, or turning into a path, at a non-signalized junction.
    """

    group = Group.CROSSING_PATHS
    aliases = ("NoSignalJunctionCrossing",)
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", tuple(SIDES), "from which the other comes"),
        Choice("other", tuple(MODELS), "what it is"),
        Number("first", 20.0, 10.0, 40.0, "m", "from the junction to the region in which the other sets off"),
        Number("second", 6.0, 2.0, 9.0, "m", "from the junction to the region in which it accelerates"),
        Number("waits", 75.0, 50.0, 100.0, "m", "from the meeting point to where the other waits"),
        Number("speed", 8.0, 6.0, 12.0, "m/s", "of the other once it goes on"),
        Number("offset", 0.0, -1.5, 1.5, "s", "after an ego that drives off without a look it is at the meeting point"),
    )
    weather: ClassVar[Mapping[str, float]] = DAYLIGHT
    timeout_s = 60.0
    needs_m = 60.0
    needs_junction = True

    @property
    def junction(self) -> JunctionAhead:
        """The next one on the ego's route."""
        return next_junction(self.place)

    @cached_property
    def crossing(self) -> Crossing:
        """The other's way across it."""
        before_m = self.number("waits") + SPARE_M
        side = SIDES[self.choice("side")]
        return crossing(self.place, side, junction=self.junction, approach_m=before_m, leave_m=LEAVE_M)

    def actors(self) -> Sequence[ActorSpec]:
        """The other, waiting on its own street."""
        way = self.crossing
        return [ActorSpec(OTHER, MODELS[self.choice("other")], way.path.at(way.meet_s_m - self.number("waits")))]

    def trigger(self) -> Behaviour:
        """The ego is in the first region."""
        return EgoPasses(self._before(self.number("first")), "the first region")

    def conflict(self) -> Behaviour:
        """The other makes for the meeting, and accelerates once the ego is in the second region."""
        way, speed_mps = self.crossing, self.number("speed")
        second = EgoPasses(self._before(self.number("second")), "the second region")
        return InTurn(
            Meanwhile(second, self._makes_for_it(UNHURRIED * speed_mps), name="the other makes for the meeting"),
            self._makes_for_it(HURRY * speed_mps),
            DriveAlong(OTHER, way.path, speed_mps, to_m=way.meet_s_m + 5.0, at_end="go on"),
            name="negotiation",
        )

    def resolution(self) -> Behaviour:
        """The other drives away, and the ego passes the junction and arrives."""
        return Meanwhile(EgoArrives(), DriveAlong(OTHER, self.crossing.path, self.number("speed"), at_end="vanish"))

    def exercised(self, played: Played) -> Finding:
        """The other met, or one for which the ego rested at its line."""
        rest_m, way = rest_s_m(self.place, self.junction), self.crossing
        found = None if rest_m is None else passed_a_resting_ego(played, rest_m, {OTHER: way.path.at(way.meet_s_m)})
        return found or super().exercised(played)

    def criteria(self) -> Sequence[Criterion]:
        """Stop at the sign, touch no actor, and pass; a metre to the vehicle with the right of way is near already."""
        return [HeedsStopSigns(), NoCollision(), LeastDistance(1.0, to=OTHER, while_moving=True), Arrives(), InTime()]

    def _makes_for_it(self, top_mps: float) -> Behaviour:
        """The other makes for the meeting point, so as to be there when the ego is that has not looked."""
        way, rest_m = self.crossing, rest_s_m(self.place, self.junction)
        after_s = 0.0 if rest_m is None else departs_s(way.ego_s_m - rest_m, self.junction.turn)
        return ReachAtEgosArrival(
            OTHER,
            way.path,
            way.meet_s_m,
            way.ego_s_m if rest_m is None else rest_m,
            after_s + self.number("offset"),
            ego_stops=rest_m is not None,
            low_mps=SLOWEST_MPS,
            high_mps=top_mps,
            settled_s=SETTLED_S,
        )

    def _before(self, ahead_m: float) -> float:
        """So far before the junction, along the ego's route."""
        return self.place.trigger_s_m + self.junction.from_m - ahead_m
