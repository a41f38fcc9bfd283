"""Scenario V of the thesis: the ego enters a roundabout among circulating traffic and leaves by a given exit."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn, Meanwhile, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, KeepsLane, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import crossing, next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoArrives, EgoPasses

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths import Crossing
    from basu.scenarios.paths.crossings import Side

SIDES: dict[str, Side] = {"left": "left", "opposite": "opposite", "right": "right"}
MODELS = ("vehicle.nissan.micra", "vehicle.audi.a2", "vehicle.seat.leon", "vehicle.toyota.prius")
APPROACH_M, LEAVE_M = 75.0, 60.0  # of the others' way, before and behind the roundabout
SETS_OFF_M = 40.0  # from the ego to the roundabout, when the others set off
FIRST_M, APART_M = 24.0, 7.5  # from the meeting point to where the first waits, and from one to the next
SLOWEST_MPS, HURRY_MPS = 3.5, 4.0  # at the least, and above their speed, to meet the ego


class Roundabout(Scenario):
    """The ego enters a roundabout among circulating traffic and leaves it by the exit of its route.

    Cars come one after another from the entry to the left of the ego's and pass before it. The ego gives way, goes in
    behind them, and leaves by its exit. NHTSA pre-crash scenario: turning into a path at a non-signalized junction.
    Thesis: vehicle speed around 10 mph or more.
    """

    group = Group.CROSSING_PATHS
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", tuple(SIDES), "from which the others come into the roundabout"),
        Number("cars", 2.0, 1.0, 4.0, "", "that circulate; rounded"),
        Number("speed", 4.5, 4.0, 7.0, "m/s", "of the cars; 4.5 m/s are 10 mph"),
        Number("gap", 2.5, 1.5, 6.0, "s", "between the cars at the ego's entry"),
        Number("offset", 0.0, -2.0, 2.0, "s", "after the ego the first would be at its entry"),
    )
    timeout_s = 60.0
    needs_m = 50.0

    @cached_property
    def crossing(self) -> Crossing:
        """The others' way: it meets the ego's at the ego's entry."""
        side = SIDES[self.choice("side")]
        return crossing(self.place, side, junction=next_junction(self.place), approach_m=APPROACH_M, leave_m=LEAVE_M)

    @property
    def names(self) -> list[str]:
        """The roles of the others, in the order in which they come."""
        return [f"car {number + 1}" for number in range(round(self.number("cars")))]

    def actors(self) -> Sequence[ActorSpec]:
        """The others, one behind the other on their street."""
        way = self.crossing
        first_m = way.meet_s_m - FIRST_M
        return [
            ActorSpec(name, MODELS[number % len(MODELS)], way.path.at(first_m - number * APART_M))
            for number, name in enumerate(self.names)
        ]

    def trigger(self) -> Behaviour:
        """The ego comes to the roundabout."""
        before_m = next_junction(self.place).from_m - SETS_OFF_M
        return EgoPasses(self.place.trigger_s_m + before_m, f"{SETS_OFF_M:g} m before the roundabout")

    def conflict(self) -> Behaviour:
        """They circulate, until the last of them has passed the ego's entry."""
        way = self.crossing
        meetings = [self._meeting(name, number, way) for number, name in enumerate(self.names)]
        early = [
            InTurn(meeting, DriveAlong(name, way.path, self.number("speed")), name=f"{name} circulates")
            for name, meeting in zip(self.names[:-1], meetings[:-1], strict=True)
        ]
        return Meanwhile(meetings[-1], *early, name="traffic circulates past the ego's entry")

    def resolution(self) -> Behaviour:
        """They drive away; the ego leaves by its exit and arrives."""
        path, speed_mps = self.crossing.path, self.number("speed")
        return Meanwhile(EgoArrives(), *(DriveAlong(name, path, speed_mps, at_end="vanish") for name in self.names))

    def _meeting(self, name: str, number: int, way: Crossing) -> Behaviour:
        """Return the behaviour that brings one vehicle to the ego's entry, a set gap after the previous vehicle."""
        return ReachAtEgosArrival(
            name,
            way.path,
            way.meet_s_m,
            way.ego_s_m,
            self.number("offset") + number * self.number("gap"),
            low_mps=SLOWEST_MPS,
            high_mps=self.number("speed") + HURRY_MPS,
            settled_s=1.0,
        )

    def criteria(self) -> Sequence[Criterion]:
        """Touch no actor, keep to the ring's lane, leave by the exit; a metre to a circulating car is near already."""
        others = [LeastDistance(0.8, to=name, while_moving=True) for name in self.names]
        return [NoCollision(), *others, KeepsLane(0.3), Arrives(), InTime()]
