"""Tests of ``basu.metrics.fault``: the ten encounters of docs/reference/fault.md, and drives that are near to them."""

import math
from dataclasses import replace

import pytest

from basu.metrics.fault import responsibility
from basu.metrics.infraction import CollisionKind, Responsibility
from basu.metrics.right_of_way import needed_gap_m
from basu.records.history import History
from fakes.drives import STEP_S, stop_sign, straight_route, traffic_light
from fakes.encounters import (
    BAY,
    CROSSING_M,
    GREEN,
    HALF_JUNCTION_M,
    LANE,
    LEFT_LANE,
    OTHER,
    RED,
    WALKER,
    Encounter,
    along,
    by_nuplan,
    crossing,
    drive,
    encounters,
    ends_at,
    left_turn,
    out_of_bay,
    side_struck,
    sideways,
)
from fakes.rides import Row, moving


def judged(history: History) -> Responsibility:
    return responsibility(history, history.collisions[0])


@pytest.mark.parametrize("encounter", encounters(), ids=lambda encounter: encounter.title)
def test_the_verdict_of_each_encounter_stays(encounter: Encounter) -> None:
    found = judged(encounter.history)
    assert (found.at_fault, by_nuplan(encounter.history)) == (encounter.at_fault, encounter.at_fault_by_nuplan)
    assert found.sentence.startswith("at fault: " if encounter.at_fault else "not at fault: ")


@pytest.mark.parametrize(
    ("index", "words"),
    [
        (2, "the ego pulled out 13.9 m ahead of the other, which needed 18.5 m at 11.0 m/s"),
        (3, "the ego opened a gap by changing lanes 11.0 m ahead of the other, which needed 12.2 m at 11.0 m/s"),
        (5, "the ego did not yield at stop sign 7 to the other, which came at 8.0 m/s"),
        (6, "the ego entered the junction on red, past traffic light 12"),
        (8, "the ego turned left across the path of the other, which came towards it at 9.0 m/s"),
    ],
)
def test_the_reason_stands_in_words(index: int, words: str) -> None:
    assert judged(encounters()[index].history).sentence == f"at fault: {words}"


def test_the_needed_gap_is_that_of_regulation_79() -> None:
    assert needed_gap_m(20.0, 14.0) == pytest.approx(6.0 * 0.4 + 36.0 / 6.0 + 14.0)
    assert needed_gap_m(10.0, 14.0) == pytest.approx(14.0)
    assert needed_gap_m(9.0, 0.0) == pytest.approx(9.0 * 0.4 + 81.0 / 6.0)


def test_to_cut_in_and_stop_before_the_contact_does_not_help() -> None:
    """NuPlan calls an ego that stands not at fault."""

    def path(t_s: float) -> tuple[float, float]:
        return sideways(6.0, -3.5, 1.0, 1.5)(min(t_s, 3.0))

    history = drive(3.6, path, ends_at(3.6, 18.0 - 3.95, 0.0, 9.0, 0.0), lanes=(LANE, LEFT_LANE))
    assert judged(history).kind is CollisionKind.STOPPED_EGO
    assert judged(history).at_fault


def test_to_take_a_fair_gap_and_brake_hard_is_at_fault() -> None:
    def path(t_s: float) -> tuple[float, float]:
        """At 8 m/s into the lane, and from 4 s on to rest by 4 m/s²."""
        braked_s = min(max(0.0, t_s - 4.0), 2.0)
        x_m, y_m = sideways(8.0, -3.5, 1.0, 2.0)(min(t_s, 4.0))
        return x_m + 8.0 * braked_s - 2.0 * braked_s**2, y_m

    history = drive(6.2, path, ends_at(6.2, path(6.15)[0] - 3.95, 0.0, 8.0, 0.0), lanes=(LANE, LEFT_LANE))
    assert judged(history).at_fault
    assert "ahead of the other and then braked by" in judged(history).sentence


def test_to_brake_hard_in_the_own_lane_is_the_fault_of_the_follower() -> None:
    def path(t_s: float) -> tuple[float, float]:
        braked_s = min(max(0.0, t_s - 4.0), 2.0)
        return 8.0 * min(t_s, 4.0) + 8.0 * braked_s - 2.0 * braked_s**2, 0.0

    history = drive(5.6, path, ends_at(5.6, path(5.55)[0] - 3.95, 0.0, 8.0, 0.0))
    assert judged(history).sentence == "not at fault: the ego was struck from behind at 8.00 m/s"


