"""Claims about whole runs with a window and a person, in a live simulator: SDL's dummy driver replaces the display."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pygame
import pytest

from basu.cli import main
from basu.errors import UserError
from basu.records.history import History
from basu.records.history.files import read_history
from servers import RunningServer

MEETER = """
class Meeter(AutonomousAgent):
    def setup(self):
        blueprint = self.world.get_blueprint_library().find("vehicle.audi.a2")
        pose = self.route.waypoints[12].transform
        pose.location.z += 0.3
        self.parked = self.world.spawn_actor(blueprint, pose)
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 90:
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.7)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3", "sensors": "config/sensors.json"}

    def destroy(self):
        self.parked.destroy()
"""
STRIKER = """
import pygame
from basu.agents.builtin.{module} import {base}

KEYS = {keys!r}

class Striker({base}):
    steps = 0

    def run_step(self, sensor_data):
        for kind, key in KEYS.get(self.steps, ()) if pygame.display.get_init() else ():
            pygame.event.post(pygame.event.Event(getattr(pygame, kind), key=getattr(pygame, "K_" + key)))
        self.steps += 1
        if self.steps > {end}:
            raise ValueError("enough")
        return super().run_step(sensor_data)

    def config(self):
        return {{"vehicle": "vehicle.tesla.model3"}}
"""
Runner = Callable[..., tuple[int, dict[str, Any], History]]
DOWN, UP = "KEYDOWN", "KEYUP"


@pytest.fixture
def run(simulator: RunningServer, tmp_path: Path, route_file: Path, monkeypatch: pytest.MonkeyPatch) -> Runner:
    """``basu run`` in this process, at the shared simulator: exit code, result and record."""
    pygame.display.quit()
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")

    def at(agent: object, *options: str) -> tuple[int, dict[str, Any], History]:
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        output = tmp_path / "runs"
        # a striker posts events to this process's window; only there it can
        words = [*address, "--routes", str(route_file), "--output", str(output), "--in-process", *options]
        code = main(["run", str(agent), *words])
        folder = output / "latest"
        return code, json.loads((folder / "result.json").read_text()), read_history(folder)

    return at


def striker(folder: Path, keys: dict[int, list[tuple[str, str]]], *, end: int, human: bool) -> Path:
    """An agent that strikes the window's keys at its steps."""
    module, base = ("basic", "HumanAgent") if human else ("baselines", "ForwardAgent")
    path = folder / "striker.py"
    path.write_text(STRIKER.format(keys=keys, end=end, module=module, base=base))
    return path


@pytest.mark.slow
def test_a_run_is_the_same_with_and_without_the_window(run: Runner, tmp_path: Path) -> None:
    path = tmp_path / "meeter.py"
    path.write_text(MEETER)
    _, _, without = run(path)
    _, result, with_camera = run(path, "--hud", "--hud-screenshot", str(tmp_path / "hud.png"))
    assert result["infractions"], "there is something to be told"
    assert with_camera.frames.tobytes() == without.frames.tobytes()
    for name in ("tick", "x_m", "y_m", "z_m", "yaw_rad", "velocity_x_mps", "velocity_y_mps"):
        assert np.array_equal(with_camera.others[name], without.others[name])  # ids go on counting in one server
    assert [event.tick for event in with_camera.collisions] == [event.tick for event in without.collisions]
    picture = pygame.image.load(str(tmp_path / "hud.png"))
    assert picture.get_size() == (960, 540)
    colours = {tuple(picture.get_at((x, y)))[:3] for x in range(270, 960, 15) for y in range(10, 540, 15)}
    assert len(colours) > 100, "a street looks like more than a map"


def test_p_takes_over_from_any_agent_and_gives_back(run: Runner, tmp_path: Path) -> None:
    keys = {9: [(DOWN, "s")], 10: [(DOWN, "p")], 19: [(UP, "s")], 20: [(DOWN, "p")]}
    _, result, history = run(striker(tmp_path, keys, end=30, human=False), "--hud", "map")
    manual = history.frames["manual"]
    assert np.flatnonzero(manual).tolist() == list(range(10, 20))
    assert (history.frames["applied_throttle"][10:19] == 0.0).all()
    assert history.frames["applied_brake"][12] > 0.5
    assert history.frames["applied_throttle"][25] == pytest.approx(0.9)
    assert result["disengagements"]["number"] == 1


