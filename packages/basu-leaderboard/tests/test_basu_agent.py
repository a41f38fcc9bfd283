"""Claims about the file that the leaderboard and ScenarioRunner load: found as they do, called as they do."""

import importlib.util
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

import basu_leaderboard
from basu.errors import UserError
from basu_leaderboard import replacement_modules
from basu_leaderboard.global_plan import Gps, global_plan
from basu_leaderboard.provided.carla_data_provider import CarlaDataProvider
from fakes.one_road import one_road, way_along

ENTRY = Path(basu_leaderboard.__file__).parent / "entry" / "basu_agent.py"
AGENT = """
class Mine(AutonomousAgent):
    def setup(self):
        self.ended = False

    def run_step(self, sensor_data):
        self.seen = sensor_data
        return carla.VehicleControl(throttle=0.25)

    def sensors(self):
        return [{"type": "sensor.other.gnss", "id": "GPS"}, {"type": "sensor.other.collision", "id": "BUMP"}]

    def config(self):
        return {}

    def destroy(self):
        self.ended = True
"""
TOWN = one_road()


class World:
    def get_map(self) -> carla.Map:
        return TOWN

    def get_settings(self) -> Any:
        return SimpleNamespace(fixed_delta_seconds=0.05)


@pytest.fixture(autouse=True)
def host() -> Iterator[None]:
    """A host that has a world with a hero in it."""
    replacement_modules.install()
    CarlaDataProvider.set_world(World())
    CarlaDataProvider.register_actor(SimpleNamespace(id=7, attributes={"role_name": "hero"}))
    yield
    CarlaDataProvider.cleanup()


def loaded(base: str) -> Any:
    """The file, run after its host has loaded its own base class."""
    importlib.import_module(base)
    spec = importlib.util.spec_from_file_location("basu_agent", ENTRY)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def config(folder: Path, **entries: str) -> str:
    (folder / "mine.py").write_text(AGENT)
    path = folder / "basu_agent.json"
    path.write_text(json.dumps({"agent": str(folder / "mine.py"), **entries}))
    return str(path)


def plan() -> Any:
    return global_plan(way_along(TOWN), Gps(TOWN))


def test_the_leaderboard_finds_the_class_and_its_track(tmp_path: Path) -> None:
    module = loaded("leaderboard.autoagents.autonomous_agent")
    agent = getattr(module, module.get_entry_point())("localhost", 4711, 0)
    agent.set_global_plan(*plan())
    agent.setup(config(tmp_path, track="MAP"))
    assert agent.track.value == "MAP"
    assert [sensor["id"] for sensor in agent.sensors()] == ["GPS"]
    control = agent.run_step({"GPS": (9, np.array([39.9, -82.9, 1.0]))}, 0.05)
    inside = agent._exported._agent
    assert control.throttle == pytest.approx(0.25)
    assert inside.server_address == ("localhost", 4711)
    assert (inside.seen["GPS"][0], inside.seen["GPS"][1].latitude) == (9, 39.9)
    assert inside.route.length_m == pytest.approx(40.0, abs=0.5)
    assert inside.vehicle.id == 7
    agent.destroy()
    assert inside.ended


def test_scenario_runner_finds_the_class_by_the_files_name(tmp_path: Path) -> None:
    module = loaded("srunner.autoagents.autonomous_agent")
    agent = getattr(module, ENTRY.stem.title().replace("_", ""))(config(tmp_path))
    agent.set_global_plan(*plan())
    assert agent.run_step({}, 0.05).throttle == pytest.approx(0.25)
    assert len(agent._global_plan) < len(agent._plan)  # the host's base class thins its own


def test_basus_own_agents_are_exported_by_name() -> None:
    module = loaded("srunner.autoagents.autonomous_agent")
    assert [sensor["type"] for sensor in module.BasuAgent("").sensors()] == ["sensor.other.gnss", "sensor.other.imu"]


def test_an_agent_that_was_never_bound_is_not_ended(tmp_path: Path) -> None:
    agent = loaded("srunner.autoagents.autonomous_agent").BasuAgent(config(tmp_path))
    agent.destroy()
    assert not hasattr(agent._exported._agent, "ended")


def test_a_host_without_a_plan_or_a_hero_gets_a_sentence(tmp_path: Path) -> None:
    agent = loaded("srunner.autoagents.autonomous_agent").BasuAgent(config(tmp_path))
    with pytest.raises(UserError, match="the host gave no plan"):
        agent.run_step({}, 0.05)
    CarlaDataProvider.cleanup()
    CarlaDataProvider.set_world(World())
    with pytest.raises(UserError, match="no vehicle with the role 'hero'"):
        agent.run_step({}, 0.05)


def test_an_agent_of_the_leaderboard_is_no_exported(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "from leaderboard.autoagents.autonomous_agent import AutonomousAgent\n"
        "def get_entry_point(): return 'Mine'\nclass Mine(AutonomousAgent): pass\n"
    )
    (tmp_path / "basu_agent.json").write_text(json.dumps({"agent": str(tmp_path / "mine.py")}))
    with pytest.raises(UserError, match="is one of the leaderboard's already; give it as --agent"):
        loaded("srunner.autoagents.autonomous_agent").BasuAgent(str(tmp_path / "basu_agent.json"))


def test_python_tells_where_the_file_is() -> None:
    told = subprocess.run([sys.executable, "-m", "basu_leaderboard"], capture_output=True, text=True, check=True).stdout
    assert Path(told.strip()) == ENTRY
