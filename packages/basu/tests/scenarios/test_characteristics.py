"""Claims about the characteristics of cases: from weather, class and file, and how they choose cases."""

from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.records.partners import Partner
from basu.scenarios.cases import cases_of
from basu.scenarios.characteristics import (
    KINDS,
    OF_SCENARIO,
    Characteristics,
    JunctionRelation,
    Lighting,
    characteristics_of,
    measured,
    value_of,
)
from basu.scenarios.class_file import own_scenarios
from basu.scenarios.playable import having
from fakes.drives import at, driven

CASE = """<scenarios><scenario name="mine_1" type="PedestrianCrossing" town="Linden">
  <ego_vehicle x="1" y="2" yaw="0"/>{more}
</scenario></scenarios>"""


def characteristics_in(folder: Path, more: str) -> Characteristics:
    """Those of a case with more elements."""
    path = folder / "mine.xml"
    path.write_text(CASE.format(more=more))
    (playable,) = cases_of(str(path))
    return characteristics_of(playable.case, playable.scenario)


@pytest.mark.parametrize(
    ("weather", "field", "value"),
    [
        ('sun_altitude_angle="-20"', "lighting", "dark"),
        ('sun_altitude_angle="-3"', "lighting", "dusk"),
        ('sun_altitude_angle="4"', "lighting", "daylight"),
        ('precipitation="30"', "atmosphere", "rain"),
        ('fog_density="20" cloudiness="90"', "atmosphere", "fog"),
        ('cloudiness="90"', "atmosphere", "cloudy"),
        ('cloudiness="10"', "atmosphere", "clear"),
        ('wetness="60"', "surface", "wet"),
        ('wetness="10"', "surface", "dry"),
    ],
)
def test_atmosphere_light_and_surface_follow_from_the_weather(
    tmp_path: Path, weather: str, field: str, value: str
) -> None:
    assert characteristics_in(tmp_path, f"<weather {weather}/>").document()[field] == value


@pytest.mark.parametrize(
    ("words", "partner"),
    [
        ("pedestrian_crossing_1", Partner.WALKER),
        ("cyclist_swerves_1", Partner.CYCLIST),
        ("deer_at_dusk_1", Partner.ANIMAL),
        ("roundabout_1", Partner.VEHICLE),
        ("running_for_the_shuttle_1", Partner.WALKER),
        ("slippery_stop_1", Partner.SIGN),
        ("cross_wind_1", Partner.NONE),
        ("static_object_1", Partner.VEHICLE),
        ("static_object_2", Partner.PROP),
        ("static_object_1:object=bin", Partner.PROP),
        ("dynamic_object_1:object=bicycle", Partner.CYCLIST),
        ("dynamic_object_1:object=moped", Partner.VEHICLE),
    ],
)
def test_a_case_states_the_partner_that_a_driver_has_to_see(words: str, partner: Partner) -> None:
    (playable,) = cases_of(words)
    assert characteristics_of(playable.case, playable.scenario).partner is partner


def test_a_case_may_state_what_its_class_and_weather_do_not(tmp_path: Path) -> None:
    found = characteristics_in(tmp_path, '<characteristics obstruction="vehicle" surface="slippery"/>')
    assert (found.obstruction.value, found.surface.value) == ("vehicle", "slippery")


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('<characteristics lightning="dark"/>', "there is no characteristic 'lightning'; did you mean 'lighting'?"),
        ('<characteristics lighting="drak"/>', "lighting has no value 'drak'; did you mean 'dark'?"),
        ('<characteristics junction="xyz"/>', "it may be none, approach, intersection, roundabout"),
    ],
)
def test_an_unknown_field_or_value_is_refused_with_what_is_known(tmp_path: Path, more: str, words: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        characteristics_in(tmp_path, more)
    assert words in str(refused.value)


def test_every_scenario_of_basu_states_known_fields_and_values() -> None:
    names = {scenario.__name__ for scenario in own_scenarios()}
    assert set(OF_SCENARIO) <= names
    for stated in OF_SCENARIO.values():
        for field, text in stated.items():
            value_of(field, text)


def test_conditions_choose_cases_that_have_all_of_them() -> None:
    every = cases_of("all")
    dark = having(every, [("lighting", "dark")])
    assert dark
    assert {characteristics_of(case.case, case.scenario).lighting for case in dark} == {Lighting.DARK}
    round_ = having(every, [("junction", "roundabout")])
    assert {case.scenario.__name__ for case in round_} == {"Roundabout"}
    both = having(every, [("junction", "roundabout"), ("junction", "intersection")])
    assert {characteristics_of(case.case, case.scenario).junction for case in both} == {
        JunctionRelation.ROUNDABOUT,
        JunctionRelation.INTERSECTION,
    }
    with pytest.raises(ScenarioError, match="none of the 4 cases has lighting=dusk and alignment=curve"):
        having(round_[:4], [("lighting", "dusk"), ("alignment", "curve")])
    assert having(every, []) == every


def test_a_case_is_listed_with_every_field() -> None:
    for case in cases_of("all"):
        assert list(case.about()["characteristics"]) == list(KINDS)


def test_a_played_case_has_the_speeds_where_its_conflict_began() -> None:
    found = measured(driven(at(6.0, 4.0)), 20)
    assert found == {"posted_mps": 11.0, "travel_mps": 6.0, "in_bend": False, "level": True}


@pytest.mark.parametrize(
    ("word", "types"),
    [
        ("ObstacleAvoidance", {"StaticObject", "DynamicObject"}),
        ("object_avoidance", {"StaticObject", "DynamicObject"}),
        ("thesis:I", {"ControlLoss"}),
        ("thesis:ii", {"FollowLeadingVehicle", "FollowLeadingVehicleWithObstacle"}),
        ("thesis:III", {"StaticObject", "DynamicObject"}),
        ("thesis:IV", {"UnsignalizedIntersection"}),
        ("thesis:V", {"Roundabout"}),
    ],
)
def test_the_names_of_the_thesis_mean_its_scenarios(word: str, types: set[str]) -> None:
    assert {case.scenario.__name__ for case in cases_of(word)} == types


def test_thesis_means_all_five_and_other_numbers_are_refused() -> None:
    assert len({case.scenario.__name__ for case in cases_of("thesis")}) == 7
    with pytest.raises(ScenarioError, match="no scenario 'VI'; write thesis:I, thesis:II"):
        cases_of("thesis:VI")
