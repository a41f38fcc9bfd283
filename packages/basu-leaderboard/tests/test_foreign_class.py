"""Claims about finding an agent of the leaderboard or of ScenarioRunner, and a sentence for every way it is none."""

from pathlib import Path
from typing import Any

import pytest

from basu.agents.loader import LoadedAgent, load_agent
from basu.errors import UserError
from basu_leaderboard.adapted_agent import LeaderboardAgent
from basu_leaderboard.foreign_class import Dialect

OURS = "from leaderboard.autoagents.autonomous_agent import AutonomousAgent\n"
SCENARIO_RUNNER = "from srunner.autoagents.autonomous_agent import AutonomousAgent\n"
ENTRY = "def get_entry_point(): return 'Mine'\n"
BARE = """
class Mine:
    def __init__(self, {init}): pass
    def setup(self, path_to_conf_file): pass
    def sensors(self): return []
    def run_step(self, input_data, timestamp): return None
    def set_global_plan(self, global_plan_gps, global_plan_world_coord): pass
    def destroy(self): pass
"""


def loaded(folder: Path, text: str, class_name: str = "", agent_config: str | None = None) -> LoadedAgent:
    path = folder / "an_agent.py"
    path.write_text(text)
    return load_agent(f"{path}:{class_name}" if class_name else str(path), agent_config)


def dialect(agent: LoadedAgent) -> Dialect:
    assert issubclass(agent.agent_class, LeaderboardAgent)
    return agent.agent_class.foreign.dialect


def test_the_entry_point_names_the_class(tmp_path: Path) -> None:
    agent = loaded(tmp_path, OURS + ENTRY + "class Other(AutonomousAgent): pass\nclass Mine(AutonomousAgent): pass\n")
    assert agent.agent_class.__name__ == "Mine"
    assert (agent.name, dialect(agent)) == ("an_agent", Dialect.LEADERBOARD_2)


@pytest.mark.parametrize(
    ("init", "wanted"),
    [
        ("carla_host, carla_port, debug=False", Dialect.LEADERBOARD_2),
        ("*arguments", Dialect.LEADERBOARD_2),
        ("path_to_conf_file", Dialect.LEADERBOARD_1),
        ("path_to_conf_file, seed=0", Dialect.LEADERBOARD_1),
    ],
)
def test_what_an_agent_is_made_with_tells_its_leaderboard(tmp_path: Path, init: str, wanted: Dialect) -> None:
    assert dialect(loaded(tmp_path, ENTRY + BARE.format(init=init))) is wanted


def test_scenario_runners_agents_have_no_entry_point(tmp_path: Path) -> None:
    agent = loaded(tmp_path, SCENARIO_RUNNER + "class Mine(AutonomousAgent): pass\n")
    assert dialect(agent) is Dialect.SCENARIO_RUNNER


def test_one_of_several_is_named_behind_a_colon(tmp_path: Path) -> None:
    text = SCENARIO_RUNNER + "class First(AutonomousAgent): pass\nclass Second(AutonomousAgent): pass\n"
    assert loaded(tmp_path, text, "Second").agent_class.__name__ == "Second"
    with pytest.raises(UserError, match=r"holds 2 agents \(First, Second\); name one as .*:First"):
        loaded(tmp_path, text)


def test_the_config_is_handed_on_as_it_was_typed(tmp_path: Path) -> None:
    agent = loaded(tmp_path, OURS + ENTRY + "class Mine(AutonomousAgent): pass\n", agent_config="net.py+net.pth")
    assert agent.agent_class.conf_file == "net.py+net.pth"  # type: ignore[attr-defined]


def test_basus_own_agents_take_no_config() -> None:
    with pytest.raises(UserError, match="'basic' takes no --agent-config"):
        load_agent("basic", "file.json")


def test_a_module_of_the_leaderboard_that_is_missing_is_named_with_its_folder(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"line 1: ModuleNotFoundError: .*put the folder PythonAPI/carla"):
        loaded(tmp_path, "from agents.navigation.basic_agent import BasicAgent\n" + ENTRY)


def replaced(line: str, by: str) -> str:
    text = ENTRY + BARE.format(init="*arguments")
    assert line in text
    return text.replace(line, by)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param("get_entry_point = 'Mine'\n", "get_entry_point is no function", id="no function"),
        pytest.param("def get_entry_point(): return 1/0\n", r"raised ZeroDivisionError", id="raises"),
        pytest.param("def get_entry_point(): raise SystemExit(3)\n", r"raised SystemExit: 3", id="exits"),
        pytest.param("def get_entry_point(): pass\n", "returned NoneType; it must return the name", id="returns None"),
        pytest.param("def get_entry_point(): return 3\n", "returned int", id="returns a number"),
        pytest.param(ENTRY, "names 'Mine', and the file has no class of that name", id="no class"),
        pytest.param(ENTRY + "Mine = 3\n", "has no class of that name", id="no type"),
        pytest.param(ENTRY + "class Mine: pass\n", "Mine in .* lacks setup; an agent of the lead", id="empty class"),
        pytest.param(replaced("    def destroy(self): pass\n", ""), "lacks destroy", id="no destroy"),
        pytest.param(
            replaced("def run_step(self, input_data, timestamp)", "def run_step(self, input_data)"),
            "run_step of Mine in .* cannot be called as the leaderboard does: too many positional",
            id="no timestamp",
        ),
        pytest.param(
            replaced("def sensors(self)", "def sensors(self, world)"),
            "sensors of Mine .* missing a required argument: 'world'",
            id="wants a world",
        ),
        pytest.param(
            replaced("    def destroy", "    @staticmethod\n    def get_ros_version(): return 2\n    def destroy"),
            "is an agent for ROS 2, which the leaderboard",
            id="ros",
        ),
        pytest.param(
            replaced("    def destroy", "    @staticmethod\n    def get_ros_version(): return {}[0]\n    def destroy"),
            "get_ros_version of Mine in .* raised KeyError",
            id="ros raises",
        ),
    ],
)
def test_an_agent_that_is_none_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        loaded(tmp_path, text)


def test_basus_agents_in_a_file_are_found_as_ever(tmp_path: Path) -> None:
    text = (
        "class A(AutonomousAgent):\n  def setup(self): pass\n  def run_step(self, s): pass\n  def config(self): pass\n"
    )
    agent: Any = loaded(tmp_path, text).agent_class
    assert not issubclass(agent, LeaderboardAgent)
