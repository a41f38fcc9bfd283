"""A scoring: penalties, weights and thresholds of a judgement as options, and read from files.

A file may leave out what it does not change. Its keys are the names of a scoring's options. One weight alone gives the
other.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from basu.errors import UserError
from basu.files import read_json
from basu.metrics.infraction import DEFAULT_PENALTIES, Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights
from basu.metrics.passengers.felt import STANDING, PassengerPlace
from basu.metrics.passengers.harsh_stops import HARSH_MPS2
from basu.settings.option import Layer, Settings, option, to_json

TOLERANCE_MPS = 1.0  # above the limit; 2.2 mph, about what a speedometer may be off at 25 mph
THRESHOLD_M = 2.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Scoring(Settings):
    """The adjustable part of a judgement; the defaults are the thesis's values."""

    GROUP = "scoring"
    FILE_FLAG = "--scoring"

    penalties: Mapping[Infraction, float] = option(
        dict(DEFAULT_PENALTIES),
        "the factor of each infraction of a kind; may be given several times",
        flag="--penalty",
        metavar="KIND=FACTOR",
        least=0.0,
        most=1.0,
    )
    infraction_weight: float = option(
        0.8, "weight of the infraction score; path following has the rest", least=0.0, most=1.0
    )
    speeding_tolerance_mps: float = option(
        TOLERANCE_MPS, "excess over the posted limit at which speeding begins", least=0.0
    )
    route_deviation_m: float = option(
        THRESHOLD_M, "distance from the planned line at which the vehicle is outside the plan", least=0.0
    )
    comfort_weights: ComfortWeights = option(
        ComfortWeights(),
        "weight of each part of the passengers' comfort score",
        flag="--comfort-weight",
        in_files="""write it as in --scoring '{"comfort_weights": {"service": 0.5}}', or name a file with that""",
        least=0.0,
    )
    standing_place: PassengerPlace = option(
        STANDING,
        "where passengers stand, from the vehicle's origin",
        unit="m",
        default_text="0.7 forward, 0.5 right, 0.3 up",
        in_files="write it as in --scoring "
        """'{"standing_place": {"forward_m": 0.7, "right_m": 0.5, "up_m": 0.3}}', or name a file with that""",
    )
    harsh_stop_mps2: float = option(
        HARSH_MPS2, "braking as strong as this, felt by standing passengers, is a harsh stop", least=0.0
    )

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


def read_scoring(given: str) -> Layer:
    """The values of ``--scoring``: a file, or JSON as text.

    Raises:
        UserError: it cannot be read, is no JSON, or no scoring.
    """
    if not given.lstrip().startswith("{"):
        return scoring_layer(read_json(Path(given), "the scoring file"), f"the scoring file {given}")
    try:
        return scoring_layer(json.loads(given), "--scoring")
    except json.JSONDecodeError as error:
        raise UserError(f"--scoring {given} is no JSON: {error}") from None


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
