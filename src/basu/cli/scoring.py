"""What is adjustable in the score: options of a command line, and the scoring that a run was judged by."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

from basu.errors import UserError
from basu.metrics.infraction import Infraction
from basu.metrics.passengers.comfort_score import ComfortWeights, weights_from
from basu.metrics.passengers.felt import Place
from basu.metrics.score import Scoring
from basu.metrics.scoring_json import read_scoring_file, scoring_from_json


def add_metrics(command: argparse.ArgumentParser) -> None:
    """The option for metrics of the user's own."""
    command.add_argument(
        "--metrics",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.py",
        help="metrics of your own, reported beside BASU's or scored with them; may be given several times",
    )


def add_scoring(command: argparse.ArgumentParser) -> None:
    """What is adjustable in the score."""
    kinds = ", ".join(kind.value for kind in Infraction)
    command.add_argument(
        "--scoring",
        type=Path,
        metavar="FILE",
        help="a JSON file with what differs from the thesis's scoring; the options below go before it",
    )
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
    command.add_argument(
        "--speeding-tolerance",
        type=float,
        metavar="M/S",
        help="how far above the posted limit speeding begins (default: 1.0)",
    )
    command.add_argument(
        "--route-deviation",
        type=float,
        metavar="M",
        help="how far from the planned line the vehicle is outside the plan (default: 2.0)",
    )
    parts = ", ".join(ComfortWeights().named())
    command.add_argument(
        "--comfort-weight",
        action="append",
        default=[],
        metavar="NAME=W",
        help=f"how much a part of the comfort score counts; may be given several times; parts: {parts}",
    )
    command.add_argument(
        "--standing-place",
        metavar="F,R,U",
        help="where passengers stand, m forward, right and up from the vehicle's origin (default: 0.7,0.5,0.3)",
    )
    command.add_argument(
        "--harsh-stop", type=float, metavar="M/S2", help="felt by them, it makes a braking a harsh stop (default: 1.5)"
    )


def adjusted(scoring: Scoring, arguments: argparse.Namespace) -> Scoring:
    """``scoring``, or that of the file the command line names, with what its options changed.

    Raises:
        UserError: a kind there is not, a number that is none, or a file that is no scoring.
    """
    if arguments.scoring is not None:
        scoring = read_scoring_file(arguments.scoring)
    penalties = dict(scoring.penalties)
    for text in arguments.penalty:
        name, _, number = text.partition("=")
        try:
            penalties[Infraction(name)] = float(number)
        except ValueError:
            kinds = ", ".join(kind.value for kind in Infraction)
            raise UserError(f"--penalty {text}: write KIND=FACTOR, the kind one of {kinds}") from None
    weights = _comfort_weights(scoring.comfort_weights, arguments.comfort_weight)
    changed: dict[str, float] = {}
    if arguments.infraction_weight is not None:
        changed["infraction_weight"] = arguments.infraction_weight
        changed["path_following_weight"] = 1.0 - arguments.infraction_weight
    if arguments.speeding_tolerance is not None:
        changed["speeding_tolerance_mps"] = arguments.speeding_tolerance
    if arguments.route_deviation is not None:
        changed["route_deviation_m"] = arguments.route_deviation
    if arguments.harsh_stop is not None:
        changed["harsh_stop_mps2"] = arguments.harsh_stop
    place = scoring.standing_place if arguments.standing_place is None else _place(arguments.standing_place)
    return replace(scoring, penalties=penalties, comfort_weights=weights, standing_place=place, **changed)


def _comfort_weights(weights: ComfortWeights, given: list[str]) -> ComfortWeights:
    """Weights with what ``NAME=W`` changes."""
    named = weights.named()
    for text in given:
        name, _, number = text.partition("=")
        try:
            named[name] = float(number)
        except ValueError:
            raise UserError(f"--comfort-weight {text}: write NAME=W, the name one of {', '.join(named)}") from None
    return weights_from(named, "--comfort-weight")


def _place(text: str) -> Place:
    """Three numbers with commas."""
    try:
        forward_m, right_m, up_m = (float(number) for number in text.split(","))
    except ValueError:
        raise UserError(f"--standing-place {text}: write three numbers in m, such as 0.7,0.5,0.3") from None
    return Place(forward_m, right_m, up_m)


def read_scoring(path: Path) -> Scoring:
    """The scoring that a run was judged by, from its config; the thesis's where it says nothing.

    Raises:
        UserError: the file is not a run's config.
    """
    if not path.exists():
        return Scoring()
    try:
        given = json.loads(path.read_text(encoding="utf-8"))["scoring"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{path} is not the config of a run: {error!r}") from error
    return scoring_from_json(given, str(path))
