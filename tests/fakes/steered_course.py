"""The wheel of a vehicle under test that a rehearsed scenario disturbs."""

from py_trees.common import Status

from basu.scenarios.scenario import Scenario, compose, set_on
from basu.scenarios.stage import Controls
from basu.testing import OfflineStage, steady

STRAIGHT_AHEAD = Controls(0.5, 0.0, 0.0)


def steered(scenario: Scenario, seed: int = 0, speed_mps: float = 6.0) -> list[tuple[float, float]]:
    """Return where on the route (m) the ego was in each frame, and its wheel (-1 to 1) while it wanted no turn."""
    stage = OfflineStage(scenario.place, scenario.actors(), steady(speed_mps), seed=seed)
    tree = compose(scenario)
    set_on(tree, stage)
    told = []
    while tree.root.root.status != Status.SUCCESS and stage.time_s < scenario.timeout_s:
        tree.root.tick()
        told.append((stage.ego_s_m, stage.controls(STRAIGHT_AHEAD).steer))
        stage.advance()
    return told
