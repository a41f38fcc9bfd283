"""A slower vehicle cuts in at a difference of speeds and a time to collision: the grid of (EU) 2022/1426, Annex III."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.metrics.careful_driver.encounters import own_middle_m, sideways_begins, way_between
from basu.metrics.careful_driver.eu_cut_in import INTRUSION_M, KMH, intrusion, is_inside
from basu.scenarios.actions import ChangeLane, DriveAlong, InTurn, SlowerUntilTtc
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.exercise import Finding
from basu.scenarios.library.road_users import BLUEPRINTS
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.policy import NoNearMiss
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoNear

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.metrics.careful_driver.eu_cut_in import Intrusion
    from basu.scenarios.criteria import Criterion
    from basu.scenarios.criteria.criterion import Played
    from basu.scenarios.parameters import Parameter

NEIGHBOUR = "neighbour"
NOTICED_M = 58.0  # between the middles, from which the neighbour looks at the ego
STAYS_M = 15.0  # that it drives before the ego with its speed
STREET_MPS = 10.0
WITHIN_S, WITHIN_KMH = 0.15, 1.5  # of the requested values, for the conflict to have come about


class CutInAtTtc(Scenario):
    """A slower vehicle in the next lane cuts in on the ego, at a chosen difference of speeds and time to collision.

    NHTSA pre-crash scenario 18, vehicles changing lanes, same direction. The neighbour takes its speed from the ego's.
    So any ego that keeps a steady speed above the difference meets the same situation. The time to collision counts at
    the intrusion, 0.3 m within the ego's lane. The conflict has come about if the record has both figures, within
    0.15 s and 1.5 km/h. An ego that brakes after the neighbour began to move sideways does not change them.
    """

    group = Group.LANE_CHANGE
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", ("left", "right"), "from which it comes; there must be a lane on that side"),
        Number("difference", 20.0, 5.0, 60.0, "km/h", "by which it is slower than the ego"),
        Number("ttc", 1.8, 0.4, 5.0, "s", "to a collision, when it is 0.3 m within the ego's lane"),
        Number("ahead", 80.0, 60.0, 100.0, "m", "from the trigger point to where it waits"),
        Number("over", 10.0, 6.0, 30.0, "m", "along the lane, in which it changes lanes"),
        Choice("kind", ("car", "suv", "van"), "the vehicle"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 40.0, "sun_altitude_angle": 40.0}
    timeout_s = 60.0
    needs_m = 110.0

    @property
    def _beside_m(self) -> float:
        """To the right of the ego's lane, of the middle of the lane from which it comes."""
        width_m = self.place.width_m(self.number("ahead"))
        return -width_m if self.choice("side") == "left" else width_m

    def actors(self) -> Sequence[ActorSpec]:
        """The neighbour, waiting in the next lane."""
        pose = self.place.at(self.number("ahead"), self._beside_m)
        return [ActorSpec(NEIGHBOUR, BLUEPRINTS[self.choice("kind")], pose)]

    def trigger(self) -> Behaviour:
        """The ego comes into sight."""
        return EgoNear(NEIGHBOUR, NOTICED_M)

    def conflict(self) -> Behaviour:
        """It sets off before the ego, cuts in, and drives away after a while."""
        difference_mps = self.number("difference") / KMH
        lane, beside_m = Path.of_route(self.place.route), self._beside_m
        over_m = self.number("over")
        half_lane_m = self.place.width_m(self.number("ahead")) / 2.0
        cut_in = ChangeLane(NEIGHBOUR, lane, over_m=over_m, name=f"{NEIGHBOUR} cuts in")
        waits = SlowerUntilTtc(
            NEIGHBOUR,
            lane.beside(beside_m),
            difference_mps,
            self.number("ttc"),
            edge_m=abs(beside_m) - half_lane_m + INTRUSION_M,
            across_m=abs(beside_m),
            over_m=over_m,
        )
        stays = ChangeLane(NEIGHBOUR, lane, over_m=STAYS_M, name=f"{NEIGHBOUR} keeps its speed")
        leaves = DriveAlong(NEIGHBOUR, lane, STREET_MPS, to_m=lane.length_m - 2.0, at_end="vanish")
        return InTurn(waits, cut_in, stays, leaves)

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on; the near miss is reported, since the case itself asks for it."""
        return [NoCollision(), NoNearMiss(deciding=False), Arrives(), InTime()]

    def exercised(self, played: Played) -> Finding:
        """Whether the cut-in had the requested difference of speeds and time to collision."""
        seen = seen_intrusion(played)
        if seen is None:
            return Finding(False, "the neighbour never came into the ego's lane")
        wanted_kmh, wanted_s = self.number("difference"), self.number("ttc")
        holds = abs(seen.difference_kmh - wanted_kmh) <= WITHIN_KMH and abs(seen.ttc_s - wanted_s) <= WITHIN_S
        return Finding(
            holds,
            f"at the intrusion the ego was {seen.difference_kmh:.1f} km/h faster and {seen.ttc_s:.2f} s from a "
            f"collision; the case asks for {wanted_kmh:g} km/h and {wanted_s:g} s",
        )


def seen_intrusion(played: Played) -> Intrusion | None:
    """Return the first intrusion of the neighbour, with the ego's speed from when it began to move sideways."""
    history, first = played.history, played.first_tick("conflict")
    key = next((key for key, role in played.roles.items() if role == NEIGHBOUR), None)
    if first is None or key is None:
        return None
    rows = history.others[(history.others["id"] == key) & (history.others["tick"] >= first)]
    way = way_between(history, key, first, int(rows["tick"][-1])) if len(rows) else None
    if way is None:
        return None
    inside = is_inside(history, way).nonzero()[0]
    if len(inside) == 0:
        return None
    begin = sideways_begins(way, int(inside[0]), history.facts.step_s)
    tick = int(way.tick[begin])
    return intrusion(history, way, tick, own_middle_m(history, tick), float(history.speed_mps()[tick]))
