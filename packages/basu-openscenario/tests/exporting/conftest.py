"""A writer of cases of Linden for a player, with the town read once."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import carla
import pytest

import linden
from basu.episode.spec import description_of
from basu.managers.placed_scenario import place_scenario
from basu.routing import lane_graph, plan
from basu.scenarios.cases import by_id
from basu_openscenario.exporting.case_export import Exported, export_case


@pytest.fixture(scope="module")
def export_for(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], tuple[Exported, Path]]:
    """Exports a case by its id for a player; each once."""
    text = (Path(linden.__file__).parent / "data" / "Linden.xodr").read_text(encoding="utf-8")
    town = carla.Map("Linden", text)
    lanes = lane_graph.build(town)
    folder = tmp_path_factory.mktemp("exported")

    @cache
    def make(name: str, player: str) -> tuple[Exported, Path]:
        playable = by_id(name)
        placed = place_scenario(playable, plan(town, description_of(playable, town), lanes), town, own=True)
        path = folder / f"{name}.xosc"
        return export_case(playable, placed.scenario, text, path, player), path

    return make
