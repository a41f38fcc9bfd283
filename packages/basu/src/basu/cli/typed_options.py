"""The options and the scoring of a parsed command line, laid over those of the files that it names."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from basu.metrics.scoring import Scoring, read_scoring
from basu.settings.command_line import typed
from basu.settings.document import Config, read_config
from basu.settings.option import Layer
from basu.settings.resolve import Model, resolve

if TYPE_CHECKING:
    import argparse

    from basu.settings.option import Settings


def options_of(model: type[Model], arguments: argparse.Namespace, *below: Layer) -> Model:
    """The options of a command line; where it says nothing, those of the layers ``below``, the later before.

    Raises:
        UserError: an option that does not exist, or a value that it cannot have.
    """
    return resolve(model, [*below, Layer(typed(model, arguments), typed=True)])


def scoring_of(arguments: argparse.Namespace, below: Layer) -> Scoring:
    """The scoring of ``below``, of the file that the command line names and of its options, the later before.

    Raises:
        UserError: an option that does not exist, or a value that it cannot have.
    """
    file = [] if arguments.scoring is None else [read_scoring(arguments.scoring)]
    return options_of(Scoring, arguments, below, *file)


def config_of(arguments: argparse.Namespace, kind: str, model: type[Settings]) -> Config:
    """The document that ``--config`` names, or an empty one; says why the run may differ from the one that left it.

    Raises:
        UserError: it is none.
    """
    if arguments.config is None:
        return Config(Layer({}), Layer({}), ())
    config = read_config(arguments.config, kind, model)
    for difference in config.warnings:
        print(f"basu: warning: {difference}; the run may differ from that of {arguments.config}", file=sys.stderr)
    return config
