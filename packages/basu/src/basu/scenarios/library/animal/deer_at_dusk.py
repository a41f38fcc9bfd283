"""A deer runs across the street at dusk, and a second one after it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.scenarios.actions import InTurn, Together, Wait, WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.road_users import STARTS_MPS2, across, animal, ego_is_due, facing_deg, walking_s
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.actions.walking import Then
    from basu.scenarios.criteria import Criterion
    from basu.scenarios.stage import ActorSpec

AWAY_M = 8.0  # from the middle of the lane, where they stand and where they vanish to
SLOW_MPS = 3.0  # to which the second one has come down when it is in the lane's middle
APART_M = 2.5  # the second one runs so far behind the first, seen along the street
NEAR_M = 0.5  # nearer than this is luck: a deer turns on the spot


class DeerAtDusk(Scenario):
    """Two deer run across the street at dusk; the second freezes in the ego's lane.

    The first crosses in time and is the warning. The second follows a second later, is dazzled, stands in the middle of
    the lane ``sight`` seconds before the ego would be there, and runs on after a moment. NHTSA 2007, scenario 10:
    animal, no prior vehicle maneuver. The hard one of its group. The deer are of 66 kg and 1.7 m long (the
    sources stand in Linden's blueprints); on the original CARLA, which has no animals, walkers of a child's size run in
    their place. It is the end of civil twilight: BASU's own agents see them in their low beams only, 30 m ahead.
    """

    group = Group.ANIMAL
    parameters = (
        Number("ahead", 60.0, 40.0, 90.0, "m", "from the trigger point to where they cross"),
        Number("speed", 8.0, 4.0, 12.0, "m/s", "of their run"),
        Number("gap", 1.2, 0.6, 3.0, "s", "between the two"),
        Number("sight", 1.8, 1.0, 3.5, "s", "from the second one's freezing to the ego's being there"),
        Number("freezes", 3.0, 0.5, 5.0, "s", "that it stands in the lane"),
        Choice("side", ("left", "right"), "from which they come"),
    )
    weather = {  # noqa: RUF012 - declared as a constant mapping
        "sun_altitude_angle": -6.0,  # the end of civil twilight
        "sun_azimuth_angle": 250.0,
        "cloudiness": 40.0,
        "fog_density": 10.0,
        "fog_distance": 30.0,
    }
    needs_m = 100.0

    @property
    def _from_m(self) -> float:
        return AWAY_M if self.choice("side") == "right" else -AWAY_M

    @property
    def _slows_m(self) -> float:
        """Before the middle of the lane, from where on the second one slows down, as fast as walkers do."""
        slides_m = (self.number("speed") ** 2 - SLOW_MPS**2) / (2.0 * STARTS_MPS2)
        return min(slides_m, AWAY_M / 2.0) + NEAR_M

    def actors(self) -> Sequence[ActorSpec]:
        """Both beside the street."""
        ahead_m = self.number("ahead")
        return [
            animal("deer_1", "deer", self.place.at(ahead_m, self._from_m, facing_deg(self._from_m))),
            animal("deer_2", "deer", self.place.at(ahead_m + APART_M, self._from_m, facing_deg(self._from_m))),
        ]

    def trigger(self) -> Behaviour:
        """The second will stand in the lane so long before the ego is there."""
        slows_m, speed_mps = self._slows_m, self.number("speed")
        run_s = walking_s(AWAY_M - slows_m, speed_mps) + 2.0 * slows_m / (SLOW_MPS + speed_mps)
        due_s = self.number("gap") + run_s + self.number("sight")
        return ego_is_due(self.place, self.number("ahead") + APART_M, due_s, "where they cross")

    def conflict(self) -> Behaviour:
        """One runs across; the other follows, freezes, and runs on."""
        ahead_m, speed_mps, side = self.number("ahead"), self.number("speed"), math.copysign(1.0, self._from_m)

        def second(from_m: float, to_m: float, mps: float, at_end: Then = "stand") -> WalkAlong:
            return WalkAlong(
                "deer_2", across(self.place, ahead_m + APART_M, side * from_m, side * to_m), mps, at_end=at_end
            )

        follows = InTurn(
            Wait(self.number("gap")),
            second(AWAY_M, self._slows_m, speed_mps, at_end="go on"),
            second(self._slows_m, 0.3, SLOW_MPS),
            Wait(self.number("freezes")),
            second(0.0, -AWAY_M, speed_mps),
            name="the second",
        )
        first = WalkAlong("deer_1", across(self.place, ahead_m, self._from_m, -self._from_m), speed_mps)
        return Together(first, follows)

    def criteria(self) -> Sequence[Criterion]:
        """Neither is touched or nearly so, and the ego goes on."""
        near = [LeastDistance(NEAR_M, to=name, while_moving=True) for name in ("deer_1", "deer_2")]
        return [NoCollision(), *near, Arrives(), InTime()]
