"""Cars one behind the other that have the right of way over the ego: it has to wait for a gap, or for the last.

Before a stop sign they are timed by the ego's rest at the line: they come while it waits, however slowly it came.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival, Together
from basu.scenarios.criteria import Arrives, HeedsStopSigns, InTime, NoCollision
from basu.scenarios.criteria.margin import present_in
from basu.scenarios.exercise import Finding
from basu.scenarios.library.crossing_paths.from_the_side import NARROWLY, SETTLED_S, due
from basu.scenarios.library.road_users import BLUEPRINTS, EGO_HALF_LENGTH_M, SETS_OFF_MPS2, run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToRest
from basu.scenarios.triggers.along_route import AT_LINE_M
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.criteria.criterion import Played
    from basu.scenarios.paths import Crossing, JunctionAhead, Path
    from basu.scenarios.paths.lanes import Turn
    from basu.scenarios.place import Place
    from basu.scenarios.stage import Pose

KINDS = ("car", "suv", "van")  # of the first, the second, … and again
NOTICE_S = 6.0  # before the ego would arrive without stopping, when all set off
BEFORE_REST_S = 3.0  # before the ego's rest at its line, likewise
LOOKS_S, PULLS_MPS2, TURNS_MPS = 1.7, 0.85, 2.8  # a shuttle that drives off again: `basic`, measured
FIRST_S = 1.0  # after it, the first passes at the earliest
SHORT_M = 0.5  # before the line, where a driver's bumper comes to rest
LEAVES_M = 45.0
MEETS_M, MOVES_MPS = 3.0, 0.5  # one that moves and is this near to its meeting place goes through it


def rest_s_m(place: Place, junction: JunctionAhead) -> float | None:
    """Where along its route the ego rests at the stop sign of a junction; None where it has none there."""
    line_m = place.stop_line_m(before_m=junction.to_m)
    return None if line_m is None else place.trigger_s_m + line_m - EGO_HALF_LENGTH_M - SHORT_M


def departs_s(way_m: float, turn: Turn) -> float:
    """How long after its rest at a line a shuttle that drives off without a look needs for so many metres."""
    top_mps = math.inf if turn == "straight" else TURNS_MPS
    rising_m = min(way_m, 0.5 * top_mps * top_mps / PULLS_MPS2)
    return LOOKS_S + math.sqrt(2.0 * rising_m / PULLS_MPS2) + (way_m - rising_m) / top_mps


def passed_a_resting_ego(played: Played, rest_s_m: float, meetings: Mapping[str, Pose]) -> Finding | None:
    """The conflict at a stop sign: one of the others went through its meeting place while the ego rested at its line.

    ``meetings`` has the places by the roles of the others; None means that no other did.
    """
    history, present = played.history, present_in(played)
    frames, others = history.frames, present.history.others
    rests = (history.speed_mps() < AT_REST_MPS) & (np.abs(frames["route_s_m"] - rest_s_m) <= AT_LINE_M)
    for name, at in meetings.items():
        rows = others[present.rows_of(name)]
        near_m = np.hypot(rows["x_m"] - at.x_m, rows["y_m"] - at.y_m)
        mps = np.hypot(rows["velocity_x_mps"], rows["velocity_y_mps"])
        passed = rows["tick"][(near_m < MEETS_M) & (mps > MOVES_MPS) & rests[rows["tick"]]]
        if len(passed):
            at_s = float(frames["t_s"][passed[0]])
            return Finding(True, f"{name} went through the crossing at {at_s:.2f} s, while the ego rested at its line")
    return None


class Way(NamedTuple):
    """A path, and where it meets the ego's: along it, and along the ego's route."""

    path: Path
    meet_s_m: float
    ego_s_m: float


class Lane(NamedTuple):
    """One row of cars."""

    way: Way | Crossing
    first_s: float  # after the ego would arrive, the first of them does; before a stop sign: after ``Stream.first_s``
    name: str = "oncoming"  # of each, before its number


class Stream(Scenario):
    """The base: rows of cars through the ego's next junction. Each has ``cars``, ``speed`` and ``headway``.

    Where the ego's street has a stop sign (``rest_s_m``), the middle of a row passes when an ego that drives off at
    once is in its way. Without one, the first of a row is there when the ego is.
    """

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

    @cached_property
    def rest_s_m(self) -> float | None:
        """Where along its route the ego rests at the junction's stop sign; None where it has none there."""
        return rest_s_m(self.place, next_junction(self.place))

    @property
    def first_s(self) -> float:
        """After the ego's rest, the first of a row passes: the ego's departure falls into the middle of the row."""
        assert self.rest_s_m is not None
        junction = next_junction(self.place)
        middle_m = self.place.trigger_s_m + 0.5 * (junction.from_m + junction.to_m)
        in_the_way_s = departs_s(middle_m - self.rest_s_m, junction.turn)
        return max(FIRST_S, in_the_way_s - 0.5 * (len(self._row) - 1) * self.number("headway"))

    @property
    def notice_s(self) -> float:
        """From setting off to the first's passage, but for its lane's own delay."""
        return NOTICE_S if self.rest_s_m is None else BEFORE_REST_S + self.first_s

    @property
    def back_m(self) -> float:
        """How far before the meeting place the last of a row stands at first, with some to spare."""
        row_m = (len(self._row) - 1) * self.number("headway") * self.number("speed")
        return run_up_m(self.number("speed"), self.notice_s) + row_m + 10.0

    def actors(self) -> Sequence[ActorSpec]:
        """All of them, in their rows."""
        return [
            ActorSpec(name, BLUEPRINTS[KINDS[index % len(KINDS)]], self._begins(lane, index))
            for row, lane in enumerate(self.lanes)
            for index, name in enumerate(self._names(row))
        ]

    def trigger(self) -> Behaviour:
        """The ego is on its way to its line, or to where they meet."""
        if self.rest_s_m is None:
            return due(self.lanes[0].way.ego_s_m, NOTICE_S)
        return TimeToRest(self.rest_s_m, BEFORE_REST_S, "its line")

    def conflict(self) -> Behaviour:
        """They drive through, the first of each row timed for an ego that does not wait."""
        return Together(
            *(
                self._drives(lane, self._names(row), index)
                for row, lane in enumerate(self.lanes)
                for index in self._row
            ),
            name="they drive through",
        )

    def exercised(self, played: Played) -> Finding:
        """The vehicles met, and at a stop sign the vehicles that passed the resting ego."""
        if self.rest_s_m is not None:
            meetings = {
                name: lane.way.path.at(lane.way.meet_s_m)
                for row, lane in enumerate(self.lanes)
                for name in self._names(row)
            }
            found = passed_a_resting_ego(played, self.rest_s_m, meetings)
            if found is not None:
                return found
        return super().exercised(played)

    def criteria(self) -> Sequence[Criterion]:
        """No contact, a stop sign is obeyed, and the ego goes on after the stream."""
        return [NoCollision(), HeedsStopSigns(), Arrives(), InTime()]

    @property
    def _row(self) -> range:
        return range(round(self.number("cars")))

    def _names(self, row: int) -> list[str]:
        return [f"{self.lanes[row].name} {index + 1}" for index in self._row]

    def _begins(self, lane: Lane, index: int) -> Pose:
        """Where one of them stands at first."""
        behind_m = index * self.number("headway") * self.number("speed")
        before_m = run_up_m(self.number("speed"), self.notice_s + lane.first_s) + behind_m
        return lane.way.path.at(lane.way.meet_s_m - before_m)

    def _drives(self, lane: Lane, names: Sequence[str], index: int) -> Behaviour:
        """One of them: the first times itself by the ego, and before a stop sign all do; the others drive behind it."""
        if index == 0 or self.rest_s_m is not None:
            return self._timed(names[index], lane, self.number("speed"), after_s=index * self.number("headway"))
        return DriveAlong(
            names[index],
            lane.way.path,
            self.number("speed"),
            minds=(names[index - 1],),
            accelerate_mps2=SETS_OFF_MPS2,
            at_end="vanish",
        )

    def _timed(self, actor: str, lane: Lane, speed_mps: float, *, after_s: float = 0.0, name: str = "") -> Behaviour:
        """One that is at the meeting place ``after_s`` later than the first of its row should be."""
        low, high = NARROWLY
        ego_s_m, first_s = lane.way.ego_s_m, lane.first_s
        if self.rest_s_m is not None:
            ego_s_m, first_s = self.rest_s_m, lane.first_s + self.first_s
        return InTurn(
            ReachAtEgosArrival(
                actor,
                lane.way.path,
                lane.way.meet_s_m,
                ego_s_m,
                first_s + after_s,
                ego_stops=self.rest_s_m is not None,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                settled_s=SETTLED_S,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(actor, lane.way.path, speed_mps, at_end="vanish"),
            name=name or f"{actor} drives through",
        )
