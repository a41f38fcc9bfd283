"""Scenario I of the thesis: the ego goes straight and loses control on a wet road or over something in the road."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import Either, InTurn, JitterControls, SetFriction, Together
from basu.scenarios.criteria import Arrives, InTime, KeepsLane, NoCollision, Regains
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoBeyond, EgoOver, EgoPasses

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

PLACES = 3  # where control is lost, one after another: as in ScenarioRunner's
PATCH_M = 3.0  # radius of a wet place
SLIPS_S = 1.5  # how long the controls are off on a wet place
BUMP_MODEL = "static.prop.dirtdebris01"  # as in ScenarioRunner's: a heap of dirt, 0.15 m high, that wheels roll over
ACROSS_DEG = 90.0  # by which it is turned: its longer side, 1.9 m, lies across the lane
PAST_M = 1.0  # behind a bump, where its disturbance ends
LONGEST_S = 10.0  # of the disturbance by a bump, if the ego stops on it
WET: dict[str, float] = {
    "cloudiness": 90.0,
    "precipitation": 60.0,
    "precipitation_deposits": 50.0,
    "wetness": 80.0,
    "sun_altitude_angle": 40.0,
}


class ControlLoss(Scenario):
    """The ego goes straight and loses control in three places: on wet patches, or over bumps.

    Its steering is pulled aside and jitters with its throttle on each patch of little friction. The same happens while
    it is over a heap of dirt in its lane. It has to come back into its lane and reach its target. NHTSA pre-crash
    scenario: control loss without prior vehicle action. An ego that does not steer against it leaves the lane.
    """

    group = Group.CONTROL_LOSS
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("cause", ("wet", "bump"), "what the control is lost by"),
        Choice("side", ("right", "left"), "to which it is pulled first; then to the other, by turns"),
        Number("pull", 0.2, 0.05, 0.6, "", "share of the full steering by which it is off in the mean"),
        Number("jitter", 0.06, 0.0, 0.3, "", "standard deviation of the steering's noise, share of the full steering"),
        Number("surge", 0.15, 0.0, 0.5, "", "standard deviation of the throttle's noise, share of the full throttle"),
        Number("friction", 0.35, 0.1, 1.0, "", "of the tyres on a wet patch; a dry road has 1.1 for the shuttle"),
        Number("first", 22.0, 10.0, 35.0, "m", "from the trigger point to the first place"),
        Number("apart", 16.0, 12.0, 20.0, "m", "between the places"),
    )
    weather: ClassVar[Mapping[str, float]] = WET
    timeout_s = 45.0
    needs_m = 80.0
    reference = "behavioral"

    @property
    def places_m(self) -> list[float]:
        """Return where control is lost, along the ego's route: wet patches begin there, and bumps lie 3 m farther."""
        first_m = self.place.trigger_s_m + self.number("first")
        return [first_m + number * self.number("apart") for number in range(PLACES)]

    def actors(self) -> Sequence[ActorSpec]:
        """Return the bumps, where they are the cause; they lie on the road in the middle of the lane."""
        if self.choice("cause") != "bump":
            return []
        poses = [self.place.at(ahead_m, 0.0, ACROSS_DEG) for ahead_m in self._middles_m()]
        return [ActorSpec(_bump(number), BUMP_MODEL, pose, on_ground=False) for number, pose in enumerate(poses)]

    def partners(self) -> Collection[str]:
        """Return no partner: the ego may drive over a bump, and its own course is disturbed."""
        return ()

    def _middles_m(self) -> list[float]:
        """Return the middles of wet patches or bumps, from the trigger point."""
        return [s_m - self.place.trigger_s_m + PATCH_M for s_m in self.places_m]

    def setup(self) -> Behaviour | None:
        """The wet patches, where that is the cause."""
        if self.choice("cause") != "wet":
            return None
        patches = [SetFriction(self.place.at(m), PATCH_M, self.number("friction")) for m in self._middles_m()]
        return Together(*patches, name="wet patches")

    def trigger(self) -> Behaviour:
        """The ego is at the first place."""
        return EgoPasses(self.places_m[0], "the first place")

    def conflict(self) -> Behaviour:
        """Control is lost in each place in turn."""
        sign = 1.0 if self.choice("side") == "right" else -1.0
        steps: list[Behaviour] = []
        for number, s_m in enumerate(self.places_m):
            if number:
                steps.append(EgoPasses(s_m, f"place {number + 1}"))
            steps.append(self._lost(number, sign * (-1.0) ** number))
        return InTurn(*steps, name="control is lost and has to be regained")

    def criteria(self) -> Sequence[Criterion]:
        """The ego's middle never leaves the lane, and soon after the last place it is back in the middle of it."""
        return [KeepsLane(0.0), Regains(), NoCollision(), Arrives(), InTime()]

    def _lost(self, number: int, sign: float) -> Behaviour:
        """Return the disturbance of the controls in one place; an ego that goes round a bump has none."""
        jitter, surge, pull = self.number("jitter"), self.number("surge"), sign * self.number("pull")
        if self.choice("cause") == "wet":
            return JitterControls(SLIPS_S, steer=jitter, throttle=surge, pull=pull)
        bump = _bump(number)
        over = JitterControls(LONGEST_S, steer=jitter, throttle=surge, pull=pull)
        return Either(InTurn(EgoOver(bump), over), EgoBeyond(bump, PAST_M), name=f"the ego crosses {bump}")


def _bump(number: int) -> str:
    """Return a bump's name."""
    return f"bump {number + 1}"
