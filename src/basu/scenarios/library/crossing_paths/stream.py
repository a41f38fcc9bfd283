"""Cars one behind the other that have the right of way over the ego: it has to wait for a gap, or for the last."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival, Together
from basu.scenarios.criteria import Arrives, HeedsStopSigns, InTime, NoCollision
from basu.scenarios.library.crossing_paths.from_the_side import NARROWLY, SETTLED_S, due
from basu.scenarios.library.motorists import BLUEPRINTS, SETS_OFF_MPS2, run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.paths import Crossing, Path
    from basu.scenarios.stage import Pose

KINDS = ("car", "suv", "van")  # of the first, the second, … and again
NOTICE_S = 6.0  # before the ego would arrive without stopping, when all set off
LEAVES_M = 45.0


class Way(NamedTuple):
    """A path, and where it meets the ego's: along it, and along the ego's route."""

    path: Path
    meet_s_m: float
    ego_s_m: float


class Lane(NamedTuple):
    """One row of cars."""

    way: Way | Crossing
    first_s: float  # after the ego would arrive, the first of them does
    name: str = "oncoming"  # of each, before its number


class Stream(Scenario):
    """The base: rows of cars through the ego's next junction. Each has ``cars``, ``speed`` and ``headway``."""

    group = Group.CROSSING_PATHS
    timeout_s = 90.0
    needs_m = 40.0
    needs_junction = True

    def ways(self) -> Sequence[Lane]:
        """Where they come from."""
        raise NotImplementedError

    @cached_property
    def lanes(self) -> Sequence[Lane]:
        """``ways``, found once."""
        return self.ways()

    @property
    def back_m(self) -> float:
        """How far before the meeting place the last of a row stands at first, with some to spare."""
        row_m = (round(self.number("cars")) - 1) * self.number("headway") * self.number("speed")
        return run_up_m(self.number("speed"), NOTICE_S) + row_m + 10.0

    def actors(self) -> Sequence[ActorSpec]:
        """All of them, in their rows."""
        return [
            ActorSpec(name, BLUEPRINTS[KINDS[index % len(KINDS)]], self._begins(lane, index))
            for row, lane in enumerate(self.lanes)
            for index, name in enumerate(self._names(row))
        ]

    def trigger(self) -> Behaviour:
        """The ego is on its way to where they meet."""
        return due(self.lanes[0].way.ego_s_m, NOTICE_S)

    def conflict(self) -> Behaviour:
        """They drive through, the first of each row so as to meet who does not wait."""
        return Together(
            *(
                self._drives(lane, self._names(row), index)
                for row, lane in enumerate(self.lanes)
                for index in self._row
            ),
            name="they drive through",
        )

    def criteria(self) -> Sequence[Criterion]:
        """Nobody is touched, the sign is heeded where there is one, and the ego gets on when they are through."""
        return [NoCollision(), HeedsStopSigns(), Arrives(), InTime()]

    @property
    def _row(self) -> range:
        return range(round(self.number("cars")))

    def _names(self, row: int) -> list[str]:
        return [f"{self.lanes[row].name} {index + 1}" for index in self._row]

    def _begins(self, lane: Lane, index: int) -> Pose:
        """Where one of them stands at first."""
        behind_m = index * self.number("headway") * self.number("speed")
        before_m = run_up_m(self.number("speed"), NOTICE_S + lane.first_s) + behind_m
        return lane.way.path.at(lane.way.meet_s_m - before_m)

    def _drives(self, lane: Lane, names: Sequence[str], index: int) -> Behaviour:
        """One of them: the first times itself by the ego, the others drive behind it."""
        if index == 0:
            return self._timed(names[0], lane, self.number("speed"))
        return DriveAlong(
            names[index],
            lane.way.path,
            self.number("speed"),
            minds=(names[index - 1],),
            accelerate_mps2=SETS_OFF_MPS2,
            at_end="vanish",
        )

    def _timed(self, who: str, lane: Lane, speed_mps: float, name: str = "") -> Behaviour:
        """One who is at the meeting place when the ego is, if it does not wait."""
        low, high = NARROWLY
        return InTurn(
            ReachAtEgosArrival(
                who,
                lane.way.path,
                lane.way.meet_s_m,
                lane.way.ego_s_m,
                lane.first_s,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                settled_s=SETTLED_S,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(who, lane.way.path, speed_mps, at_end="vanish"),
            name=name or f"{who} drives through",
        )
