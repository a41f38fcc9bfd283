"""Claims about the leaderboard's two infractions of scenarios, by drivers on a street with a real simulator.

Each driver that gains by breaking the rule loses: the one that goes on, the one that stops in its lane, the one that
dodges into the lane of oncoming traffic, and the one that waits until a scenario has cleared its obstacle away.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from servers import RunningServer

DRIVERS = '''
import math
import carla
import numpy as np

class Driver(AutonomousAgent):
    """Goes along its route at 6 m/s, ``offset_m`` to the right of it while an emergency vehicle is behind."""

    offset_m, slow_mps, waits_s = 0.0, 6.0, 0.0

    def config(self):
        return {}

    def setup(self):
        self.points, self.right_m, self.stood_s = np.asarray(self.route.points_m), 0.0, 0.0

    def has_one_behind(self, pose):
        ahead = pose.get_forward_vector()
        for other in self.world.get_actors().filter("vehicle.*"):
            if other.attributes.get("special_type") == "emergency":
                apart = other.get_location() - pose.location
                return -60.0 < apart.x * ahead.x + apart.y * ahead.y < 4.0
        return False

    def run_step(self, sensor_data):
        pose, velocity = self.vehicle.get_transform(), self.vehicle.get_velocity()
        speed_mps, here_m = math.hypot(velocity.x, velocity.y), np.array([pose.location.x, pose.location.y])
        index = int(np.argmin(np.hypot(*(self.points[:, :2] - here_m).T)))
        yields = self.has_one_behind(pose)
        self.right_m += float(np.clip((self.offset_m if yields else 0.0) - self.right_m, -0.03, 0.03))
        target = min(index + 6, len(self.points) - 1)
        yaw_rad = float(self.route.yaw_rad[target])
        goal_m = self.points[target, :2] + self.right_m * np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
        to_goal_rad = math.atan2(*(goal_m - here_m)[::-1]) - math.radians(pose.rotation.yaw)
        moved = abs(self.right_m) >= 0.5 * abs(self.offset_m)
        wanted_mps = self.slow_mps if yields and moved else 6.0
        wanted_mps = min(wanted_mps, math.sqrt(max(0.0, 1.6 * float(self.route.length_m - self.route.s_m[index]))))
        if self.waits_s and index > 24 and self.stood_s < self.waits_s:
            wanted_mps, self.stood_s = 0.0, self.stood_s + self.time_step_s
        error_mps = wanted_mps - speed_mps
        return carla.VehicleControl(
            throttle=float(np.clip(0.5 * error_mps, 0.0, 0.7)),
            brake=float(np.clip(-0.4 * error_mps, 0.0, 0.6)),
            steer=float(np.clip(1.2 * math.remainder(to_goal_rad, math.tau), -1.0, 1.0)),
        )

class PullsOver(Driver):
    offset_m, slow_mps = 1.0, 1.0

class GoesOn(Driver):
    pass

class StopsInItsLane(Driver):
    slow_mps = 0.0

class DodgesLeft(Driver):
    offset_m, slow_mps = -4.5, 1.0

class WaitsForTheEnd(Driver):
    waits_s = 75.0
'''
ROUTE = """<routes><route id="0" town="Linden"><waypoints>
<position x="473.087" y="-81.993" z="249.185"/><position x="498.376" y="-104.608" z="249.401"/>
<position x="519.730" y="-131.561" z="249.649"/><position x="539.484" y="-157.908" z="249.895"/>
<position x="551.000" y="-186.600" z="250.140"/>
</waypoints><scenarios>{scenario}</scenarios></route></routes>"""
AMBULANCE = """<scenario name="met" type="YieldToEmergencyVehicle">
<trigger_point x="508.8" y="-117" z="249.5" yaw="307"/><behind value="25"/></scenario>"""
OBSTACLE = """<scenario name="met" type="StaticObject">
<trigger_point x="486.0" y="-93.5" z="249.3" yaw="318"/></scenario>"""


@pytest.fixture
def driven(simulator: RunningServer, tmp_path: Path) -> Any:
    """Drives the street with one of the drivers and a scenario on the way, and returns the result."""

    def drive(driver: str, scenario: str) -> dict[str, Any]:
        agents, routes = tmp_path / "drivers.py", tmp_path / "street.xml"
        agents.write_text(DRIVERS)
        routes.write_text(ROUTE.replace("{scenario}", scenario))
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        main(["run", f"{agents}:{driver}", *address, "--routes", str(routes), "--output", str(tmp_path / "runs")])
        result: dict[str, Any] = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
        assert result["status"] == "Completed", result["message"]
        return result

    return drive


def kinds(result: dict[str, Any], version: str = "2.0") -> list[str]:
    return [event["kind"] for event in result["leaderboard"][version]["events"]]


def test_a_driver_that_pulls_over_lets_the_ambulance_by(driven: Any) -> None:
    result = driven("PullsOver", AMBULANCE)
    assert kinds(result) == []
    assert result["scenarios"][0]["verdict"] == "SUCCESS"
    assert result["leaderboard"]["2.0"]["not_measured"] == []


@pytest.mark.parametrize("driver", ["GoesOn", "StopsInItsLane"])
def test_a_driver_that_keeps_the_ambulance_behind_it_pays_for_it(driven: Any, driver: str) -> None:
    result = driven(driver, AMBULANCE)
    assert kinds(result) == ["yield_emergency_vehicle_infractions"]
    assert result["leaderboard"]["2.0"]["infraction_penalty"] == pytest.approx(0.7)
    assert result["leaderboard"]["2.1"]["infraction_penalty"] == pytest.approx(1.0 / 1.4)
    assert kinds(result, "1.0") == []
    assert result["passed"] is False


def test_a_driver_that_dodges_to_the_left_pays_for_the_lane(driven: Any) -> None:
    result = driven("DodgesLeft", AMBULANCE)
    assert "outside_route_lanes" in kinds(result) or "yield_emergency_vehicle_infractions" in kinds(result)
    assert result["leaderboard"]["2.0"]["infraction_penalty"] < 1.0
    assert result["passed"] is False


def test_a_driver_that_waits_until_the_obstacle_is_cleared_away_pays_for_the_timeout(driven: Any) -> None:
    result = driven("WaitsForTheEnd", OBSTACLE)
    assert kinds(result) == ["scenario_timeouts"]
    assert result["scenarios"][0]["timed_out"] is True
    assert result["passed"] is False
