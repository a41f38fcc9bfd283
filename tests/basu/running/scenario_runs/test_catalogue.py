"""Every scenario tells drivers apart: a careful one passes it, one that looks at nothing fails it; played live.

The first case of each is played here; ``benchmarks/scenarios.py`` plays all.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.scenarios.cases import open_library

LIBRARY = open_library()
BLIND = "forward"
OFF_THE_ROUTE = {"DriftingNeighbour", "RedLightRunner"}  # the route has no two lanes a way and no lights


def first_cases() -> dict[str, tuple[str, str]]:
    """By scenario: the id of its first case, and its reference driver."""
    first: dict[str, tuple[str, str]] = {}
    for case in LIBRARY.cases:
        scenario = LIBRARY.type_of(case)
        first.setdefault(scenario.__name__, (case.name, scenario.reference))
    return first


FIRST = first_cases()


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], dict[str, Any]]:
    """What came of the first cases with their reference drivers and the blind one, by case and driver."""
    found = {}
    for driver in sorted({BLIND, *(reference for _, reference in FIRST.values())}):
        cases = [case for case, reference in FIRST.values() if driver in {BLIND, reference}]
        output = tmp_path_factory.mktemp(driver)
        main(["scenario", "run", *cases, "--agent", driver, "--output", str(output), "--workers", "2"])
        for path in (output / "latest").glob(f"{driver}/*/result.json"):
            result = json.loads(path.read_text(encoding="utf-8"))
            found[result["id"], driver] = result
    return found


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("scenario", FIRST)
def test_a_careful_driver_passes_and_a_blind_one_fails(
    results: dict[tuple[str, str], dict[str, Any]], scenario: str
) -> None:
    case, reference = FIRST[scenario]
    careful, blind = results[case, reference], results[case, BLIND]
    assert (careful["verdict"], careful["message"]) == ("SUCCESS", careful["message"])
    assert (blind["verdict"], blind["message"]) == ("FAILURE", blind["message"])


def test_every_scenario_has_three_cases_on_the_route_and_off_it() -> None:
    for scenario in LIBRARY.scenarios:
        cases = [case for case in LIBRARY.cases if LIBRARY.type_of(case) is scenario]
        assert len(cases) >= 3, scenario.__name__
        places = {False} if scenario.__name__ in OFF_THE_ROUTE else {True, False}
        assert {case.on_route for case in cases} == places, scenario.__name__


def test_every_group_has_at_least_two_scenarios() -> None:
    groups = [scenario.group for scenario in LIBRARY.scenarios]
    assert min(groups.count(group) for group in set(groups)) >= 2
    assert len(set(groups)) == 10  # the nine of NHTSA's typology and the shuttle's own


def test_the_instances_come_with_the_package() -> None:
    assert all(Path(case.source.split(",")[0].split(":")[0]).suffix == ".xml" for case in LIBRARY.cases)
