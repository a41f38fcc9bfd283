"""A vehicle in the next lane drifts over: NHTSA's "drifting, same direction"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import ChangeLane, Drift, DriveAlong, InTurn, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.library.road_users import BLUEPRINTS, EGO_HALF_LENGTH_M, HALF_LENGTH_M, SETS_OFF_MPS2, run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

NEIGHBOUR = "neighbour"
NOTICE_S = 6.0
BACK_S = 2.0
STREET_MPS = 10.0
NARROWLY = (0.8, 2.0)  # of its own speed: what it varies by to be where it has to be
LEAVES_M = 80.0


class DriftingNeighbour(Scenario):
    """On a street with two lanes each way, a slower car on the left drifts into the ego's lane, half a length ahead.

    NHTSA pre-crash scenario 19, vehicles drifting, same direction. Its driver looks at a telephone; it stays half in
    both lanes for a while and then goes back. There is no lane to give way to: the ego has to fall back.
    """

    group = Group.LANE_CHANGE
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "suv", "van"), "the drifting vehicle"),
        Number("speed", 4.5, 3.0, 6.0, "m/s", "of the other"),
        Number("gap", 3.0, 0.5, 8.0, "m", "from the ego's nose to the other's tail when it begins to drift"),
        Number("rate", 0.8, 0.4, 1.6, "m/s", "sideways"),
        Number("over", 2.4, 1.8, 3.3, "m", "to its right"),
        Number("stays", 2.5, 0.0, 5.0, "s", "for which it stays there"),
        Number("ahead", 55.0, 45.0, 80.0, "m", "of the trigger point: where the other begins to drift"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 60.0, "sun_altitude_angle": -10.0}
    timeout_s = 60.0
    needs_m = 110.0

    def actors(self) -> Sequence[ActorSpec]:
        """The neighbour, ahead in the lane on the left."""
        begin_m = self.number("ahead") - run_up_m(self.number("speed"), NOTICE_S)
        return [ActorSpec(NEIGHBOUR, BLUEPRINTS[self.choice("kind")], self.place.at(begin_m, -self._apart_m))]

    @property
    def _apart_m(self) -> float:
        return self.place.width_m(self.number("ahead"))

    @property
    def _ego_s_m(self) -> float:
        """Where the ego is when the drift begins."""
        behind_m = HALF_LENGTH_M[self.choice("kind")] + self.number("gap") + EGO_HALF_LENGTH_M
        return self.place.trigger_s_m + self.number("ahead") - behind_m

    def trigger(self) -> Behaviour:
        """The ego comes up on the right."""
        return TimeToArrival(self._ego_s_m, NOTICE_S, "the neighbour's tail")

    def conflict(self) -> Behaviour:
        """It is there with the ego, drifts over, and goes back."""
        speed_mps, over_m, apart_m = self.number("speed"), self.number("over"), self._apart_m
        begin_m = self.place.trigger_s_m + self.number("ahead")
        lane = Path.of_route(self.place.route, 0.0, None, -apart_m)
        low, high = NARROWLY
        parts: list[Behaviour] = [
            ReachAtEgosArrival(
                NEIGHBOUR,
                lane,
                begin_m,
                self._ego_s_m,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            Drift(NEIGHBOUR, lane, over_m, self.number("rate"), speed_mps=speed_mps),
        ]
        drifted_m = begin_m + over_m / self.number("rate") * speed_mps
        if (stays_m := self.number("stays") * speed_mps) > 0.0:
            parts.append(
                DriveAlong(NEIGHBOUR, lane.beside(over_m), speed_mps, to_m=drifted_m + stays_m, at_end="go on")
            )
        parts.append(ChangeLane(NEIGHBOUR, lane, over_s=BACK_S, speed_mps=speed_mps, name="neighbour goes back"))
        parts.append(DriveAlong(NEIGHBOUR, lane, STREET_MPS, to_m=drifted_m + stays_m + LEAVES_M, at_end="vanish"))
        return InTurn(*parts)

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on."""
        return [NoCollision(), Arrives(), InTime()]