def test_a_lane_that_the_ego_has_had_for_long_is_its_own() -> None:
    path = sideways(2.0, -3.5, 0.0, 2.0)
    history = drive(9.0, path, ends_at(9.0, 2.0 * 8.95 - 3.95, 0.0, 9.0, 0.0), lanes=(LANE, LEFT_LANE))
    assert not judged(history).at_fault


def test_the_other_that_cuts_in_behind_the_ego_took_no_lane_from_it() -> None:
    def cutting_in(t_s: float) -> Row:
        """From the left lane into the ego's tail, at 9 m/s."""
        at = sideways(9.0, -3.5, 2.0, 1.8)
        (x_m, y_m), (x1_m, y1_m) = at(t_s), at(t_s + 0.01)
        vx_mps, vy_mps = (x1_m - x_m) / 0.01, (y1_m - y_m) / 0.01
        x_m += 5.0 * 3.95 - 3.9 - 9.0 * 3.95
        return {
            "x_m": x_m,
            "y_m": y_m,
            "yaw_rad": math.atan2(vy_mps, vx_mps),
            "velocity_x_mps": vx_mps,
            "velocity_y_mps": vy_mps,
        }

    assert not judged(drive(4.0, along(5.0), cutting_in)).at_fault


def test_a_bay_may_be_left_when_the_road_behind_is_free() -> None:
    seconds = 7.0
    x_m = out_of_bay(seconds - STEP_S)[0]
    history = drive(seconds, out_of_bay, ends_at(seconds, x_m - 3.95, 0.0, 11.0, 0.0), lanes=(LANE, BAY))
    assert not judged(history).at_fault


def test_a_person_has_no_lane_to_be_taken() -> None:
    history = encounters()[2].history
    walker = replace(history, facts=replace(history.facts, actor_types={OTHER: WALKER}))
    assert "pulled out" not in judged(walker).sentence


def test_an_ego_that_stands_before_the_line_did_not_enter_on_red() -> None:
    """The line lies 2 m inside the junction; the ego waits half a metre before it when a car strikes it."""
    line_m = CROSSING_M - HALF_JUNCTION_M + 2.0
    route = crossing(traffic_light(line_m))
    at_m = line_m - route_front_m() - 0.5
    history = drive(5.0, lambda _: (at_m, 0.0), ends_at(5.0, at_m + 0.5, 2.95, 0.0, -8.0), route=route, light=RED)
    assert judged(history).sentence.startswith("not at fault: the ego stood")


def test_on_red_a_person_has_the_right_of_way_too() -> None:
    for light, at_fault in ((RED, True), (GREEN, False)):
        history = side_struck(crossing(traffic_light(CROSSING_M - HALF_JUNCTION_M - 1.0)), light)
        on_foot = replace(history, facts=replace(history.facts, actor_types={OTHER: WALKER}))
        assert judged(on_foot).at_fault is at_fault


def route_front_m() -> float:
    return drive(0.2, along(1.0), ends_at(0.2, 50.0, 50.0, 0.0, 0.0)).facts.vehicle.front_m


def test_at_an_all_way_stop_the_first_goes_first() -> None:
    """The other stood at its line when the ego entered, and started afterwards."""
    history = side_struck(crossing(stop_sign(CROSSING_M - 8.0)))
    entry = int(((history.frames["route_s_m"] + 2.0) >= CROSSING_M - 8.0).argmax())
    others = history.others.copy()
    others["velocity_y_mps"][others["tick"] <= entry] = 0.0
    assert judged(history).at_fault
    assert not judged(replace(history, others=others)).at_fault


def test_to_wait_for_the_oncoming_in_the_junction_is_no_left_turn() -> None:
    waits_m = CROSSING_M - 5.0
    oncoming = ends_at(4.0, waits_m + 3.9, 0.0, -8.0, 0.0)
    history = drive(4.0, lambda t_s: (waits_m - 0.01 * (4.0 - t_s) - 5.0 * max(0.0, 2.0 - t_s), 0.0), oncoming)
    route = left_turn()
    assert not judged(replace(history, facts=replace(history.facts, route=route))).at_fault


def test_no_junction_no_clause() -> None:
    history = side_struck(straight_route(120.0, controls=(stop_sign(CROSSING_M - 8.0),)))
    assert not judged(history).at_fault


def test_an_other_that_stands_has_no_way_to_be_taken() -> None:
    history = drive(4.0, along(5.0), moving(19.75 + 3.9, 0.0, 0.0, 0.0))
    assert judged(history).kind is CollisionKind.STOPPED_OTHER
