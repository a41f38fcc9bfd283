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
from basu.metrics import ending
from basu.records.history import History
from basu.records.history.files import read_history
from servers import RunningServer

# 140 m of a straight street, one lane of 2.9 m each way, no junction
STREET = [(303.2, 119.1), (363.1, 122.4), (443.0, 126.8)]
PARKED_S_M = 60
# to a stop sign on a street that crosses another one, and over it; into a roundabout and a quarter round it
STOP_SIGN = [(551.891, -190.129), (560.519, -223.138), (562.011, -248.784), (563.4, -275.0)]
ROUNDABOUT = [(480.0, -22.3), (470.526, -25.861), (448.135, -39.865), (448.541, -60.042), (473.087, -81.993)]
AGENT = """
import math
import carla
from basu.agents.builtin.behavioral import BehavioralAgent

class Visitor(BehavioralAgent):
    def setup(self):
        super().setup()
        self.guests = []
        {scene}

    def put(self, waypoint):
        pose = waypoint.transform
        pose.location.z += 0.3
        guest = self.world.spawn_actor(self.world.get_blueprint_library().find("vehicle.audi.a2"), pose)
        self.guests.append((guest, [], 0.0))

    def across(self, number):
        return self.route.waypoints[number].get_left_lane()

    def send(self, waypoint, speed_mps, turn=0.0):
        # along the lanes; where they part, the way that turns most like `turn` (rad, to the right)
        way, yaw = [waypoint], waypoint.transform.rotation.yaw
        for _ in range(150):
            ahead = way[-1].next(1.5)
            if not ahead:
                break
            at = way[-1].transform.rotation.yaw
            way.append(min(ahead, key=lambda w: abs(math.remainder(
                math.radians(w.transform.rotation.yaw - at) - turn, math.tau))))
        self.put(waypoint)
        self.guests[-1] = (self.guests[-1][0], way, speed_mps)

    def send_across(self, number, speed_mps, turn, *metres):
        ours = self.route.waypoints[0].road_id
        entries = {{}}
        for entry, _ in self.route.waypoints[number].get_junction().get_waypoints(carla.LaneType.Driving):
            for start in entry.previous(1.0):
                if start.road_id != ours and not start.is_junction:
                    entries[start.road_id, start.lane_id] = start
        for start in entries.values():
            for back in metres:
                self.send(start.previous(back)[0], speed_mps, turn)

    def run_step(self, data):
        for guest, way, speed_mps in self.guests:
            pose, velocity = guest.get_transform(), guest.get_velocity()
            while len(way) > 1 and way[0].transform.location.distance(pose.location) < 4.0:
                way.pop(0)
            control = carla.VehicleControl(hand_brake=not way)
            if way:
                to = way[0].transform.location
                off = math.atan2(to.y - pose.location.y, to.x - pose.location.x) - math.radians(pose.rotation.yaw)
                control.steer = max(-1.0, min(1.0, 1.2 * math.remainder(off, math.tau)))
                control.throttle = max(0.0, min(0.8, 0.4 * (speed_mps - math.hypot(velocity.x, velocity.y)) + 0.3))
            guest.apply_control(control)
        return super().run_step(data)

    def destroy(self):
        for guest, _, _ in self.guests:
            guest.destroy()
"""
Driven = Callable[..., tuple[History, dict[str, Any]]]


@pytest.fixture
def driven(simulator: RunningServer, tmp_path: Path) -> Driven:
    """Drive a scene; the history and the result."""

    def run(points: list[tuple[float, float]], *scene: str) -> tuple[History, dict[str, Any]]:
        agent, route = tmp_path / "visitor.py", tmp_path / "route.xml"
        agent.write_text(AGENT.format(scene="\n        ".join(scene)))
        way = "".join(f'<position x="{x}" y="{y}" z="250.0"/>' for x, y in points)
        route.write_text(f'<routes><route id="1" town="Linden"><waypoints>{way}</waypoints></route></routes>')
        output = tmp_path / "runs"
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        main(["run", str(agent), "--in-process", *address, "--routes", str(route), "--output", str(output)])
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


@pytest.mark.unmeasured
def test_it_lets_oncoming_cars_past_before_it_goes_round(driven: Driven) -> None:
    scene = ("self.put(self.route.waypoints[60])", "for k in (100, 118, 136): self.send(self.across(k), 6.5)")
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


@pytest.mark.unmeasured
def test_at_a_stop_sign_the_ones_go_first_that_cross(driven: Driven) -> None:
    number = "next(k for k, w in enumerate(self.route.waypoints) if w.is_junction)"
    history, result = driven(STOP_SIGN, f"self.send_across({number}, 6.0, 0.0, 8.0, 30.0, 52.0)")
    assert (result["status"], infractions(result)) == ("Completed", [])
    line_s_m = next(control.s_m for control in history.facts.route.controls)
    frames, speed_mps = history.frames, history.speed_mps()
    waits_s = history.facts.step_s * np.sum((speed_mps < 0.05) & (np.abs(frames["route_s_m"] - line_s_m) < 6.0))
    assert waits_s > 2.0  # an empty crossing is left after 1.2 s of rest
    inside = (frames["route_s_m"] > line_s_m + 3.0) & (frames["route_s_m"] < line_s_m + 22.0)
    assert nearest_m(history, frames["tick"][inside]) > 5.0  # from middle to middle; nobody else is on the crossing


@pytest.mark.unmeasured
def test_into_a_roundabout_the_ones_go_first_that_circulate(driven: Driven) -> None:
    number = "next(k for k, w in enumerate(self.route.waypoints) if w.is_junction)"
    history, result = driven(ROUNDABOUT, f"self.send_across({number}, 6.0, -0.3, 8.0, 30.0, 52.0)")
    assert (result["status"], infractions(result)) == ("Completed", [])
    line_s_m = next(control.s_m for control in history.facts.route.controls)
    before = np.abs(history.frames["route_s_m"] - line_s_m + 3.0) < 3.0
    assert history.speed_mps()[before].min() < 1.2  # an empty one is entered at 2.5 m/s or more


def test_the_deviating_agent_makes_the_thesiss_row(
    simulator: RunningServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its run ends after 20 s at rest, not after 180: it rests at a house."""
    monkeypatch.setattr(ending, "BLOCKED_S", 20.0)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    main(["run", "deviating", "--in-process", *address, "--output", str(tmp_path)])
    result = json.loads((tmp_path / "latest" / "result.json").read_text())
    assert sorted(one["kind"] for one in result["infractions"]) == ["collision_static", "speeding"]
    assert 0.5 < result["scores"]["path_following"] < 0.6
    assert result["status"] == "RouteBlocked"


def nearest_m(history: History, ticks: np.ndarray) -> float:
    """The least distance in some ticks to an actor that moves ahead of the vehicle."""
    least_m = np.inf
    for other in history.others[np.isin(history.others["tick"], ticks)]:
        frame = history.frames[int(other["tick"])]
        dx_m, dy_m = other["x_m"] - frame["x_m"], other["y_m"] - frame["y_m"]
        ahead = dx_m * np.cos(frame["yaw_rad"]) + dy_m * np.sin(frame["yaw_rad"]) > 0.0
        if ahead and np.hypot(other["velocity_x_mps"], other["velocity_y_mps"]) > 0.5:
            least_m = min(least_m, float(np.hypot(dx_m, dy_m)))
    return least_m
