"""The base of criteria: their input, and the judgement that they return."""

from __future__ import annotations

import enum
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.outcome import Outcome
    from basu.records.history import History
    from basu.scenarios.stage import Pose


class Aspect(enum.Enum):
    """What a criterion says something about."""

    SAFE = "safe"  # harm and rules: unsafe counts even where the conflict never came about
    COMPLETED = "completed"  # goals of the drive


class StandingThing(NamedTuple):
    """Something that stood in the scenario and is not among the record's others: its box from above."""

    name: str
    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: float
    half_width_m: float
    from_s: float = 0.0  # when it came to stand there, on the record's clock
    until_s: float | None = None  # when it was put elsewhere or taken away; None: it stayed
    rolled_over: bool = False  # so low that wheels roll over it: no distance to it is judged


class Move(NamedTuple):
    """A thing that was put elsewhere; no pose where it was taken away."""

    name: str
    t_s: float
    pose: Pose | None


def moved(things: Sequence[StandingThing], moves: Sequence[Move]) -> tuple[StandingThing, ...]:
    """Where things stood, and from when until when: one entry for each place, moves in the order of their times."""
    latest = {thing.name: thing for thing in things}
    past = []
    for move in moves:
        thing = latest.pop(move.name, None)
        if thing is None:
            continue
        if move.t_s > thing.from_s:
            past.append(thing._replace(until_s=move.t_s))
        if move.pose is not None:
            x_m, y_m, _, yaw_rad = move.pose
            latest[move.name] = thing._replace(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad, from_s=move.t_s)
    return (*past, *latest.values())


class Played(NamedTuple):
    """A case that was driven: all that criteria may see."""

    history: History
    outcome: Outcome  # of the run
    roles: Mapping[int, str]  # of actor ids in the record, for those the scenario brought
    things: tuple[StandingThing, ...]
    phases_s: Mapping[str, float]  # when each phase began, on the record's clock: trigger, conflict, resolution, end
    timeout_s: float

    def first_tick(self, phase: str | None) -> int | None:
        """The first frame of a phase, the first of all for None; None where the phase never began."""
        if phase is None:
            return 0
        if phase not in self.phases_s:
            return None
        begun = self.history.frames["t_s"] >= self.phases_s[phase] - self.history.facts.step_s / 2.0
        return int(np.argmax(begun)) if begun.any() else None


class Judgement(NamedTuple):
    """What a criterion says, with its evidence."""

    criterion: str  # its name, such as "least distance"
    passed: bool | None  # None: there was nothing to judge by, or no limit to hold it against
    deciding: bool  # whether the verdict depends on it
    measured: float | None  # in `unit`; None where there is no figure
    unit: str
    limit: str  # what it was held against, such as "at least 0.5 m"; "" for a reported figure
    sentence: str  # time, place, other party, speed
    t_s: float | None = None  # of the moment that decided
    x_m: float | None = None  # of the ego then
    y_m: float | None = None
    speed_mps: float | None = None
    other: str | None = None  # the other party: its role, or blueprint id


class Criterion(ABC):
    """One thing to be judged. ``deciding=False`` makes it report without weighing.

    ``aspect`` says whether it is about safety or about a goal of the drive (`basu.scenarios.policy`).

    One of your own::

        class NeverBacks(Criterion):
            name = "never backs"

            def judge(self, played):
                backing = np.flatnonzero(played.history.frames["reverse"])
                if len(backing) == 0:
                    return self.says(played, True, "it never backed")
                return self.says(played, False, "it put the gear in reverse", tick=int(backing[0]))
    """

    name: str
    aspect: ClassVar[Aspect] = Aspect.SAFE

    def __init__(self, *, deciding: bool = True) -> None:
        self.deciding = deciding

    @abstractmethod
    def judge(self, played: Played) -> Judgement:
        """Return the judgement of a played case by this criterion, from the record alone."""

    def says(
        self,
        played: Played,
        passed: bool | None,  # noqa: FBT001 - it reads as what it is: the answer
        sentence: str,
        *,
        tick: int | None = None,
        measured: float | None = None,
        unit: str = "",
        limit: str = "",
        other: str | None = None,
    ) -> Judgement:
        """A judgement by this criterion; ``tick`` is the frame that decided, and gives time, place and speed."""
        moment = None if tick is None else played.history.frames[tick]
        return Judgement(
            criterion=self.name,
            passed=passed,
            deciding=self.deciding,
            measured=measured,
            unit=unit,
            limit=limit,
            sentence=sentence,
            t_s=None if moment is None else float(moment["t_s"]),
            x_m=None if moment is None else float(moment["x_m"]),
            y_m=None if moment is None else float(moment["y_m"]),
            speed_mps=None if tick is None else float(played.history.speed_mps()[tick]),
            other=other,
        )
