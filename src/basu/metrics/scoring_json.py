"""A scoring as plain values and back: in a run's config and result, and in a file for ``--scoring``.

A file may leave out what it does not change. Its keys are the names of a scoring's options. One weight alone gives the
other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.metrics.score import Scoring
from basu.settings.option import Layer, to_json
from basu.utils.json_file import read_json

if TYPE_CHECKING:
    from pathlib import Path


def scoring_to_json(scoring: Scoring) -> dict[str, Any]:
    """The whole scoring as plain values."""
    return {**to_json(scoring), "path_following_weight": scoring.path_following_weight}


def scoring_from_json(document: object, source: str) -> Scoring:
    """The scoring that ``document`` describes, the thesis's values where it says nothing.

    Raises:
        UserError: a key that means nothing, a value that is no number, weights that do not sum to 1; the sentence
            begins with ``source``.
    """
    from basu.settings.resolve import resolve  # noqa: PLC0415 - pydantic, which `--help` does not need

    return resolve(Scoring, [scoring_layer(document, source)])


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
