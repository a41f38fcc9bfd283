"""Claims about ScenarioRunner beside BASU: its classes on ``linden serve``, its files with BASU's classes.

ScenarioRunner is no part of this project. Tests that run it need SCENARIO_RUNNER_ROOT, its folder, and
SCENARIO_RUNNER_PYTHON, an interpreter with what it requires and CARLA's ``agents`` on its path; without, they are
skipped. Which calls of the simulator its classes make is tested without it in ``tests/compat/test_scenario_calls.py``.
"""

import ast
import json
import math
import os
import re
import subprocess
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeGuard

import carla
import pytest

from basu.episode.spec import description_of
from basu.managers.placed_scenario import place_scenario
from basu.routing import plan
from basu.scenarios.cases import by_id, cases_of
from servers import RunningServer

PROJECT = Path(__file__).parents[4]
EXAMPLES = PROJECT / "examples" / "scenario_runner"
SPOTS = EXAMPLES / "linden.xml"
OWN_CLASSES, OWN_CASES = EXAMPLES / "linden_scenarios.py", EXAMPLES / "linden_scenarios.xml"
ALONG_RAD = math.radians(30.0)
ROOT, PYTHON = os.environ.get("SCENARIO_RUNNER_ROOT"), os.environ.get("SCENARIO_RUNNER_PYTHON")
needs_scenario_runner = pytest.mark.skipif(
    not (ROOT and PYTHON), reason="ScenarioRunner is not here: set SCENARIO_RUNNER_ROOT and SCENARIO_RUNNER_PYTHON"
)
PASSED_BY_THE_AUTOPILOT = (
    ("LindenFollowLeadingVehicle_1", SPOTS, "Straight"),
    ("LindenDynamicObjectCrossing_1", SPOTS, "Straight"),
    ("LindenOppositeVehicleRunningRedLight_1", SPOTS, "Straight"),
    ("LindenUnsignalizedIntersection_1", OWN_CASES, "Straight"),
    ("LindenRoundabout_1", OWN_CASES, "Right"),
)


@pytest.fixture(scope="module")
def town() -> carla.Map:
    text = (PROJECT / "packages" / "linden" / "src" / "linden" / "data" / "Linden.xodr").read_text(encoding="utf-8")
    return carla.Map("Linden", text)


@pytest.mark.parametrize(("file", "at_least"), [(SPOTS, 25), (OWN_CASES, 4)])
def test_every_hero_of_the_example_stands_in_a_lane_and_looks_along_it(
    town: carla.Map, file: Path, at_least: int
) -> None:
    scenarios = list(ET.parse(file).getroot().iter("scenario"))
    names = [scenario.get("name") for scenario in scenarios]
    assert len(set(names)) == len(names) >= at_least
    for scenario in scenarios:
        assert scenario.get("town") == "Linden"
        (hero,) = scenario.findall("ego_vehicle")
        x_m, y_m, z_m, yaw_deg = (float(hero.get(name, "nan")) for name in ("x", "y", "z", "yaw"))
        lane = town.get_waypoint(carla.Location(x_m, y_m, z_m)).transform
        assert math.hypot(lane.location.x - x_m, lane.location.y - y_m) < 0.5, scenario.get("name")
        turned_rad = math.remainder(math.radians(lane.rotation.yaw - yaw_deg), math.tau)
        assert abs(turned_rad) < ALONG_RAD, scenario.get("name")


PLACES = ("other_actor", "meeting", "leaves", "source", "sink", "exit")


def test_every_place_of_our_own_cases_lies_in_a_lane_and_is_read_by_its_class(town: carla.Map) -> None:
    classes = {node.name: node for node in ast.parse(OWN_CLASSES.read_text(encoding="utf-8")).body if is_class(node)}
    for scenario in ET.parse(OWN_CASES).getroot().iter("scenario"):
        text = ast.unparse(classes[str(scenario.get("type"))])
        given = [element for element in scenario if element.tag in PLACES]
        for element in given:
            x_m, y_m, z_m = (float(element.get(name, "nan")) for name in "xyz")
            lane = town.get_waypoint(carla.Location(x_m, y_m, z_m)).transform.location
            assert math.hypot(lane.x - x_m, lane.y - y_m) < 1.0, (scenario.get("name"), element.tag)
            assert element.tag == "other_actor" or repr(element.tag) in text
        read = set(re.findall(r"(?:location|hero_within)\((?:[^()]*, )*'(\w+)'\)", text)) | set(
            re.findall(r"hero_within\(.*?, '(\w+)'\)", text)
        )
        assert read <= {element.tag for element in given}
        numbers = {element.tag for element in scenario if element.get("value") is not None}
        assert numbers <= set(re.findall(r"self\.value\('(\w+)'", text))


