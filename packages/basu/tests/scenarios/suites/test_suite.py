"""Claims about suites: their files, their cases, the user's parameters, and the law's figures in them."""

from pathlib import Path

import numpy as np
import pytest

from basu.errors import ScenarioError
from basu.metrics.careful_driver.eu_cut_in import DIFFERENCES_KMH, OTHERS_S, STANDING_S
from basu.scenarios.cases import open_library
from basu.scenarios.library.lane_change.cut_in_at_ttc import WITHIN_S
from basu.scenarios.suites.checks import CHECKS, FIGURES
from basu.scenarios.suites.suite import read_own_values, read_suite, suite_names


@pytest.mark.parametrize("name", suite_names())
def test_each_case_of_a_suite_can_be_played_and_each_check_is_known(name: str) -> None:
    _, found = open_library().suite(name)
    for requirement, playables in found:
        assert len(playables) == len(requirement.cases)
        assert bool(playables) == bool(requirement.check) != bool(requirement.untested)
        if requirement.check:
            assert requirement.check["kind"] in CHECKS
            assert requirement.check.get("figure", "highest speed") in FIGURES


@pytest.mark.parametrize(("requirement", "row"), [("cut-in-standing", STANDING_S), ("cut-in-others", OTHERS_S)])
def test_the_law_demands_each_cut_in_of_its_row_whatever_the_tolerance(
    requirement: str, row: tuple[float, ...]
) -> None:
    _, found = open_library().suite("eu-1426")
    playables = next(cases for each, cases in found if each.id == requirement)
    assert {one.values["side"] for one in playables} == {"left", "right"}
    for one in playables:
        bound_s = np.interp(float(one.values["difference"]), DIFFERENCES_KMH, row)
        assert float(one.values["ttc"]) - WITHIN_S > bound_s


def test_a_word_of_a_suite_means_its_cases_each_once() -> None:
    playables = open_library().choose(["eu-1426"])
    names = [one.case.name for one in playables]
    assert len(names) == len(set(names)) == 20


def test_a_users_file_replaces_a_parameter(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text("pedestrian_speeds = [1.0, 2.0]\nhighest_speed = 5\n")
    suite, found = open_library((), file).suite("iso-22737")
    crossing = next(cases for each, cases in found if each.id == "hazard-open")
    assert {one.values["speed"] for one in crossing} == {1.0, 2.0}
    assert next(each for each, _ in found if each.id == "highest-speed").check["limit"] == 5.0
    origins = {each.name: each.origin for each in suite.parameters}
    assert origins["pedestrian_speeds"] == "your file"
    assert origins["sight_times"] == "BASU"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        pytest.param('speed = "fast"', "write a number", id="text"),
        pytest.param("speed = []", "write a number", id="empty"),
        pytest.param("speed = [true]", "write a number", id="truth value"),
        pytest.param("speed", "no TOML", id="no TOML"),
    ],
)
def test_a_broken_parameter_file_gets_a_sentence(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "own.toml"
    file.write_text(text)
    with pytest.raises(ScenarioError, match=said):
        read_own_values(file)


def test_a_parameter_that_a_suite_has_not_is_refused_with_the_nearest() -> None:
    with pytest.raises(ScenarioError, match="did you mean 'highest_speed'"):
        read_suite("iso-22737", {"higest_speed": (5.0,)})


def test_a_value_out_of_a_cases_range_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text("pedestrian_speeds = 9.0\n")
    with pytest.raises(ScenarioError, match=r"from 0\.8 to 2\.2"):
        open_library((), file).choose(["iso-22737"])
