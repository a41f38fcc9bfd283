"""Claims about what a service reads: demand, timetable and route; what is wrong becomes a sentence."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basu.errors import UserError
from basu.routing.route_file import read_routes
from basu.routing.timetable import Call
from basu_service.demand import packaged_demand, read_demand
from basu_service.persons import draw_persons
from basu_service.plan import make_plan
from basu_service.running import ServiceConditions
from point_service import ROUND_M, STOPS, demand, square, timetable

GOOD: dict[str, Any] = {
    "schema_version": 1,
    "stops": {"A": {"rates": [{"from": "06:00", "to": "20:00", "per_hour": 4}], "to": {"B": 1}}},
    "shares": {"wheelchair": 0.1},
    "patience_min": 20,
    "connections": {"A": {"name": "X", "every_min": 10, "first": "06:00", "walk_min": 1, "share": 0.5}},
}
LEAP = Path(__file__).parents[2] / "basu" / "src" / "basu" / "routes" / "linden_leap.xml"


def changed(*path: Any, value: Any) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(json.dumps(GOOD))
    place: Any = document
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return document


RATE = ("stops", "A", "rates", 0)


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (changed(*RATE, "per_hour", value=-1), "the rate at A is -1 persons an hour"),
        (changed(*RATE, "per_hour", value=math.nan), "the rate at A is nan; it must be a finite number"),
        (changed(*RATE, "per_hour", value=math.inf), "it must be a finite number"),
        (changed(*RATE, "per_hour", value="many"), "it must be a finite number"),
        (changed(*RATE, "per_hour", value=1e9), r"it must lie in \[0, 2000\]"),
        (changed(*RATE, "to", value="05:00"), "which is not later"),
        (changed(*RATE, "to", value="half past"), "write a time of the day"),
        (
            changed("stops", "Z", value=GOOD["stops"]["A"]),
            "names the stop 'Z', which its route lacks; it has A, B, C, D",
        ),
        (changed("stops", "A", "to", value={"Q": 1}), "names the stop 'Q'"),
        (changed("stops", "A", "to", value={"B": -1}), "must be 0 or more"),
        (changed("stops", "A", "to", value={"A": 1}), "cannot have A as their destination"),
        (changed("stops", "A", "to", value={}), "one of them more than 0"),
        (changed("shares", "wheelchair", value=1.5), r"must lie in \[0, 1\]"),
        (changed("shares", "bicycle", value=0.1), "the share 'bicycle' means nothing"),
        (changed("patience_min", value=0), "it must be more than 0"),
        (changed("connections", "Z", value=GOOD["connections"]["A"]), "names the stop 'Z'"),
        (changed("schema_version", value=2), "only 1 can be read"),
        (changed("colour", value="blue"), "'colour' means nothing"),
        ({"schema_version": 1}, "lacks 'patience_min'|lacks 'stops'"),
        ([], "."),
    ],
)
def test_a_wrong_demand_is_a_sentence(tmp_path: Path, document: Any, says: str) -> None:
    path = tmp_path / "demand.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(UserError, match=says):
        read_demand(path, STOPS)


def test_the_packaged_demand_is_of_the_leap_and_draws_the_rates() -> None:
    route = read_routes(LEAP)[0]
    wanted = read_demand(packaged_demand(), [stop.id for stop in route.stops])
    counts = [len(draw_persons(wanted, seed, 9.5 * 3600.0, 3600.0)) for seed in range(200)]
    assert np.mean(counts) == pytest.approx(38.0, abs=4.0 * math.sqrt(38.0 / 200))
    assert np.var(counts) == pytest.approx(38.0, rel=0.4)
    people = draw_persons(wanted, 7, 6 * 3600.0, 14 * 3600.0)
    assert all(one.came_s <= other.came_s for one, other in itertools.pairwise(people))
    assert {each.stop_id for each in people} == {stop.id for stop in route.stops}


def test_shares_of_persons_are_those_of_the_file() -> None:
    people = draw_persons(demand(1000.0), 3, 0.0, 36_000.0)
    chairs = sum(each.kind.value == "wheelchair" for each in people) / len(people)
    assert chairs == pytest.approx(0.03, abs=0.004)
    assert sum(each.holds_on for each in people) / len(people) == pytest.approx(0.8, abs=0.01)


def test_a_timetable_that_cannot_be_driven_is_a_sentence() -> None:
    with pytest.raises(UserError, match=r"cannot be driven: 900 m from A to B in 80 s leaves 11\.2 m/s"):
        make_plan(square(timetable(400.0)), 2)
    late = timetable()
    calls = (*late.calls[:-1], replace(late.calls[-1], arrival_s=1199.0, departure_s=1200.0))
    with pytest.raises(UserError, match="900 m from D to A in 0 s leaves no time at all"):
        make_plan(square(replace(late, calls=calls)), 2)


def test_a_route_that_is_no_round_or_has_no_service_is_a_sentence() -> None:
    route = square()
    with pytest.raises(UserError, match="ends 900 m from its start; a service needs a round"):
        make_plan(replace(route, points=route.points[:-1]), 2)
    with pytest.raises(UserError, match="has no timetable with calls"):
        make_plan(replace(route, timetable=None), 2)
    with pytest.raises(UserError, match="at least 2 in <stops>"):
        make_plan(replace(route, stops=route.stops[:1]), 2)
    with pytest.raises(UserError, match="cannot begin 15 min apart"):
        make_plan(route, 2, 900.0)


def test_vehicles_begin_equal_times_apart_and_are_due_by_the_timetable() -> None:
    plan = make_plan(square(), 2)
    assert plan.length_m == ROUND_M
    assert plan.starts_m == pytest.approx((0.0, 0.5 * ROUND_M))
    assert plan.planned_departure_s(0, "B", 0) == 320.0
    assert plan.planned_departure_s(0, "B", 1) == 1520.0
    assert plan.planned_departure_s(1, "C", 0) == 20.0
    assert plan.planned_departure_s(1, "B", 0) == 920.0
    assert plan.planned_departure_s(1, "nowhere", 0) is None
    assert plan.promised_arrival_s("B", "C", 100.0) == 320.0 + 280.0


def test_rounds_have_their_own_stops_and_calls() -> None:
    many = make_plan(square(), 2).rounds(3600.0)
    assert [stop.id for stop in many.stops[:6]] == ["A", "B", "C", "D", "A/2", "B/2"]
    assert many.timetable is not None
    assert many.timetable.calls[5] == Call(stop_id="B/2", arrival_s=1500.0, departure_s=1520.0)
    assert len(many.points) == 4 * (len(many.stops) // 4) + 1


@pytest.mark.parametrize("minutes", [0.0, -3.0, math.nan, math.inf, 1e6])
def test_a_service_has_a_length(minutes: float) -> None:
    with pytest.raises(UserError, match="a service lasts more than 0"):
        ServiceConditions(minutes=minutes)