def test_escape_ends_the_run_and_all_is_written(run: Runner, tmp_path: Path) -> None:
    keys = {5: [(DOWN, "h")], 8: [(DOWN, "F12")], 9: [(DOWN, "ESCAPE")]}
    shot = tmp_path / "help.png"
    code, result, history = run(
        striker(tmp_path, keys, end=30, human=False), "--hud", "map", "--hud-screenshot", str(shot)
    )
    assert (code, result["status"]) == (130, "Interrupted")
    assert len(history.frames) == 10
    assert shot.read_bytes().startswith(b"\x89PNG")


def test_n_shows_the_agents_sensors_and_tab_the_map(run: Runner, tmp_path: Path) -> None:
    sensors = tmp_path / "sensors.json"
    sensors.write_text(
        json.dumps(
            [
                {"type": "sensor.lidar.ray_cast", "id": "TOP", "z": 2.0, "points_per_second": 100000, "channels": 16},
                {"type": "sensor.other.gnss", "id": "GPS"},
            ]
        )
    )
    shots: dict[str, bytes] = {}
    for name, strikes in (("map", 0), ("lidar", 1), ("gnss", 2), ("map again", 3)):
        shot = tmp_path / f"{name}.png"
        keys = {5: [(DOWN, "n")] * strikes, 12: [(DOWN, "F12")], 13: [(DOWN, "ESCAPE")]}
        agent = striker(tmp_path, keys, end=20, human=False)
        agent.write_text(
            agent.read_text().replace(
                '"vehicle.tesla.model3"}', f'"vehicle.tesla.model3", "sensors": {str(sensors)!r}}}'
            )
        )
        run(agent, "--hud", "map", "--hud-screenshot", str(shot))
        window = pygame.image.load(str(shot))
        shots[name] = pygame.image.tobytes(window.subsurface((260, 40, 690, 400)), "RGB")
    assert len({shots["map"], shots["lidar"], shots["gnss"]}) == 3
    assert shots["map again"] == shots["map"]


def test_what_a_person_drives_can_be_recorded_and_played(run: Runner, tmp_path: Path) -> None:
    keys = {1: [(DOWN, "w")], 10: [(DOWN, "a")], 16: [(UP, "a")], 24: [(UP, "w"), (DOWN, "SPACE")], 28: [(UP, "SPACE")]}
    agent = striker(tmp_path, {**keys, 30: [(DOWN, "p")]}, end=34, human=True)
    session = tmp_path / "session.json"
    _, driven, live = run(agent, "--hud", "map", "--record-keys", str(session))
    _, _, played = run(agent, "--keys", str(session))
    assert live.frames.tobytes() == played.frames.tobytes()
    assert live.frames["manual"].tolist() == [1] * 30 + [0] * 5
    assert live.frames["applied_hand_brake"][24:28].all()
    assert live.frames["applied_steer"].min() == pytest.approx(-0.15)
    assert driven["meta"]["wall_s"] > 1.3, "with a person, time passes as it does"


def test_keys_of_another_route_are_refused(run: Runner, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UserError):  # nothing was driven, so there is no record
        run("human", "--keys", "data/human_session.json")
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert result["status"] == "SetupFailed"
    assert "recorded with route 1, and this run has piece" in result["message"]
    assert main(["run", "human", "--keys", "nowhere.json"]) == 2
    assert "session of keys 'nowhere.json' was not found" in capsys.readouterr().err


@pytest.mark.slow
def test_the_session_of_the_experiment_arrives_and_is_three_times_too_fast(
    simulator: RunningServer, tmp_path: Path
) -> None:
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    assert (
        main(["run", "human", "--in-process", *address, "--keys", "data/human_session.json", "--output", str(tmp_path)])
        == 0
    )
    result = json.loads((tmp_path / "latest" / "result.json").read_text())
    assert [found["kind"] for found in result["infractions"]] == ["speeding"] * 3
    assert result["scores"]["path_following"] >= 0.98
    assert result["scores"]["infraction"] == pytest.approx(0.512)
    assert result["disengagements"]["number"] == 0
