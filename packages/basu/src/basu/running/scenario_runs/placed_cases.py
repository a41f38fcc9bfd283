"""Cases on their maps, without a drive: to draw the behaviour tree of one, or to export cases to other programs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from basu import plugins
from basu.episode.spec import description_of
from basu.episode.world import asking, towns_of, world_with
from basu.errors import ScenarioError, UserError
from basu.managers.placed_scenario import call_scenario, place_scenario
from basu.routing import lane_graph, plan
from basu.running.scenario_runs.maps_of_cases import maps_of, with_maps
from basu.running.scenario_runs.one_case import check_town
from basu.running.scenario_runs.options import PLAYERS
from basu.scenarios.cases import cases_of
from basu.scenarios.tree_picture import draw
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    import carla

    from basu.managers.placed_scenario import PlacedScenario
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.playable import Playable

EXPORT = ".xosc"
"""The suffix of an exported case."""


class PlacedCase(NamedTuple):
    """A case on its route."""

    playable: Playable
    placed: PlacedScenario
    carla_map: carla.Map


class Exported(NamedTuple):
    """What came of an export: the file, or why there is none."""

    case: str
    path: Path
    refusal: str = ""


def placed_cases(options: ScenarioOptions, playables: Sequence[Playable]) -> Iterator[PlacedCase]:
    """Yield cases on their maps, town by town.

    Raises:
        UserError: a case cannot be laid on its map.
        SimulatorError: there is no simulator to ask for the map.
    """
    by_town = sorted(playables, key=lambda playable: playable.case.town)
    with (
        maps_of(playable.case for playable in by_town) as folders,
        simulator_for(with_maps(options.simulator, folders)) as simulator,
    ):
        town, carla_map, lanes = "", None, None
        for playable in by_town:
            case = playable.case
            if case.town != town:
                with asking(f"loading {case.town}"), simulator.long_call():
                    check_town(case, towns_of(simulator, [case.town]))
                    _, carla_map = world_with(simulator, case.town)
                town, lanes = case.town, lane_graph.build(carla_map)
            route = plan(carla_map, description_of(playable, carla_map), lanes)
            yield PlacedCase(playable, place_scenario(playable, route, carla_map, own=True), carla_map)


def drawn(options: ScenarioOptions, form: str) -> str:
    """The tree of the first case that ``options.what`` means, in a form of ``basu.scenarios.tree_picture.FORMS``.

    Raises:
        UserError: there is no such case, or it cannot be laid on its map.
        SimulatorError: there is no simulator to ask for the map.
    """
    playable = cases_of(options.what, options.files)[0]
    (one,) = placed_cases(options, [playable])
    return call_scenario(playable.case.name, partial(draw, one.placed.scenario, form))


def export_cases(options: ScenarioOptions, output: Path, player: str = PLAYERS[0]) -> Iterator[Exported]:
    """Write the cases that ``options.what`` means as OpenSCENARIO files, and yield what came of each.

    Args:
        options: the cases, and the simulator that has their maps.
        output: FILE.xosc for one case, or a folder, which gets CASE_exported.xosc for each. A file is a case with the
            name of the file. It needs another name than the exported case has.
        player: one of ``PLAYERS``.

    Raises:
        UserError: there is no such case, several are to be one file, or basu-openscenario is not installed.
        SimulatorError: there is no simulator to ask for the map.
    """
    playables = cases_of(options.what, options.files)
    if output.suffix == EXPORT and len(playables) > 1:
        raise UserError(f"--output {output}: {len(playables)} cases need a folder; name one without {EXPORT}")
    export: Callable[..., object] = plugins.load(plugins.PARTS, "scenario_export", "basu scenario export")
    for one in placed_cases(options, playables):
        name = one.playable.case.name
        path = output if output.suffix == EXPORT else output / f"{name}_exported{EXPORT}"
        try:
            export(one.playable, one.placed.scenario, one.carla_map.to_opendrive(), path, player)
        except ScenarioError as error:
            yield Exported(name, path, str(error))
        else:
            yield Exported(name, path)
