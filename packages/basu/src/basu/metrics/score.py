"""The driving score of the thesis (section 5.3): infractions, path following, and their weighted sum."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.infraction import Evidence, Infraction, counts
from basu.metrics.path_following import path_following
from basu.metrics.registry import Drive, built_in
from basu.metrics.scoring import Scoring
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu.records.history import History


class Scores(NamedTuple):
    """All in 0 (bad) .. 1 (good)."""

    driving: float
    infraction: float
    path_following: float


def infractions(history: History, scoring: Scoring | None = None) -> tuple[Evidence, ...]:
    """Return every infraction of a drive by BASU's metrics, in the order in which they happened."""
    drive = Drive(history=history, scoring=scoring or Scoring(), outcome=Outcome(Status.COMPLETED, ""))
    return in_order(event for metric in built_in() if metric.penalties for event in metric.find(drive))


def in_order(found: Iterable[Evidence]) -> tuple[Evidence, ...]:
    """Evidence in the order in which it happened, the same however it was found."""
    return tuple(sorted(found, key=lambda e: (e.tick, e.kind.value, e.other or "")))


def infraction_score(number: Mapping[Infraction, int], scoring: Scoring) -> float:
    """Equation 5.1: the product of each kind's penalty to the power of its count."""
    return math.prod(scoring.penalties[kind] ** count for kind, count in number.items())


def driving_score(infraction: float, path: float, scoring: Scoring) -> float:
    """Equation 5.5, without its factor 100: the thesis reports scores in 0..1."""
    return scoring.infraction_weight * infraction + scoring.path_following_weight * path


def score(history: History, scoring: Scoring) -> Scores:
    """The scores of a recorded run."""
    infraction = infraction_score(counts(infractions(history, scoring)), scoring)
    path = path_following(history).score
    return Scores(driving_score(infraction, path, scoring), infraction, path)
