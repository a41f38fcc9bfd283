"""What is adjustable in the score: options of a command line, and the scoring that a run was judged by."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from basu.errors import UserError
from basu.metrics.infraction import Infraction
from basu.metrics.score import Scoring


def add_scoring(command: argparse.ArgumentParser) -> None:
    """What is adjustable in the score."""
    kinds = ", ".join(kind.value for kind in Infraction)
    command.add_argument(
        "--penalty",
        action="append",
        default=[],
        metavar="KIND=FACTOR",
        help=f"what an infraction costs, 0..1; may be given several times; kinds: {kinds}",
    )
    command.add_argument(
        "--infraction-weight", type=float, metavar="W", help="path following weighs 1 - W (default: 0.8)"
    )


def adjusted(scoring: Scoring, arguments: argparse.Namespace) -> Scoring:
    """``scoring`` with what the command line changed.

    Raises:
        UserError: a kind there is not, or a number that is none.
    """
    penalties = dict(scoring.penalties)
    for text in arguments.penalty:
        name, _, number = text.partition("=")
        try:
            penalties[Infraction(name)] = float(number)
        except ValueError:
            kinds = ", ".join(kind.value for kind in Infraction)
            raise UserError(f"--penalty {text}: write KIND=FACTOR, the kind one of {kinds}") from None
    weight = scoring.infraction_weight if arguments.infraction_weight is None else arguments.infraction_weight
    return Scoring(penalties=penalties, infraction_weight=weight, path_following_weight=1.0 - weight)


def read_scoring(path: Path) -> Scoring:
    """The scoring that a run was judged by, from its config; the thesis's where it says nothing.

    Raises:
        UserError: the file is not a run's config.
    """
    if not path.exists():
        return Scoring()
    try:
        given = json.loads(path.read_text(encoding="utf-8"))["scoring"]
        return Scoring(
            penalties={Infraction(kind): float(penalty) for kind, penalty in given["penalties"].items()},
            infraction_weight=given["infraction_weight"],
            path_following_weight=given["path_following_weight"],
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{path} is not the config of a run: {error!r}") from error
