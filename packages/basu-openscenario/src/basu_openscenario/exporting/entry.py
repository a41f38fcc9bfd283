"""The entry point of `basu scenario export`, which says what to install before it imports what it needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.extras import Extra, require
from basu.running.scenario_runs.options import PLAYERS
from basu_openscenario.staging.open_scenario import OpenScenario

if TYPE_CHECKING:
    from pathlib import Path

    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Scenario

WRITER = Extra(
    "scenariogeneration",
    "basu scenario export needs scenariogeneration, which is not installed; install it with: "
    'pip install "basu-openscenario[export]"',
)


def export(playable: Playable, scenario: Scenario, opendrive: str, path: Path, player: str = PLAYERS[0]) -> None:
    """Write a case as an OpenSCENARIO file; see ``case_export.export_case``.

    Raises:
        UserError: the extra ``export`` is not installed.
        ScenarioError: the case is a file of OpenSCENARIO, or does what the player cannot express.
    """
    require(WRITER)
    if issubclass(playable.scenario, OpenScenario):
        raise ScenarioError(f"{playable.case.name} is an OpenSCENARIO file already; give {playable.case.source} itself")
    from basu_openscenario.exporting.case_export import export_case  # noqa: PLC0415 - a package of an extra

    export_case(playable, scenario, opendrive, path, player)
