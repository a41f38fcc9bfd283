"""Infractions and scores while a drive lasts, computed from new frames only.

Signs and lights are judged from the last frame in which none had its line at the vehicle: what was found before that
frame is settled. Contacts and speeding may last as long as a drive, so of those the latest message of each party and
the largest excess are kept. When the drive is over, the whole record is judged once more, and that is the result.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.infraction import Evidence, counts
from basu.metrics.path_following import compared
from basu.metrics.registry import built_in
from basu.metrics.score import Scores, driving_score, in_order, infraction_score
from basu.metrics.scoring import Scoring
from basu.metrics.stretches import SPACING_M, chords, path_m, total_m
from basu.metrics.validity import Follower, moments

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.routing import ControlKind


@dataclass(slots=True)
class ControlsWatcher:
    """A metric of the route's signs or lights: from where it still looks, and what it found before."""

    metric: Callable[[History], tuple[Evidence, ...]]
    quiet: Callable[[History], NDArray[np.bool_]]  # (T,) frames before which all is settled
    first: int = 0
    passed_m: float = 0.0  # along the route: controls before this are settled
    settled: list[Evidence] = field(default_factory=list)
    pending: list[Evidence] = field(default_factory=list)

    def look(self, window: Callable[[int], History]) -> None:
        """Judge what is not settled, and settle what can be."""
        history = _with_controls_beyond(window(self.first), self.passed_m)
        found = [replace(event, tick=event.tick + self.first) for event in self.metric(history)]
        quiet = np.flatnonzero(self.quiet(history))
        if len(quiet):
            last = int(quiet[-1])
            self.settled += [event for event in found if event.tick < self.first + last]
            vehicle = history.facts.vehicle
            middle_m = history.frames["route_s_m"][: last + 1] + (vehicle.front_m - vehicle.rear_m) / 2.0
            self.passed_m = max(self.passed_m, float(middle_m.max()))
            self.first += last
        self.pending = [event for event in found if event.tick >= self.first]


class SoFar:
    """What there is of a drive. ``advance`` before reading."""

    def __init__(self, scoring: Scoring) -> None:
        self._scoring = scoring
        watched = [metric.watch(scoring) for metric in built_in() if metric.penalties]
        self._watched = [each for each in watched if each is not None]
        self._path_first, self._path_m = 0, 0.0
        self._follower: Follower | None = None
        self._followed = 0  # frames that the follower has seen
        self._path_score = 0.0

    def advance(self, window: Callable[[int], History]) -> None:
        """Take in what is new; ``window`` gives the record from a tick on, its ticks counted from there."""
        for watched in self._watched:
            watched.look(window)
        self._follow(window(self._path_first), window(self._followed))

    @property
    def infractions(self) -> tuple[Evidence, ...]:
        """Every infraction until now, in the order in which they happened."""
        return in_order(event for watched in self._watched for event in (*watched.settled, *watched.pending))

    @property
    def scores(self) -> Scores:
        """The scores until now: the way that lies ahead is not driven yet."""
        infraction = infraction_score(counts(self.infractions), self._scoring)
        return Scores(driving_score(infraction, self._path_score, self._scoring), infraction, self._path_score)

    def _follow(self, history: History, fresh: History) -> None:
        """Add the new piece of the driven path, and the ``fresh`` frames to the valid progress."""
        self._follower = self._follower or Follower(history.facts.route)
        for moment in moments(fresh.frames):
            self._follower.step(moment)
        self._followed += len(fresh.frames)
        pieces = chords(path_m(history.frames))
        whole = pieces.length_m >= SPACING_M
        driven_m = self._path_m + total_m(pieces.length_m)
        self._path_score = compared(driven_m, self._follower.driven_m, history.facts.route.length_m).score
        if whole.any():
            self._path_m += total_m(pieces.length_m[whole])
            self._path_first += int(pieces.end[whole][-1])


def _with_controls_beyond(history: History, passed_m: float) -> History:
    """The record with those of the route's controls that are not settled."""
    route = history.facts.route
    beyond = tuple(control for control in route.controls if control.s_m >= passed_m)
    return replace(history, facts=replace(history.facts, route=replace(route, controls=beyond)))


def away_from(history: History, kind: ControlKind, before_m: float, behind_m: float) -> NDArray[np.bool_]:
    """(T,) no line of ``kind`` between ``before_m`` ahead of the front and ``behind_m`` behind the rear."""
    vehicle, s_m = history.facts.vehicle, history.frames["route_s_m"]
    away = np.ones(len(s_m), dtype=np.bool_)
    for control in history.facts.route.controls:
        if control.kind is kind:
            near = (control.s_m <= s_m + vehicle.front_m + before_m) & (control.s_m >= s_m - vehicle.rear_m - behind_m)
            away &= ~near
    return away