def is_class(node: ast.AST) -> TypeGuard[ast.ClassDef]:
    return isinstance(node, ast.ClassDef)


@pytest.mark.parametrize("name", ["LindenFollowLeadingVehicle_1", "LindenOppositeVehicleRunningRedLight_1"])
def test_an_element_in_its_format_is_a_case_of_ours(name: str, town: carla.Map) -> None:
    playable = by_id(name, [SPOTS])
    assert playable.case.type == playable.scenario.__name__ or playable.case.type in playable.scenario.aliases
    route = plan(town, description_of(playable, town))
    laid = place_scenario(playable, route, town, own=True)
    assert laid.scenario.place.trigger_s_m == pytest.approx(0.0, abs=1.0)


@needs_scenario_runner
def test_a_file_of_its_own_is_read_unchanged() -> None:
    file = Path(str(ROOT)) / "srunner" / "examples" / "FollowLeadingVehicle.xml"
    theirs = list(ET.parse(file).getroot().iter("scenario"))
    read = cases_of([str(file)])
    assert [playable.case.name for playable in read] == [scenario.get("name") for scenario in theirs]
    assert {playable.scenario.__name__ for playable in read} == {scenario.get("type") for scenario in theirs}


@contextmanager
def autopilot(port: int, tm_port: int, way: str) -> Iterator[None]:
    """The Traffic Manager drives the hero."""
    words = [str(PYTHON), str(EXAMPLES / "autopilot_hero.py"), "--port", str(port), "--tm-port", str(tm_port)]
    words += ["--way", way]
    driver = subprocess.Popen(words)
    try:
        yield
    finally:
        driver.terminate()
        driver.wait()


@pytest.mark.slow
@needs_scenario_runner
@pytest.mark.parametrize(("name", "file", "way"), PASSED_BY_THE_AUTOPILOT)
def test_its_classes_and_ours_are_played_to_a_verdict(
    name: str, file: Path, way: str, simulator: RunningServer, tmp_path: Path
) -> None:
    tm_port = free_port()
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    words = [
        *(str(PYTHON), "scenario_runner.py", "--sync", "--timeout", "60", "--json", "--outputDir", str(tmp_path)),
        *("--port", str(simulator.port), "--trafficManagerPort", str(tm_port)),
        *("--configFile", str(file), "--scenario", name),
        *(("--additionalScenario", str(OWN_CLASSES)) if file == OWN_CASES else ()),
    ]
    with autopilot(simulator.port, tm_port, way):
        process = subprocess.Popen(words, cwd=ROOT, env={**os.environ, "PYTHONPATH": path})
        try:
            result = written(tmp_path, process)
        finally:
            process.terminate()
            process.wait()
    document = json.loads(result.read_text(encoding="utf-8"))
    assert document["success"], document
    assert document["criteria"], document


def written(folder: Path, process: subprocess.Popen[bytes], limit_s: float = 300.0) -> Path:
    """The result, once it is there; ScenarioRunner may stay alive after a failure."""
    until_s = time.monotonic() + limit_s
    while time.monotonic() < until_s:
        code = process.poll()
        found = list(folder.glob("*.json"))
        if found and code is not None:
            return found[0]
        assert code is None or found, f"ScenarioRunner ended with status {code} and without a result"
        process_wait(process)
    raise AssertionError(f"no result after {limit_s:.0f} s")


def process_wait(process: subprocess.Popen[bytes]) -> None:
    """A while, or until it ends."""
    try:
        process.wait(0.5)
    except subprocess.TimeoutExpired:
        return


def free_port() -> int:
    """A port without a listener."""
    import socket  # noqa: PLC0415 - only here

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
