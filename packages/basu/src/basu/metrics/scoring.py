"""A scoring: penalties, weights and thresholds of a judgement as options, and read from files.

A file may leave out what it does not change. Its keys are the names of a scoring's options. One weight alone gives the
other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

from basu.errors import UserError
from basu.files import read_json
from basu.metrics.infraction import DEFAULT_PENALTIES, Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights
from basu.metrics.passengers.felt import STANDING, PassengerPlace
from basu.metrics.passengers.harsh_stops import HARSH_MPS2
from basu.settings.option import Layer, Option, Settings, to_json

if TYPE_CHECKING:
    from pathlib import Path

TOLERANCE_MPS = 1.0  # above the limit; 2.2 mph, about what a speedometer may be off at 25 mph
THRESHOLD_M = 2.0
SCORING = "scoring"  # the group of these options on help pages


@dataclass(frozen=True, slots=True, kw_only=True)
class Scoring(Settings):
    """The adjustable part of a judgement; the defaults are the thesis's values."""

    penalties: Annotated[
        Mapping[Infraction, float],
        Option(
            help="the factor of each infraction of a kind; may be given several times",
            group=SCORING,
            flag="--penalty",
            metavar="KIND=FACTOR",
            least=0.0,
            most=1.0,
        ),
    ] = field(default_factory=lambda: dict(DEFAULT_PENALTIES))
    infraction_weight: Annotated[
        float,
        Option(
            help="weight of the infraction score; path following has the rest",
            group=SCORING,
            metavar="W",
            least=0.0,
            most=1.0,
        ),
    ] = 0.8
    speeding_tolerance_mps: Annotated[
        float,
        Option(
            help="excess over the posted limit at which speeding begins",
            group=SCORING,
            flag="--speeding-tolerance",
            metavar="M/S",
            unit="m/s",
            least=0.0,
        ),
    ] = TOLERANCE_MPS
    route_deviation_m: Annotated[
        float,
        Option(
            help="distance from the planned line at which the vehicle is outside the plan",
            group=SCORING,
            flag="--route-deviation",
            metavar="M",
            unit="m",
            least=0.0,
        ),
    ] = THRESHOLD_M
    comfort_weights: Annotated[
        ComfortWeights,
        Option(
            help="weight of a part of the passengers' comfort score; may be given several times",
            group=SCORING,
            flag="--comfort-weight",
            metavar="NAME=W",
            least=0.0,
        ),
    ] = field(default_factory=ComfortWeights)
    standing_place: Annotated[
        PassengerPlace,
        Option(
            help="where passengers stand: forward, right and up from the vehicle's origin",
            group=SCORING,
            metavar="F,R,U",
            unit="m",
        ),
    ] = STANDING
    harsh_stop_mps2: Annotated[
        float,
        Option(
            help="braking as strong as this, felt by standing passengers, is a harsh stop",
            group=SCORING,
            flag="--harsh-stop",
            metavar="M/S2",
            unit="m/s²",
            least=0.0,
        ),
    ] = HARSH_MPS2

    @property
    def path_following_weight(self) -> float:
        """The rest that the weight of infractions leaves, without the last digits of its arithmetic."""
        return round(1.0 - self.infraction_weight, 12)

    @classmethod
    def completed(cls, values: Mapping[str, Any], source: str) -> dict[str, Any]:
        """The values of a file, which may give either weight or both."""
        given = dict(values)
        path = given.pop("path_following_weight", None)
        if path is None:
            return given
        if isinstance(path, bool) or not isinstance(path, int | float):
            raise UserError(f"{source}: path_following_weight is {path!r}; it must be a number")
        weight = given.setdefault("infraction_weight", round(1.0 - path, 12))
        if isinstance(weight, int | float) and not math.isclose(weight + path, 1.0, abs_tol=1e-9):
            raise UserError(
                f"{source}: the weights {weight} (infractions) and {path} (path following) sum to {weight + path:g}; "
                "they must be non-negative and sum to 1"
            )
        return given


def scoring_to_json(scoring: Scoring) -> dict[str, Any]:
    """The whole scoring as plain values."""
    return {**to_json(scoring), "path_following_weight": scoring.path_following_weight}


def scoring_layer(document: object, source: str) -> Layer:
    """The values of a scoring in a file, to be resolved with others.

    Raises:
        UserError: it is no object.
    """
    if not isinstance(document, dict):
        raise UserError(f"{source}: a scoring is a JSON object, such as {{'penalties': {{'stop_sign': 0.7}}}}")
    return Layer(document, source)


def read_scoring_file(path: Path) -> Layer:
    """The values in a scoring file.

    Raises:
        UserError: it cannot be read, is no JSON, or no scoring.
    """
    return scoring_layer(read_json(path, "the scoring file"), f"the scoring file {path}")


def scoring_of_run(config_file: Path) -> Layer:
    """The values that a run was judged by, from its config; none where the folder has no config.

    Raises:
        UserError: the file is not a run's config.
    """
    if not config_file.exists():
        return scoring_layer({}, str(config_file))
    document = read_json(config_file, "the run's config")
    if not isinstance(document, dict) or "scoring" not in document:
        raise UserError(f"{config_file} is not the config of a run: it has no 'scoring'")
    return scoring_layer(document["scoring"], str(config_file))
