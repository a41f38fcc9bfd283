"""Claims about scenarios on a route: the leaderboard's spelling is read, doubled names too; the rest gets sentences."""

import math
from pathlib import Path

import pytest
from lxml import etree

from basu.errors import ScenarioError
from basu.scenarios.route_scenarios import ScenarioOnRoute, scenarios_of
from basu.scenarios.stage import Pose

FILE = Path("routes.xml")
TRIGGER = '<trigger_point x="1.5" y="-2" z="370" yaw="180"/>'


def read(scenarios: str) -> tuple[ScenarioOnRoute, ...]:
    return scenarios_of(
        etree.fromstring(f'<route id="0" town="Linden">\n<scenarios>{scenarios}</scenarios></route>'), FILE
    )


def test_a_scenario_of_the_leaderboard_has_a_trigger_point_and_values() -> None:
    (found,) = read(
        f'<scenario name="Construction_1" type="ConstructionObstacleTwoWays">{TRIGGER}'
        '<distance value="100"/><frequency from="35" to="110"/></scenario>'
    )
    assert (found.name, found.type) == ("Construction_1", "ConstructionObstacleTwoWays")
    assert found.trigger == Pose(1.5, -2.0, 370.0, math.pi)
    assert found.values == {"distance": "100", "frequency_from": "35", "frequency_to": "110"}
    assert found.source == "routes.xml, line 2"


def test_an_actor_that_the_file_places_is_kept() -> None:
    (found,) = read(
        f'<scenario name="a" type="A">{TRIGGER}<other_actor x="4" y="5" yaw="0" model="walker.*"/></scenario>'
    )
    (other,) = found.others
    assert (other.model, other.role, other.pose) == ("walker.*", "scenario", Pose(4.0, 5.0))


def test_a_route_without_scenarios_has_none() -> None:
    assert scenarios_of(etree.fromstring('<route id="0" town="Linden"/>'), FILE) == ()
    assert read("") == ()


def test_a_name_that_the_leaderboard_gives_twice_is_counted() -> None:
    names = [found.name for found in read(f'<scenario name="Accident_2" type="Accident">{TRIGGER}</scenario>' * 3)]
    assert names == ["Accident_2", "Accident_2-2", "Accident_2-3"]


@pytest.mark.parametrize(
    ("scenario", "sentence"),
    [
        (f'<scenario type="A">{TRIGGER}</scenario>', "routes.xml, line 2: <scenario> lacks its attribute 'name'"),
        (f'<scenario name="a">{TRIGGER}</scenario>', "lacks its attribute 'type'"),
        ('<scenario name="a" type="A"/>', "'a' has 0 <trigger_point x y z yaw/> and needs one"),
        (f'<scenario name="a" type="A">{TRIGGER * 2}</scenario>', "'a' has 2 <trigger_point"),
        ('<scenario name="a" type="A"><trigger_point x="1" y="2" z="0"/></scenario>', "lacks its attribute 'yaw'"),
        (f'<scenario name="a" type="A">{TRIGGER}<distance/></scenario>', "<distance> gives no value"),
    ],
)
def test_a_scenario_that_cannot_wait_on_a_route_gets_a_sentence(scenario: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        read(scenario)
