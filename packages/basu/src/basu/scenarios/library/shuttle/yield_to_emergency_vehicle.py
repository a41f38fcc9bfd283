"""An emergency vehicle comes from behind and needs the ego to make room."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.actions import Either, InTurn, Meanwhile, PathFollower, Wait
from basu.scenarios.criteria import InTime, NoCollision, YieldsToEmergencyVehicle
from basu.scenarios.exercise import Finding
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import EGO, ActorSpec
from basu.scenarios.triggers import EgoNear, Elapsed, Faster, PassesEgo

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion, Played

ROLE = "emergency vehicle"
BLUEPRINTS = {
    "ambulance": "vehicle.ford.ambulance",
    "firetruck": "vehicle.carlamotors.firetruck",
    "police": "vehicle.dodge.charger_police_2020",
}
NEAR_M = 50.0  # the leaderboard's `_trigger_distance`: from there on the ego's time runs
BESIDE_M = 2.0  # left of the lane's middle, on which it drives: over the middle line, as there is no lane of its own
AHEAD_M = 5.0  # in front of the ego's bumper, at which it has passed
BEYOND_M = 60.0  # of its way behind the end of the ego's route


class ComesFromBehind(PathFollower):
    """Lead a vehicle so much faster than the ego; it brakes for the ego where that is in its way."""

    def __init__(self, actor: str, path: Path, faster_mps: float) -> None:
        super().__init__(
            f"{actor} comes from behind, {faster_mps:g} m/s faster than the ego", actor, path, minds=(EGO,)
        )
        self.faster_mps = faster_mps

    def wanted_mps(self) -> float:
        """The ego's speed and the difference."""
        return max(0.0, self.stage.ego.forward_mps) + self.faster_mps


class YieldToEmergencyVehicle(Scenario):
    """An emergency vehicle comes from behind; the ego must pull over to let it pass.

    The leaderboard's YieldToEmergencyVehicle on a street with one lane each way. The vehicle drives on the middle
    line and is faster than the ego. It is stuck while the ego stays in the middle of its lane. An ego that draws to the
    right edge, by 0.6 m or more for the shuttle, is passed. From 50 m on it has ``patience`` seconds. None of BASU's
    agents pulls over, so no case of it comes with BASU: it is for routes and cases of your own.
    """

    group = Group.SHUTTLE
    parameters = (
        Choice("kind", tuple(BLUEPRINTS), "the emergency vehicle"),
        Number("behind", 45.0, 20.0, 55.0, "m", "from the emergency vehicle's middle to the ego's at first"),
        Number("faster", 6.9, 3.0, 12.0, "m/s", "than the ego; 25 km/h in the leaderboard"),
        Number("patience", 10.0, 5.0, 40.0, "s", "that the ego has from 50 m on; 10 s in the leaderboard"),
    )
    partner_choice = ("kind", BLUEPRINTS)
    timeout_s = 60.0
    needs_m = 60.0

    @cached_property
    def _way(self) -> Path:
        """Along the ego's lane, left of its middle, from behind the vehicle to beyond the ego's route."""
        back_m = self.number("behind") + 2.0
        steps = math.ceil((back_m + self.place.left_m + BEYOND_M) / 2.0)
        return Path.through([self.place.at(-back_m + 2.0 * n, -BESIDE_M)[:3] for n in range(steps)])

    def actors(self) -> Sequence[ActorSpec]:
        """The emergency vehicle, behind the ego."""
        behind_m = self.number("behind")
        return [ActorSpec(ROLE, BLUEPRINTS[self.choice("kind")], self.place.at(-behind_m, -BESIDE_M))]

    def trigger(self) -> Behaviour:
        """The ego is under way, or has had time to be."""
        return Either(Faster(1.0), Elapsed(5.0), name="ego is under way")

    def conflict(self) -> Behaviour:
        """It comes, until it is past the ego or its patience ends."""
        waited = InTurn(EgoNear(ROLE, NEAR_M), Wait(self.number("patience")), name="its patience ends")
        over = Either(PassesEgo(ROLE, AHEAD_M), waited, name="it is past, or waits no longer")
        return Meanwhile(over, ComesFromBehind(ROLE, self._way, self.number("faster")), name="it wants to pass")

    def resolution(self) -> Behaviour:
        """One frame, in which it is judged."""
        return Wait(0.0)

    def exercised(self, played: Played) -> Finding:
        """Whether the vehicle came so near from behind that the ego's time ran, or was past it at once."""
        first, rows = played.first_tick("conflict"), played.history.others
        ids = [actor for actor, role in played.roles.items() if role == ROLE]
        rows = rows[np.isin(rows["id"], ids) & (rows["tick"] >= (math.inf if first is None else first))]
        if len(rows) == 0:
            return Finding(False, f"the {ROLE} never came within {NEAR_M:g} m")
        frames = played.history.frames[rows["tick"]]
        away_m = float(np.hypot(frames["x_m"] - rows["x_m"], frames["y_m"] - rows["y_m"]).min())
        return Finding(away_m <= NEAR_M, f"the {ROLE} was {away_m:.1f} m away at least, and {NEAR_M:g} m count")

    def partners(self) -> Collection[str]:
        """Return the role of the emergency vehicle."""
        return (ROLE,)

    def criteria(self) -> Sequence[Criterion]:
        """It is let past, and not touched."""
        return [NoCollision(), YieldsToEmergencyVehicle(ROLE), InTime()]
