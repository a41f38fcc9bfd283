"""``basu scenario run``: cases with agents, each judged."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import config_of, options_of, scoring_of
from basu.errors import UserError
from basu.metrics.scoring import Scoring
from basu.output.report.documents import CONFIG_FILE
from basu.running.batch import changes
from basu.running.outputs import check_outputs
from basu.running.scenario_runs.command import run_scenarios
from basu.running.scenario_runs.options import ScenarioOptions
from basu.scenarios.cases import is_led_by_file
from basu.settings.command_line import typed
from basu.settings.option import fields_of, to_json

if TYPE_CHECKING:
    from collections.abc import Mapping


def run(arguments: argparse.Namespace) -> int:
    """Play cases with agents: a verdict, a picture and a folder for each, and the matrix of all."""
    resumed: Path | None = arguments.resume
    if resumed is not None:
        if arguments.config is not None:
            raise UserError("--resume goes on with a run and its options; leave out --config")
        arguments.config = resumed.resolve()
    config = config_of(arguments, "scenario run", ScenarioOptions)
    options = options_of(ScenarioOptions, arguments, config.options)
    if "agents" not in {**config.options.values, **typed(ScenarioOptions, arguments)} and is_led_by_file(options.what):
        options = replace(options, agents=("standing",), fixed=(*options.fixed, ("driver", "file")))
    scoring = scoring_of(arguments, config.scoring)
    if resumed is not None:
        resumed = resumed.resolve()
        if config.warnings:
            raise UserError(f"{resumed} cannot go on: {'; '.join(config.warnings)}; begin another run")
        _check_unchanged(resumed, options, scoring, config.options.values)
    check_outputs(options)
    with terminated_as_interrupted():
        return run_scenarios(options, scoring, resumed)


def _check_unchanged(folder: Path, options: ScenarioOptions, scoring: Scoring, before: Mapping[str, object]) -> None:
    """Check that a run goes on under the conditions that it was begun with.

    Raises:
        UserError: names what is different.
    """
    repeating = [field for field in fields_of(ScenarioOptions) if field.option.repeats]
    now = {field.flag: to_json(getattr(options, field.name)) for field in repeating}
    document = json.loads((folder / CONFIG_FILE).read_text(encoding="utf-8"))
    begun = {field.flag: before.get(field.name, to_json(field.default)) for field in repeating}
    given = {**begun, "scoring": document.get("scoring", to_json(Scoring()))}
    changed = changes(given, {**now, "scoring": to_json(scoring)})
    if changed:
        raise UserError(f"the run in {folder} was begun differently: {changed}; leave that out, or begin another run")
