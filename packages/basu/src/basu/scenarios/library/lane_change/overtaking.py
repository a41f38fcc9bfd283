"""A vehicle overtakes the ego on a street with one lane each way, and is in front of it soon after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import FollowEgo, Meanwhile, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.library.road_users import BLUEPRINTS, EGO_HALF_LENGTH_M, HALF_LENGTH_M
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import Path, lanes_apart_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

OVERTAKER = "overtaker"
FOLLOWS_M = 6.0  # bumper to bumper, before it overtakes
HURRY_MPS = 18.0  # the most it drives to get past a fast ego
SETTLED_S = 0.7


class OvertakesEgo(Scenario):
    """The base: a vehicle follows the ego, overtakes within ``passing`` seconds, and cuts in ``gap`` before its nose.

    Each has ``kind``, ``passing`` and ``gap``.
    """

    group = Group.LANE_CHANGE
    timeout_s = 60.0
    needs_m = 60.0

    @property
    def cuts_in_m(self) -> float:
        """Ahead of the trigger point, where the overtaker's middle is when it begins to cut in."""
        raise NotImplementedError

    @property
    def half_m(self) -> float:
        """Half the overtaker's length."""
        return HALF_LENGTH_M[self.choice("kind")]

    @property
    def ego_s_m(self) -> float:
        """Where the ego is then, along its route."""
        return self.place.trigger_s_m + self.cuts_in_m - self.half_m - self.number("gap") - EGO_HALF_LENGTH_M

    @property
    def lane(self) -> Path:
        """The ego's lane, from its beginning."""
        return Path.of_route(self.place.route)

    def actors(self) -> Sequence[ActorSpec]:
        """The overtaker, behind the ego."""
        behind_m = -self.place.trigger_s_m - EGO_HALF_LENGTH_M - FOLLOWS_M - self.half_m
        return [ActorSpec(OVERTAKER, BLUEPRINTS[self.choice("kind")], self.place.at(behind_m))]

    def trigger(self) -> Behaviour:
        """It follows until it is time to overtake."""
        due = TimeToArrival(self.ego_s_m, self.number("passing"), "where it is cut in on")
        return Meanwhile(due, FollowEgo(OVERTAKER, self.lane, FOLLOWS_M), name="it follows the ego")

    def overtakes(self) -> Behaviour:
        """It gets out and past, up to where it cuts in."""
        apart_m = lanes_apart_m(self.place, self.cuts_in_m)
        return ReachAtEgosArrival(
            OVERTAKER,
            self.lane.beside(-apart_m),
            self.place.trigger_s_m + self.cuts_in_m,
            self.ego_s_m,
            low_mps=3.0,
            high_mps=HURRY_MPS,
            settled_s=SETTLED_S,
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on."""
        return [NoCollision(), Arrives(), InTime()]
