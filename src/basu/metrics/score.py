"""The driving score: infraction penalty times weight plus path following times weight (section 5.3 of the thesis)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError
from basu.metrics.collisions import collisions
from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, counts
from basu.metrics.passengers.comfort_score import ComfortWeights
from basu.metrics.passengers.felt import STANDING, Place
from basu.metrics.passengers.harsh_stops import HARSH_MPS2
from basu.metrics.path_following import path_following
from basu.metrics.red_lights import red_lights
from basu.metrics.route_deviation import THRESHOLD_M
from basu.metrics.speeding import TOLERANCE_MPS, speeding
from basu.metrics.stop_signs import stop_signs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from basu.records.history import History


@dataclass(frozen=True, slots=True, kw_only=True)
class Scoring:
    """What each infraction costs, how much each part weighs, and what is tolerated: adjustable, the thesis's values."""

    penalties: Mapping[Infraction, float] = field(default_factory=lambda: dict(DEFAULT_PENALTIES))
    infraction_weight: float = 0.8
    path_following_weight: float = 0.2
    speeding_tolerance_mps: float = TOLERANCE_MPS  # above the posted limit
    route_deviation_m: float = THRESHOLD_M  # from the planned line; farther out is outside the plan
    comfort_weights: ComfortWeights = field(default_factory=ComfortWeights)  # of the passengers' own score, not of this
    standing_place: Place = STANDING  # where in the vehicle the passengers stand who judge the ride
    harsh_stop_mps2: float = HARSH_MPS2  # felt by them, from which on a braking is a harsh stop

    def __post_init__(self) -> None:
        total = self.infraction_weight + self.path_following_weight
        if not math.isclose(total, 1.0, abs_tol=1e-9) or min(self.infraction_weight, self.path_following_weight) < 0.0:
            raise UserError(
                f"the weights {self.infraction_weight} (infractions) and {self.path_following_weight} (path following) "
                f"sum to {total:g}; they must be non-negative and sum to 1"
            )
        for kind, penalty in self.penalties.items():
            if not 0.0 <= penalty <= 1.0:
                raise UserError(f"the penalty of {kind.value} is {penalty}; it is a factor and must lie in 0..1")
        for name, value in (
            ("speeding_tolerance_mps", self.speeding_tolerance_mps),
            ("route_deviation_m", self.route_deviation_m),
            ("harsh_stop_mps2", self.harsh_stop_mps2),
        ):
            if not 0.0 <= value < math.inf:
                raise UserError(f"{name} is {value}; it must be a number that is not negative")


class Scores(NamedTuple):
    """All in 0 (bad) .. 1 (good)."""

    driving: float
    infraction: float
    path_following: float


def infractions(history: History, scoring: Scoring | None = None) -> tuple[Evidence, ...]:
    """Every infraction of a run, in the order in which they happened."""
    tolerance_mps = TOLERANCE_MPS if scoring is None else scoring.speeding_tolerance_mps
    return in_order(
        (*collisions(history), *red_lights(history), *stop_signs(history), *speeding(history, tolerance_mps))
    )


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
