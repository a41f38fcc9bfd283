"""The driving score: infraction penalty times weight plus path following times weight (section 5.3 of the thesis)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError
from basu.metrics.collisions import collisions
from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, counts
from basu.metrics.path_following import path_following
from basu.metrics.speeding import speeding
from basu.metrics.stop_signs import stop_signs

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.history import History


@dataclass(frozen=True, slots=True, kw_only=True)
class Scoring:
    """What each infraction costs and how much each part of the score weighs: adjustable, with the thesis's values."""

    penalties: Mapping[Infraction, float] = field(default_factory=lambda: dict(DEFAULT_PENALTIES))
    infraction_weight: float = 0.8
    path_following_weight: float = 0.2

    def __post_init__(self) -> None:
        total = self.infraction_weight + self.path_following_weight
        if not math.isclose(total, 1.0, abs_tol=1e-9) or min(self.infraction_weight, self.path_following_weight) < 0.0:
            raise UserError(
                f"the weights {self.infraction_weight} (infractions) and {self.path_following_weight} (path following) "
                f"sum to {total}; they must be non-negative and sum to 1"
            )
        for kind, penalty in self.penalties.items():
            if not 0.0 <= penalty <= 1.0:
                raise UserError(f"the penalty of {kind.value} is {penalty}; it is a factor and must lie in 0..1")


class Scores(NamedTuple):
    """All in 0 (bad) .. 1 (good)."""

    driving: float
    infraction: float
    path_following: float


def infractions(history: History) -> tuple[Evidence, ...]:
    """Every infraction of a run, in the order in which they happened."""
    found = (*collisions(history), *stop_signs(history), *speeding(history))
    return tuple(sorted(found, key=lambda e: (e.tick, e.kind.value, e.other or "")))


def infraction_score(number: Mapping[Infraction, int], scoring: Scoring) -> float:
    """Equation 5.1: the product of each kind's penalty to the power of its count."""
    return math.prod(scoring.penalties[kind] ** count for kind, count in number.items())


def driving_score(infraction: float, path: float, scoring: Scoring) -> float:
    """Equation 5.5, without its factor 100: the thesis reports scores in 0..1."""
    return scoring.infraction_weight * infraction + scoring.path_following_weight * path


def score(history: History, scoring: Scoring) -> Scores:
    """The scores of a recorded run."""
    infraction = infraction_score(counts(infractions(history)), scoring)
    path = path_following(history).score
    return Scores(driving_score(infraction, path, scoring), infraction, path)
