"""A scoring as plain values and back: in a run's config and result, and in a file for ``--scoring``.

A file may leave out what it does not change. Its keys are ``penalties``, kinds with their factors, and the names of a
scoring's numbers. One weight alone gives the other.
"""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.metrics.infraction import DEFAULT_PENALTIES, Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights, weights_from
from basu.metrics.passengers.felt import STANDING, Place
from basu.metrics.score import Scoring
from basu.utils.json_file import read_json

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

WEIGHTS = ("infraction_weight", "path_following_weight")
NUMBERS = (*WEIGHTS, "speeding_tolerance_mps", "route_deviation_m", "harsh_stop_mps2")
OBJECTS = ("penalties", "comfort_weights", "standing_place")


def scoring_to_json(scoring: Scoring) -> dict[str, Any]:
    """The whole scoring as plain values."""
    return {
        "penalties": {kind.value: penalty for kind, penalty in scoring.penalties.items()},
        **{name: getattr(scoring, name) for name in NUMBERS},
        "comfort_weights": scoring.comfort_weights.named(),
        "standing_place": scoring.standing_place._asdict(),
    }


def scoring_from_json(document: object, source: str) -> Scoring:
    """The scoring that ``document`` describes, the thesis's values where it says nothing.

    Raises:
        UserError: a key that means nothing, a value that is no number, weights that do not sum to 1; the sentence
            begins with ``source``.
    """
    if not isinstance(document, dict):
        raise UserError(f"{source}: a scoring is a JSON object, such as {{'penalties': {{'stop_sign': 0.7}}}}")
    for key in document:
        _known(str(key), (*OBJECTS, *NUMBERS), source)
    numbers = {name: _number(document[name], f"{source}: {name}") for name in NUMBERS if name in document}
    given = [name for name in WEIGHTS if name in numbers]
    if len(given) == 1:
        other = WEIGHTS[1 - WEIGHTS.index(given[0])]
        numbers[other] = 1.0 - numbers[given[0]]
    weights = _comfort_weights(document.get("comfort_weights", {}), source)
    place = _place(document.get("standing_place", {}), source)
    penalties = _penalties(document.get("penalties", {}), source)
    try:
        return Scoring(penalties=penalties, comfort_weights=weights, standing_place=place, **numbers)
    except UserError as error:
        raise UserError(f"{source}: {error}") from None


def read_scoring_file(path: Path) -> Scoring:
    """The scoring in a file.

    Raises:
        UserError: it cannot be read, is no JSON, or no scoring.
    """
    return scoring_from_json(read_json(path, "the scoring file"), f"the scoring file {path}")


def _penalties(given: object, source: str) -> dict[Infraction, float]:
    """The factors, the default ones where none is given."""
    if not isinstance(given, dict):
        raise UserError(f"{source}: 'penalties' is {given!r}; it must be an object of kinds and factors")
    for kind in given:
        _known(str(kind), [known.value for known in Infraction], source)
    changed = {Infraction(kind): _number(factor, f"{source}: the penalty of {kind}") for kind, factor in given.items()}
    return {**DEFAULT_PENALTIES, **changed}


def _comfort_weights(given: object, source: str) -> ComfortWeights:
    """The weights of the passengers' score, the default ones where none is given."""
    if not isinstance(given, dict):
        raise UserError(f"{source}: 'comfort_weights' is {given!r}; it must be an object of parts and weights")
    return weights_from(
        {name: _number(w, f"{source}: the comfort weight of {name}") for name, w in given.items()}, source
    )


def _place(given: object, source: str) -> Place:
    """Where passengers stand, the default's coordinates where none is given."""
    if not isinstance(given, dict):
        raise UserError(f"{source}: 'standing_place' is {given!r}; it must be an object of {', '.join(Place._fields)}")
    for name in given:
        _known(str(name), Place._fields, source)
    return STANDING._replace(**{n: _number(value, f"{source}: {n} of standing_place") for n, value in given.items()})


def _known(key: str, names: Iterable[str], source: str) -> None:
    """Refuse a key that means nothing."""
    names = list(names)
    if key not in names:
        close = difflib.get_close_matches(key, names, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"there are {', '.join(names)}"
        raise UserError(f"{source} has the key '{key}', which means nothing in a scoring; {hint}")


def _number(value: object, what: str) -> float:
    """A number that is none of JSON's other things."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UserError(f"{what} is {value!r}; it must be a number")
    return float(value)
