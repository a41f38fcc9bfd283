"""Every scenario tells drivers apart, and the controls gain nothing; played live.

The first case of each scenario is played here; ``benchmarks/scenarios.py`` plays all. What the control drivers prove
is in `docs/decisions/0055-control-drivers.md`, and what those prove that are blind to one kind of partner in
`docs/decisions/0108-blind-drivers.md`; ``benchmarks/blindness.py`` plays their matrix. The drivers are in the
benchmark's process, which halves the processor time. They are checked for cheating as if they were in their own,
because no scenario may set off these checks.
"""

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from basu.agents.calls import AgentCalls
from basu.cli import main
from basu.managers import agents_manager
from basu.records.partners import ACTORS
from basu.scenarios.cases import open_library
from basu.scenarios.characteristics import characteristics_of
from servers import RunningServer

LIBRARY = open_library()
BLIND, FORWARD = "blind", "forward"
OFF_THE_ROUTE = {"CutInAtTtc", "DriftingNeighbour", "RedLightRunner"}  # the route has no two lanes a way and no lights
WITHOUT_CASES = {"YieldToEmergencyVehicle"}  # no agent of BASU pulls over; test_emergency_vehicle_live.py plays it
WITHOUT_OTHERS = {"ControlLoss", "SlipperyStop", "BendDeparture", "CrossWind", "SteeringDeviation"}
# conflicts that a slow driver meets late or not at all, and some that it meets like any other
MISSED_BY_THE_SLOW = (
    "roundabout_1",
    "red_light_runner_1",
    "ego_turns_left_1",
    "oncoming_overtaker_1",
    "control_loss_1",
)
OF_THE_SLOW = {  # one that stands stays there until the time is up, whatever the conflict
    "creeper": MISSED_BY_THE_SLOW,
    "standing": MISSED_BY_THE_SLOW[-2:],
}


BLIND_TO_THE_PARTNER = {
    "cyclist_swerves_1": "cyclist",
    "deer_at_dusk_1": "animal",
    "occluded_child_1": "walker",
    "parked_car_pulls_out_1": "vehicle",
    "slippery_stop_1": "sign",
    "static_object_2": "prop",
}


def first_cases() -> dict[str, tuple[str, str]]:
    """By scenario: the id of its first case, and its reference driver."""
    first: dict[str, tuple[str, str]] = {}
    for case in LIBRARY.cases:
        scenario = LIBRARY.type_of(case)
        first.setdefault(scenario.__name__, (case.name, scenario.reference))
    return first


FIRST = first_cases()
WITH_CASES = [scenario for scenario in LIBRARY.scenarios if scenario.__name__ not in WITHOUT_CASES]


def drives() -> dict[str, list[str]]:
    """By driver: the cases that it is to play."""
    found = defaultdict(list)
    for scenario in WITH_CASES:
        case, reference = FIRST[scenario.__name__]
        found[reference].append(case)
        found[FORWARD if scenario.__name__ in WITHOUT_OTHERS else BLIND].append(case)
    for case, kind in BLIND_TO_THE_PARTNER.items():
        found[f"behavioral:no-{kind}s"].append(case)
    return {**found, **{driver: list(cases) for driver, cases in OF_THE_SLOW.items()}}


@pytest.fixture(scope="module")
def results(
    simulator: RunningServer, tmp_path_factory: pytest.TempPathFactory
) -> dict[tuple[str, str], dict[str, Any]]:
    """What came of the drives, by case and driver."""
    found = {}
    options = ["--in-process", "--host", "127.0.0.1", "--port", str(simulator.port)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(agents_manager, "RemoteAgent", AgentCalls)  # drivers of the class are checked
        for driver, cases in drives().items():
            output = tmp_path_factory.mktemp(driver)
            main(["scenario", "run", *cases, "--agent", driver, "--output", str(output), *options])
            for path in (output / "latest").glob(f"{driver.replace(':', '-')}/*/result.json"):
                result = json.loads(path.read_text(encoding="utf-8"))["case"]
                found[result["id"], driver] = result
    return found


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("scenario", FIRST)
def test_the_reference_driver_passes(results: dict[tuple[str, str], dict[str, Any]], scenario: str) -> None:
    case, reference = FIRST[scenario]
    result = results[case, reference]
    assert (result["verdict"], result["message"]) == ("SUCCESS", result["message"])


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("scenario", FIRST)
def test_a_driver_that_perceives_no_actor_fails_where_the_conflict_needs_perception(
    results: dict[tuple[str, str], dict[str, Any]], scenario: str
) -> None:
    """Elsewhere a driver fails that does not steer."""
    blind = FORWARD if scenario in WITHOUT_OTHERS else BLIND
    result = results[FIRST[scenario][0], blind]
    assert (result["verdict"], result["message"]) == ("FAILURE", result["message"])


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("driver", "case"), [(driver, case) for driver, cases in OF_THE_SLOW.items() for case in cases]
)
def test_nothing_is_gained_by_absence(results: dict[tuple[str, str], dict[str, Any]], case: str, driver: str) -> None:
    result = results[case, driver]
    assert (result["verdict"], result["message"]) != ("SUCCESS", result["message"])


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("case", "kind"), BLIND_TO_THE_PARTNER.items())
def test_a_driver_blind_to_the_partner_alone_does_not_pass(
    results: dict[tuple[str, str], dict[str, Any]], case: str, kind: str
) -> None:
    result = results[case, f"behavioral:no-{kind}s"]
    assert result["characteristics"]["partner"] == kind
    assert (result["verdict"], result["message"]) == ("FAILURE", result["message"])


def test_only_those_scenarios_have_no_actor_as_partner_that_disturb_the_egos_own_course() -> None:
    partners = {one.scenario.__name__: characteristics_of(*one[:2]).partner for one in LIBRARY.choose(["all"])}
    assert {name for name, partner in partners.items() if partner not in ACTORS} == WITHOUT_OTHERS


def test_every_scenario_has_three_cases_on_the_route_and_off_it() -> None:
    for scenario in WITH_CASES:
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
