"""Claims about the behavioral agents in a live simulator, on a straight street of Linden and at its signs.

The scenes are set up by the agent itself before it drives: a file with a subclass, as a user would write one.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basu.cli import main
from basu.history import History
from basu.history.files import read_history
from servers import RunningServer

# 140 m of a straight street, one lane of 2.9 m each way, no junction
STREET = [(303.2, 119.1), (363.1, 122.4), (443.0, 126.8)]
PARKED_S_M = 60
AGENT = """
import carla
from basu.agents.behavioral import BehavioralAgent

class Visitor(BehavioralAgent):
    def setup(self):
        super().setup()
        self.guests = []
        self.manager = self.client.get_trafficmanager({tm_port})
        self.manager.set_synchronous_mode(True)
        self.manager.set_random_device_seed(1)
        {scene}

    def put(self, waypoint, name="vehicle.audi.a2"):
        pose = waypoint.transform
        pose.location.z += 0.3
        guest = self.world.spawn_actor(self.world.get_blueprint_library().find(name), pose)
        self.guests.append(guest)
        return guest

    def across(self, number):
        return self.route.waypoints[number].get_left_lane()

    def send(self, waypoint, slower_by=0.0):
        guest = self.put(waypoint)
        guest.set_autopilot(True, {tm_port})
        self.manager.vehicle_percentage_speed_difference(guest, slower_by)
        self.manager.ignore_lights_percentage(guest, 100.0)

    def destroy(self):
        self.manager.set_synchronous_mode(False)
        for guest in self.guests:
            guest.destroy()
"""
Driven = Callable[..., tuple[History, dict[str, Any]]]


@pytest.fixture
def driven(simulator: RunningServer, tmp_path: Path) -> Driven:
    """Drive a scene; the history and the result."""

    def run(points: list[tuple[float, float]], *scene: str) -> tuple[History, dict[str, Any]]:
        agent, route = tmp_path / "visitor.py", tmp_path / "route.xml"
        agent.write_text(AGENT.format(scene="\n        ".join(scene), tm_port=simulator.port + 4000))
        way = "".join(f'<position x="{x}" y="{y}" z="250.0"/>' for x, y in points)
        route.write_text(f'<routes><route id="1" town="Linden"><waypoints>{way}</waypoints></route></routes>')
        output = tmp_path / "runs"
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        main(["run", str(agent), *address, "--routes", str(route), "--output", str(output)])
        return read_history(output / "latest"), json.loads((output / "latest" / "result.json").read_text())

    return run


def infractions(result: dict[str, Any]) -> list[str]:
    return [f"{one['kind']}: {one['detail']}" for one in result["infractions"]]


def test_it_goes_round_a_car_parked_in_its_lane_and_comes_back(driven: Driven) -> None:
    history, result = driven(STREET, "self.put(self.route.waypoints[60])")
    s_m, lateral_m = history.frames["route_s_m"], history.frames["lateral_m"]
    assert (result["status"], infractions(result)) == ("Completed", [])
    assert lateral_m[np.abs(s_m - PARKED_S_M) < 2.0].max() < -2.0
    assert np.abs(lateral_m[(s_m > 90.0) | (s_m < 25.0)]).max() < 0.3


def test_it_lets_oncoming_cars_past_before_it_goes_round(driven: Driven) -> None:
    scene = ("self.put(self.route.waypoints[60])", "for k in (100, 118, 136): self.send(self.across(k), 40.0)")
    history, result = driven(STREET, *scene)
    s_m, lateral_m = history.frames["route_s_m"], history.frames["lateral_m"]
    assert (result["status"], infractions(result)) == ("Completed", [])
    out = int(np.argmax(lateral_m < -0.5))
    now, frame = history.others[history.others["tick"] == out], history.frames[out]
    ahead = (now["x_m"] > frame["x_m"]) & (now["velocity_x_mps"] < -1.0)
    assert not ahead.any()  # nobody within the 60 m that are recorded …
    met = history.others[(history.others["tick"] < out) & (history.others["velocity_x_mps"] < -1.0)]
    assert len(set(met["id"].tolist())) == 3  # … and all three have been let past
    assert lateral_m[np.abs(s_m - PARKED_S_M) < 2.0].max() < -2.0
