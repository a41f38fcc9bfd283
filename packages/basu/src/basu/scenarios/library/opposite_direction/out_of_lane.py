"""The path of an oncoming vehicle that leaves its lane for a stretch and returns."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.library.road_users import BLUEPRINTS, SETS_OFF_MPS2, run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import Path, oncoming
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

OTHER = "oncoming"
NARROWLY = (0.8, 1.5)  # of its own speed: what it varies by to meet the ego, which may still speed up
SETTLED_S = 3.0  # before it goes back it has its speed and keeps it, whatever the ego does
BEFORE_S = 2.0  # it drives in its own lane for at least so long before it leaves it
BEFORE_M = 10.0  # it goes back when the ego, unbraked, is still so far away: too late for that one by a second
BEHIND_M = 25.0  # it vanishes so far behind the trigger point


class Excursion(NamedTuple):
    """A way along which ``ahead_m`` before the ego is ``from_m - ahead_m``."""

    path: Path
    from_m: float  # ahead of the trigger point, where it begins

    def s_m(self, ahead_m: float) -> float:
        """How far along it a place ahead of the trigger point is."""
        return self.from_m - ahead_m


class OutOfLane(Scenario):
    """The base: an oncoming vehicle leaves its lane from ``out_m`` to ``back_m``, where the ego would meet it.

    Each has ``kind``, ``speed`` and ``meets``. Once it goes back it brakes for an ego that stands in its way.
    """

    group = Group.OPPOSITE_DIRECTION
    timeout_s = 60.0
    needs_m = 100.0

    @property
    def back_m(self) -> float:
        """Ahead of the trigger point, where it begins to go back."""
        return self.number("meets")

    @property
    def out_m(self) -> float:
        """Likewise, where it begins to leave its lane."""
        raise NotImplementedError

    @property
    def aside_m(self) -> float:
        """How far to its left it gets."""
        raise NotImplementedError

    @property
    def change_m(self) -> tuple[float, float]:
        """How long it takes to get out and to get back, along its way."""
        raise NotImplementedError

    @property
    def notice_s(self) -> float:
        """Before they would meet, it sets off."""
        return (self.out_m - self.back_m) / self.number("speed") + BEFORE_S

    @property
    def begins_m(self) -> float:
        """Where it stands at first."""
        return self.back_m + run_up_m(self.number("speed"), self.notice_s)

    def excursion(self) -> Excursion:
        """Its way."""
        out_m, back_m = self.change_m
        from_m = self.begins_m + 5.0
        lane = oncoming(self.place, from_m, -BEHIND_M)
        path = lane.swerved(from_m - self.out_m, out_m, 0.0, -self.aside_m)
        return Excursion(path.swerved(from_m - self.back_m, back_m, 0.0, self.aside_m), from_m)

    def actors(self) -> Sequence[ActorSpec]:
        """The oncoming vehicle."""
        way = self.excursion()
        return [ActorSpec(OTHER, BLUEPRINTS[self.choice("kind")], way.path.at(way.s_m(self.begins_m)))]

    @property
    def ego_s_m(self) -> float:
        """Where the ego would be when the other begins to go back, along its route."""
        return self.place.trigger_s_m + self.back_m - BEFORE_M

    def trigger(self) -> Behaviour:
        """The ego is on its way to where they would meet."""
        return TimeToArrival(self.ego_s_m, self.notice_s, "where they would meet")

    def conflict(self) -> Behaviour:
        """It comes, out of its lane, and is back in it in the end."""
        return self.comes()

    def comes(self) -> Behaviour:
        """It drives its way, timed by the ego."""
        way, speed_mps = self.excursion(), self.number("speed")
        low, high = NARROWLY
        return InTurn(
            ReachAtEgosArrival(
                OTHER,
                way.path,
                way.s_m(self.back_m),
                self.ego_s_m,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                settled_s=SETTLED_S,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(OTHER, way.path, speed_mps, considerate=True, at_end="vanish"),
            name="comes towards the ego",
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on when the other has passed."""
        return [NoCollision(), Arrives(), InTime()]
