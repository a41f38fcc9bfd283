"""Claims about a service without a simulator: doors, space, holding, conserved persons, and drivers that cheat."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from basu.intervals import sign_test
from basu.metrics.passengers.service import CAPACITY
from basu_service.cabin import SEATS, Cabin, Refusal, Space
from basu_service.demand import Shares
from basu_service.operation import DOOR_S, MOST_REST_S, WHEELCHAIR_S, Seen, Service
from basu_service.persons import Kind, Person
from point_service import (
    Driver,
    LeavesAtOnce,
    NeverStops,
    Played,
    StandsForEver,
    StopsHalfASecond,
    dead,
    demand,
    honest,
    play,
)

CHEATS = [NeverStops, StandsForEver, StopsHalfASecond]


def person(number: int = 0, came_s: float = 0.0, **given_values: object) -> Person:
    values: dict[str, object] = {
        "stop_id": "A",
        "destination_id": "B",
        "patience_s": 600.0,
        "kind": Kind.ON_FOOT,
        "needs_seat": False,
        "likes_standing": False,
        "holds_on": True,
        "steadiness": 0.5,
        "connects": False,
    }
    return Person(number=number, came_s=came_s, **{**values, **given_values})  # type: ignore[arg-type]


def ends(played: Played) -> int:
    part = played.document["persons"]
    return part["carried"] + part["riding"] + part["stranded"] + part["waiting"] + part["gave_up"]


@settings(max_examples=12)
@given(
    st.integers(0, 10_000),
    st.lists(
        st.sampled_from([Driver, NeverStops, StandsForEver, LeavesAtOnce, StopsHalfASecond]), min_size=1, max_size=3
    ),
    st.booleans(),
    st.sampled_from([5.0, 60.0]),
)
def test_persons_are_conserved_whatever_the_drivers_do(
    seed: int,
    kinds: list[type[Driver]],
    holds: bool,  # noqa: FBT001
    per_hour: float,
) -> None:
    played = play(
        [kind() for kind in kinds], seed=seed, minutes=40.0, holds=holds, wanted=demand(per_hour), results=dead
    )
    assert ends(played) == played.document["persons"]["came"] == len(played.document["journeys"])
    assert played.most_aboard <= CAPACITY
    for journey in played.service.journeys:
        if journey.boarded_s is not None:
            assert journey.boarded_s >= journey.person.came_s
            assert journey.gave_up_s is None
        if journey.alighted_s is not None:
            assert journey.boarded_s is not None
            assert journey.alighted_s > journey.boarded_s


def test_two_services_with_one_seed_are_equal_and_the_persons_do_not_depend_on_the_drivers() -> None:
    first, again, other = play(honest()), play(honest()), play(honest(), seed=2)
    assert json.dumps(first.document) == json.dumps(again.document)
    assert first.document["journeys"] != other.document["journeys"]
    cheated = play([NeverStops(), NeverStops()])
    came = [[each["came_s"] for each in one.document["journeys"]] for one in (first, cheated)]
    assert came[0] == came[1]


def test_an_honest_service_passes_and_carries_most() -> None:
    document = play(honest(), wanted=demand(5.0), holds=True).document
    assert document["passed"], document["reasons"]
    part = document["persons"]
    assert part["carried"] > 0.6 * part["came"]
    assert part["carried_past"] == 0


@pytest.mark.parametrize("cheat", CHEATS)
def test_a_driver_that_games_the_figures_loses(cheat: type[Driver]) -> None:
    fair, foul = play(honest(), wanted=demand(5.0)).document, play([cheat(), cheat()], wanted=demand(5.0)).document
    assert not foul["passed"]
    assert foul["reasons"]
    assert foul["persons"]["carried"] < fair["persons"]["carried"]
    assert (foul["waits"]["mean_s"] or 0.0) > (fair["waits"]["mean_s"] or 0.0)
    assert foul["headways"]["longest_gap_s"] > fair["headways"]["longest_gap_s"]


def test_a_driver_that_leaves_at_once_is_held_until_all_have_boarded() -> None:
    played = play([LeavesAtOnce(), LeavesAtOnce()], wanted=demand(20.0))
    fitting = [why for each in played.document["journeys"] for why in each["left_behind"] if why == "doors_closed"]
    fair = play(honest(), wanted=demand(20.0))
    assert played.document["persons"]["carried"] > 0
    assert len(fitting) <= 0.2 * played.document["persons"]["came"]
    assert not played.boarded_moving
    assert not fair.boarded_moving


def test_no_person_boards_a_vehicle_that_rolls_or_rests_elsewhere_or_too_shortly() -> None:
    service = Service([person()], 1)
    assert not any(service.step(0.05 * tick, 0, Seen("A", rests=False, goes=False)) for tick in range(200))
    assert not any(service.step(10 + 0.05 * tick, 0, Seen(None, rests=True, goes=False)) for tick in range(200))
    for tick in range(200):  # half of the time at rest, never for half a second
        assert not service.step(20 + 0.05 * tick, 0, Seen("A", rests=tick % 9 != 0, goes=False))
    assert service.journeys[0].boarded_s is None


def dwell_s(*persons: Person, goes: bool = True) -> float:
    """How long the parking brake holds a vehicle that comes to an empty stop with these persons."""
    service, t_s = Service(persons, 1), 0.0
    while not service.step(t_s, 0, Seen("A", rests=True, goes=goes)):
        t_s = round(t_s + 0.05, 6)
    began_s = t_s
    while service.step(t_s, 0, Seen("A", rests=True, goes=goes)):
        t_s = round(t_s + 0.05, 6)
    return t_s - began_s


def test_boarding_takes_the_time_of_each_person() -> None:
    empty_s = dwell_s()
    assert empty_s == pytest.approx(2.0 * DOOR_S, abs=0.11)
    assert dwell_s(person()) - empty_s == pytest.approx(2.5, abs=0.11)
    assert dwell_s(person(0), person(1)) - empty_s == pytest.approx(5.0, abs=0.16)
    assert dwell_s(person(kind=Kind.WHEELCHAIR)) - empty_s == pytest.approx(WHEELCHAIR_S, abs=0.11)
    assert dwell_s(person(kind=Kind.PUSHCHAIR)) - empty_s == pytest.approx(5.0, abs=0.11)


def test_a_wheelchair_boards_first_and_a_second_one_is_left_behind() -> None:
    service = Service([person(0), person(1, kind=Kind.WHEELCHAIR), person(2, kind=Kind.WHEELCHAIR)], 1)
    t_s = 0.0
    while service.calls == [] or service.calls[0].closed_s is None:
        service.step(t_s, 0, Seen("A", rests=True, goes=True))
        t_s += 0.05
    service.step(t_s, 0, Seen(None, rests=False, goes=True))
    first, second, third = service.journeys
    assert second.boarded_s is not None
    assert first.boarded_s is not None
    assert second.boarded_s < first.boarded_s
    assert [why for _, why in third.left_behind] == [Refusal.PLACE_TAKEN.value]


def test_a_full_vehicle_leaves_persons_behind() -> None:
    cabin = Cabin()
    for number in range(CAPACITY):
        assert cabin.refusal(person(number)) is None
        cabin.board(person(number))
    assert cabin.refusal(person(99)) is Refusal.FULL
    assert cabin.standing == CAPACITY - SEATS
    cabin.alight(cabin.aboard[0][0])
    cabin.settle()
    assert cabin.standing == CAPACITY - SEATS - 1


def test_a_seated_passenger_stands_up_for_a_person_that_needs_a_seat() -> None:
    cabin = Cabin()
    for number in range(SEATS):
        cabin.board(person(number, needs_seat=number < SEATS - 1))
    cabin.board(person(50, needs_seat=True))
    assert cabin.aboard[50][1] is Space.SEAT
    assert cabin.aboard[SEATS - 1][1] is Space.STANDING
    assert cabin.refusal(person(51, needs_seat=True)) is Refusal.NO_SEAT
    assert cabin.refusal(person(52)) is None


def test_a_vehicle_is_held_for_the_timetable_and_never_too_long() -> None:
    def held(planned_s: float) -> float:
        service, t_s = Service([], 1, lambda _vehicle, _stop, _call: planned_s), 0.0
        while service.calls == [] or service.calls[0].closed_s is None:
            service.step(t_s, 0, Seen("A", rests=True, goes=False))
            t_s += 0.05
        return service.calls[0].closed_s

    assert held(0.0) < 5.0
    assert held(60.0) == pytest.approx(60.0, abs=0.2)
    assert held(1000.0) == pytest.approx(MOST_REST_S, abs=2.0)


def test_passengers_of_a_vehicle_that_ends_its_drive_are_stranded_and_the_other_goes_on() -> None:
    drivers = [Driver(dies_s=700.0), Driver()]
    played = play(drivers, wanted=demand(20.0), results=dead)
    part = played.document["persons"]
    assert part["stranded"] > 0
    assert ends(played) == part["came"]
    assert any(call["vehicle"] == 2 and call["arrival_s"] > 1500.0 for call in played.document["calls"])
    assert "vehicle 1 ended before the service: the agent failed" in played.document["reasons"]


@pytest.mark.slow
def test_headway_control_spreads_vehicles_that_begin_together_over_30_seeds() -> None:
    spread = [
        [
            play(honest(), seed=seed, minutes=90.0, apart_s=200.0, slower=0.1, cooperates=cooperates).document[
                "headways"
            ]
            for seed in range(30)
        ]
        for cooperates in (False, True)
    ]
    variation = [np.array([each["variation"] for each in one], dtype=float) for one in spread]
    test = sign_test(*variation)
    assert variation[1].mean() < 0.6 * variation[0].mean()
    assert test.first_only >= 28
    assert test.p_value < 0.001


def test_passengers_stand_while_seats_are_free_only_if_they_like_to() -> None:
    played = play(honest(), wanted=demand(4.0, Shares(stands=0.0)))
    assert played.document["rides"]["most_standing"] == 0
    liking = play(honest(), wanted=demand(4.0, Shares(stands=1.0)))
    assert liking.document["rides"]["most_standing"] > 0
