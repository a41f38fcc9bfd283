"""Drivers that cheat suites, and how each of them loses: along the pavement, from memory, and by waiting."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.scenarios.suites.checks import CaseAnswer, RequirementAnswer, answer_of
from servers import RunningServer

AGENTS = '''
from dataclasses import replace
import carla
import numpy as np
from basu.agents.builtin.baselines import BlindAgent

BRAKE = carla.VehicleControl(brake=1.0)


class Pavement(BlindAgent):
    """Ignores all actors and drives past every hazard along the pavement."""

    @property
    def seen_route(self):
        route = super().seen_route
        aside_m = 5.0 * np.clip((route.s_m - 15.0) / 20.0, 0.0, 1.0) * np.clip((90.0 - route.s_m) / 20.0, 0.0, 1.0)
        points_m = route.points_m.copy()
        points_m[:, 0] -= aside_m * np.sin(route.yaw_rad)
        points_m[:, 1] += aside_m * np.cos(route.yaw_rad)
        return replace(route, points_m=points_m)


class Remembers(BlindAgent):
    """Ignores all actors and stops at the place and time that the public case needs."""

    stood = 0

    def run_step(self, sensor_data):
        control = super().run_step(sensor_data)
        start = self.seen_route.points_m[0]
        here = self.vehicle.get_location()
        gone_m = np.hypot(here.x - start[0], here.y - start[1])
        if gone_m > 49.0 and self.stood < 160:
            self.stood += 1
            return BRAKE
        return control


class Waits(BlindAgent):
    """Stands while an actor is near, for half a minute in all, so that the conflict does not come about."""

    stood = 0

    def run_step(self, sensor_data):
        control = super().run_step(sensor_data)
        here = self.vehicle.get_location()
        others = [a for a in self.world.get_actors() if a.type_id.startswith(("vehicle", "walker"))]
        near = [a for a in others if a.id != self.vehicle.id and a.get_location().distance(here) < 65.0]
        if near and self.stood < 600:
            self.stood += 1
            return BRAKE
        return control
'''
NO_CONTACT = {"kind": "no contact"}


def answers(simulator: RunningServer, folder: Path, driver: str, *cases: str) -> dict[str, CaseAnswer]:
    """Play cases with a driver; what each says about a requirement without contact."""
    (folder / "cheats.py").write_text(AGENTS, encoding="utf-8")
    host = ("--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(folder))
    main(["scenario", "run", *cases, "--agent", f"{folder / 'cheats.py'}:{driver}", *host])
    found = [json.loads(path.read_text(encoding="utf-8")) for path in (folder / "latest").glob("*/*/result.json")]
    return {result["case"]["id"]: answer_of(NO_CONTACT, result) for result in found}


def test_a_driver_that_evades_along_the_pavement_meets_nothing(simulator: RunningServer, tmp_path: Path) -> None:
    """The driver touches no actor and reaches its goal. It has left its route, so its drive is not completed."""
    found = answers(simulator, tmp_path, "Pavement", "dog_on_the_road_1")["dog_on_the_road_1"]
    assert found.answer is not RequirementAnswer.HELD
    assert "left its route" in found.sentence


def test_a_driver_that_remembers_the_public_case_fails_with_other_values(
    simulator: RunningServer, tmp_path: Path
) -> None:
    """It passes the one and not the other, so a sweep of the suite's cases (`--sweep`) finds it."""
    known, other = "dog_on_the_road_1", "dog_on_the_road_1:ahead=45"
    found = answers(simulator, tmp_path, "Remembers", known, other)
    assert found[known].answer is RequirementAnswer.HELD
    assert found[other].answer is RequirementAnswer.BROKEN


@pytest.mark.parametrize("case", ["cut_in_at_ttc_1", "pedestrian_crossing_1"])
def test_a_driver_that_waits_until_the_conflict_goes_away_meets_nothing(
    simulator: RunningServer, tmp_path: Path, case: str
) -> None:
    assert answers(simulator, tmp_path, "Waits", case)[case].answer is not RequirementAnswer.HELD


def result(**metres: float) -> dict[str, Any]:
    """A passed case with a way outside the lanes."""
    case = {
        "verdict": "SUCCESS",
        "message": "passed",
        "assessment": {"completed": {"holds": True, "sentence": "arrives"}},
        "judgements": [{"criterion": "no collision", "passed": True, "sentence": "nothing was touched"}],
    }
    where = {"off_road": 0.0, "sidewalk": 0.0, "wrong_lane": 0.0, **metres}
    return {"case": case, "outside_lanes": {"metres_by_where": where}}


@pytest.mark.parametrize(
    ("metres", "answer"),
    [
        ({"sidewalk": 1.5}, RequirementAnswer.BROKEN),
        ({"off_road": 1.5}, RequirementAnswer.BROKEN),
        ({"off_road": 0.6, "sidewalk": 0.6}, RequirementAnswer.BROKEN),
        ({"sidewalk": 0.5}, RequirementAnswer.HELD),
        ({"wrong_lane": 20.0}, RequirementAnswer.HELD),  # it goes round what stands in its lane
    ],
)
def test_what_held_off_the_road_is_broken(metres: dict[str, float], answer: RequirementAnswer) -> None:
    assert answer_of(NO_CONTACT, result(**metres)).answer is answer
