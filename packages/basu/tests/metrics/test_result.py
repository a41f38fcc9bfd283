"""Claims about the result: what a reader finds in it, as an object and as plain JSON."""

import json
from typing import Any

import pytest

from basu.metrics.result import Result, judge
from basu.outcome import FAULT_OF, Outcome, Status
from basu.output.report.console import table
from basu.routing import Stop
from fakes.drives import at, driven, hit, ramp, stop_sign, straight_route

DONE = Outcome(Status.COMPLETED, "arrived")
STOPS = tuple(
    Stop(id=str(n), name=f"stop {n}", s_m=s_m, x_m=s_m, y_m=2.0, z_m=0.0, yaw_rad=0.0)
    for n, s_m in enumerate((20.0, 60.0))
)
META = {"simulated_s": 20.1, "wall_s": 1.0}


def result() -> Result:
    route = straight_route(controls=(stop_sign(100.0),), stops=STOPS)
    slowing, starting = ramp(10.0, 0.0, 4.0), ramp(0.0, 10.0, 4.0)
    speeds_mps = [*slowing, *at(0.0, 10.0), *starting, *at(10.0, 18.0)]
    return judge(DONE, driven(speeds_mps, route=route, collisions=[hit(400)]), meta=META)


def document() -> dict[str, Any]:
    return result().document()


def test_the_keys_that_programs_read_are_there() -> None:
    found = document()
    assert found["status"] == "Completed"
    assert found["fault"] == "none"
    assert set(found["scores"]) == {"driving", "infraction", "path_following"}
    assert found["meta"] == META
    assert found["schema_version"] == 3


def test_an_infraction_carries_time_place_speed_and_the_other_party() -> None:
    first = document()["infractions"][0]
    assert first["kind"] == "collision_static"
    assert {"tick", "t_s", "x_m", "y_m", "z_m", "speed_mps", "route_s_m", "other", "detail"} < set(first)


def test_a_service_stop_is_served_by_coming_to_rest_at_it() -> None:
    served, passed = document()["stops"]
    assert served["served"]
    assert served["rest_s"] == pytest.approx(10.0, abs=0.2)
    assert not passed["served"]
    assert passed["lowest_speed_mps"] > 5.0


def test_a_stop_that_was_not_reached_has_no_speed() -> None:
    found = judge(DONE, driven(at(1.0, 5.0), route=straight_route(stops=STOPS)))
    assert found.metrics["stops"][1] == {
        "id": "1",
        "name": "stop 1",
        "route_s_m": 60.0,
        "lowest_speed_mps": None,
        "rest_s": 0.0,
        "served": False,
    }


def test_it_is_plain_json_and_survives_a_round_trip() -> None:
    found = document()
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert Result.from_document(found) == result()
    assert Result.from_document(found).document() == found


def test_a_collision_has_its_responsibility_in_document_and_console() -> None:
    (collision,) = result().collisions
    assert collision.responsibility is not None
    assert collision.responsibility.at_fault
    assert document()["infractions"][0]["responsibility"]["kind"] == "stopped_other"
    assert "at fault: the ego drove at " in table(result())
    assert document()["collisions"] == {"number": 1, "at_fault": 1}


def test_the_responsibility_changes_no_score() -> None:
    """The thesis counts every collision."""
    struck = driven(at(0.0, 20.0), collisions=[hit(40, "vehicle.audi.tt", 9)])
    found = judge(DONE, struck)
    assert found.scores is not None
    assert found.metrics["collisions"] == {"number": 1, "at_fault": 0}
    assert found.scores.infraction == 0.6


@pytest.mark.parametrize("status", [Status.AGENT_CRASHED, Status.SIMULATOR_FAILED, Status.INTERRUPTED])
def test_the_score_of_a_run_that_a_failure_ended_is_marked(status: Status) -> None:
    found = judge(Outcome(status, "it ended"), driven(at(10.0, 5.0)), meta=META)
    line = next(line for line in table(found).splitlines() if line.startswith("driving score"))
    assert line.endswith(f"NOT COMPARABLE: the run ended as {status.value}")
    assert "NOT COMPARABLE" not in table(result())


def test_a_run_in_which_nothing_was_driven_has_no_score() -> None:
    found = judge(Outcome(Status.SETUP_FAILED, "no such vehicle"), None, meta=META)
    assert found.scores is None
    assert "nothing was driven" in table(found)


def test_the_table_tells_scores_infractions_and_signs() -> None:
    text = table(result())
    assert "ended             Completed: arrived" in text
    assert "driving score        0.6" in text
    assert "collision_static" in text
    assert "stop signs        0 of 1 obeyed; slowest speed before any line at most " in text
    assert "service stops     1 of 2 served" in text


def test_every_status_has_a_party_at_fault() -> None:
    assert set(FAULT_OF) == set(Status)
    assert [status for status in Status if status.fault.value == 0] == [
        Status.COMPLETED,
        Status.SCENARIO_ENDED,
        Status.STOPPED,
    ]
