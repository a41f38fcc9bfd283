"""Scenario I of the thesis: the ego goes straight and loses control on a wet road or over something in the road."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import Bump, InTurn, JitterControls, SetFriction, Together
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

PLACES = 3  # where control is lost, one after another: as in ScenarioRunner's
PATCH_M = 3.0  # radius of a wet place
SLIPS_S = 1.5  # how long the controls are off on a wet place
AFTER_S = 0.3  # from the first jolt of a bump, by the front wheels, to that of the rear wheels
REBOUND = 0.5  # share of the first jolt with which the second goes the other way
WET: dict[str, float] = {
    "cloudiness": 90.0,
    "precipitation": 60.0,
    "precipitation_deposits": 50.0,
    "wetness": 80.0,
    "sun_altitude_angle": 40.0,
}


class ControlLoss(Scenario):
    """The ego goes straight and loses control in three places: on wet patches, or over bumps.

    Its steering is pulled aside and jitters with its throttle on each patch of little friction, or is jolted by each
    bump; it has to come back into its lane and reach its target. NHTSA pre-crash scenario: control loss without prior
    vehicle action. An ego that does not steer against it leaves the lane and the road.
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
        """Where control is lost, along the ego's route."""
        first_m = self.place.trigger_s_m + self.number("first")
        return [first_m + number * self.number("apart") for number in range(PLACES)]

    def setup(self) -> Behaviour | None:
        """The wet patches, where that is the cause."""
        if self.choice("cause") != "wet":
            return None
        ahead_m = [s_m - self.place.trigger_s_m + PATCH_M for s_m in self.places_m]
        patches = [SetFriction(self.place.at(m), PATCH_M, self.number("friction")) for m in ahead_m]
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
            steps += self._lost(sign * (-1.0) ** number)
        return InTurn(*steps, name="control is lost and has to be regained")

    def criteria(self) -> Sequence[Criterion]:
        """The ego's middle never leaves the lane, and soon after the last place it is back in the middle of it."""
        return [KeepsLane(0.0), Regains(), NoCollision(), Arrives(), InTime()]

    def _lost(self, sign: float) -> list[Behaviour]:
        """What happens to the controls in one place."""
        pull = sign * self.number("pull")
        if self.choice("cause") == "wet":
            jitter, surge = self.number("jitter"), self.number("surge")
            return [JitterControls(SLIPS_S, steer=jitter, throttle=surge, pull=pull)]
        return [Bump(2.0 * pull, AFTER_S), Bump(-2.0 * REBOUND * pull, AFTER_S)]
