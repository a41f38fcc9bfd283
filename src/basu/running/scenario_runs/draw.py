"""``basu scenario draw``: a case's behaviour tree as it stands before a run, at its place."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from basu.episode.spec import description_of
from basu.episode.world import asking, towns_of, world_of
from basu.managers.asked import asked
from basu.managers.laid_out import lay_out
from basu.routing import lane_graph, plan
from basu.running.scenario_runs.one_case import check_town
from basu.scenarios.cases import cases_of
from basu.scenarios.drawing import draw
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from basu.running.scenario_runs.options import ScenarioOptions


def drawn(options: ScenarioOptions, form: str) -> str:
    """The tree of the first case that ``options.what`` means, in a form of ``basu.scenarios.drawing.FORMS``.

    Raises:
        UserError: there is no such case, or it cannot be laid on its map.
        SimulatorError: there is no simulator to ask for the map.
    """
    playable = cases_of(options.what, options.files)[0]
    case = playable.case
    with simulator_for(options.run_options("basic")) as simulator, asking(f"loading {case.town}"):
        check_town(case, towns_of(simulator.client))
        carla_map = world_of(simulator.client, case.town).get_map()
        route = plan(carla_map, description_of(playable, carla_map), lane_graph.build(carla_map))
        laid = lay_out(playable, route, carla_map, own=True)
        return asked(case.name, partial(draw, laid.scenario, form))
