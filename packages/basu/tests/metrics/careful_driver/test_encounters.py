"""Claims about recorded encounters: which of the situations of UN Regulation 157 they are, and what is none of them."""

import pytest

import fakes.encounters as contacts_of_fault
from basu.metrics.careful_driver.encounters import VehicleEncounter, encounters
from basu.metrics.careful_driver.model import Situation
from basu.records.history import History
from fakes.lane_conflicts import LANE_M, braking, cut_in, meeting, sideways, steady


def only(history: History) -> VehicleEncounter:
    (found,) = (each for each in encounters(history) if each.is_contact)
    return found


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_cut_in_begins_with_the_movement_into_the_lane(side: float) -> None:
    found = only(meeting(steady(10.0), cut_in(10.0, 5.0, 9.0, side=side)))
    assert found.situation is Situation.CUT_IN
    assert found.begin_tick * 0.05 == pytest.approx(3.0, abs=0.1)
    assert found.sentence == "cut-in: the other came into the lane at 4.0 s"


def test_a_vehicle_ahead_that_brakes_is_a_deceleration() -> None:
    found = only(meeting(steady(10.0), braking(10.0, 15.0, 4.0, 6.0)))
    assert found.situation is Situation.DECELERATION
    assert found.begin_tick * 0.05 == pytest.approx(4.0, abs=0.55)


def test_a_braking_long_after_a_cut_in_is_a_deceleration() -> None:
    def other(t_s: float) -> tuple[float, float]:
        return braking(10.0, 15.0, 9.0, 6.0)(t_s)[0], sideways(10.0, 0.0, (-LANE_M, 0.0), 0.5, 2.0)(t_s)[1]

    assert only(meeting(steady(10.0), other)).situation is Situation.DECELERATION


def test_a_vehicle_that_another_hid_is_a_cut_out() -> None:
    leader = sideways(10.0, 14.0, (0.0, -LANE_M), 3.0, 1.5)
    found = only(meeting(steady(10.0), steady(0.0, 60.0), leader=leader))
    assert found.situation is Situation.CUT_OUT
    assert found.begin_tick * 0.05 == pytest.approx(3.15, abs=0.1)


def test_a_vehicle_in_plain_view_is_no_sudden_event() -> None:
    found = only(meeting(steady(10.0), steady(0.0, 60.0)))
    assert found.situation is None
    assert found.sentence.startswith("no model: the other was ahead in the lane")


@pytest.mark.parametrize(
    ("kind", "word"),
    [("walker.pedestrian.0001", "pedestrian"), ("vehicle.bh.crossbike", "cyclist"), ("static.prop.barrel", "thing")],
)
def test_the_models_say_nothing_about_other_road_users(kind: str, word: str) -> None:
    found = only(meeting(steady(10.0), cut_in(10.0, 5.0, 9.0), kind=kind))
    assert found.situation is None
    assert f"the other is a {word}" in found.sentence


@pytest.mark.parametrize("encounter", contacts_of_fault.encounters(), ids=lambda encounter: encounter.title)
def test_ten_contacts_of_other_kinds_are_none_of_the_situations(encounter: contacts_of_fault.Encounter) -> None:
    """Crossing, oncoming, from behind, in reverse, and a slower vehicle in plain view."""
    found = only(encounter.history)
    assert found.situation is None
    assert found.sentence.startswith("no model: ")


def test_a_near_miss_is_an_encounter_as_well() -> None:
    own = braking(10.0, 0.0, 3.9, 8.0)
    found = encounters(meeting(own, cut_in(10.0, 5.0, 7.0), seconds=7.0))
    assert [each.is_contact for each in found] == [False]
    assert found[0].situation is Situation.CUT_IN
