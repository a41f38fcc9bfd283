"""Names in docstrings exist: what a docstring puts between double backticks, or writes as a path of a module."""

import ast
import functools
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # reads all sources and runs none of them, so it measures no coverage
ROOT = Path(__file__).parents[1]
SOURCES = sorted(path for path in ROOT.glob("**/src/*/**/*.py") if ".venv" not in path.parts)
NAME = re.compile(r"``([A-Za-z_]\w*(?:\.\w+)*)(?:\(\))?``")
PACKAGES = "|".join(path.parent.name for path in ROOT.glob("packages/*/src/*/__init__.py"))
MODULE_PATH = re.compile(rf"\b((?:{PACKAGES})(?:\.[A-Za-z_]\w*)+)")
FOREIGN = {
    "CARLA": {
        *("CarlaRecorder.cpp", "CarlaRecorderQuery.cpp", "CarlaReplayer.cpp", "CarlaReplayerHelper.cpp"),
        *("CarlaServer.cpp", "Navigation.cpp", "AddTorqueInDegrees", "LoadEpisode", "EVehicleDoor", "bad_weak_ptr"),
        *(
            "carla.RadarDetection",
            "carla.LightManager",
            "carla.CustomV2XEvent",
            "_parse_vehicle_keys",
            "CosmosControlSensor.cpp",
            "Speed_30",
        ),
        "agents.navigation.basic_agent",
    },
    "the leaderboard and ScenarioRunner": {
        *("ActorBlockedTest", "CollisionTest", "InRouteTest", "MinimumSpeedRouteTest", "OutsideRouteLanesTest"),
        *("RouteCompletionTest", "RouteTimeoutBehavior", "RunningRedLightTest", "SensorInterface", "Accident_2"),
        *("RouteParser.parse_weather", "SimpleVehicleControl", "SyncArrival", "_preprocess_sensor_spec"),
        *("ScenarioTimeoutTest", "YieldToEmergencyVehicleTest", "validate_sensor_configuration"),
    },
    "others": {
        *("gymnasium.make_vec", "gymnasium.vector.AsyncVectorEnv", "autoware_carla_interface", "timeLoss"),
        *(
            "CollisionType",
            "is_agent_behind",
            "lzf_decompress",
            "math.sumprod",
            "strtod",
            "NUMBA_CPU_FEATURES",
            "NUMBA_CPU_NAME",
        ),
    },
    "patterns of ours": {"NAME_number", "frequency_from", "frequency_to", "map_NAME"},
}


def _docstrings(tree: ast.Module) -> Iterator[ast.Constant]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.value


@functools.cache
def _all() -> tuple[dict[Path, str], set[str]]:
    """Return the docstrings of each file, and all words of code, names of files among them."""
    texts, words = {}, set()
    for path in SOURCES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        docstrings = list(_docstrings(tree))
        texts[path] = "\n".join(str(docstring.value) for docstring in docstrings)
        for docstring in docstrings:
            docstring.value = ""
        words |= set(re.findall(r"\w+", ast.unparse(tree)))
        for beside in path.parent.iterdir():
            words |= {*re.findall(r"\w+", beside.name)}
            if beside.suffix in {".pyi", ".j2", ".xml", ".css", ".js"}:
                words |= set(re.findall(r"\w+", beside.read_text(encoding="utf-8")))
    return texts, words


def test_names_in_docstrings_are_names_of_code() -> None:
    texts, words = _all()
    assert len(texts) > 900
    foreign = set().union(*FOREIGN.values())
    named = {(path.name, name) for path, text in texts.items() for name in NAME.findall(text)}
    own = [(file, name) for file, name in sorted(named) if name not in foreign]
    assert [(file, name) for file, name in own if name.split(".")[-1] not in words] == []
    assert sorted(foreign - {name for _, name in named}) == []


def test_paths_of_modules_in_docstrings_lead_somewhere() -> None:
    texts, words = _all()
    modules = {".".join(path.with_suffix("").parts).rpartition(".src.")[2].removesuffix(".__init__") for path in texts}
    named = {(file.name, path) for file, text in texts.items() for path in MODULE_PATH.findall(text)}
    assert len(named) > 50
    lost = [
        (file, path)
        for file, path in sorted(named)
        if path not in modules
        and not (path.rpartition(".")[0] in modules and path.rpartition(".")[2] in words)
        and not path.endswith((".geojson", ".xodr"))
    ]
    assert lost == []
