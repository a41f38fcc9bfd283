"""``basu scenario run``: cases with agents, each judged."""

from __future__ import annotations

import argparse

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import check_extras, config_of, options_of, scoring_of
from basu.running.scenario_runs.command import run_scenarios
from basu.running.scenario_runs.options import ScenarioOptions


def run(arguments: argparse.Namespace) -> int:
    """Play cases with agents: a verdict, a picture and a folder for each, and the matrix of all."""
    config = config_of(arguments, "scenario run", ScenarioOptions)
    options = options_of(ScenarioOptions, arguments, config.options)
    check_extras(options)
    scoring = scoring_of(arguments, config.scoring)
    with terminated_as_interrupted():
        return run_scenarios(options, scoring)
