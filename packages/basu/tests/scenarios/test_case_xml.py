"""Claims about scenario files: ScenarioRunner's are read as they are, ours add a little, bad ones get sentences."""

import math
from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.scenarios.case_xml import read_cases
from basu.scenarios.stage import Pose
from basu.scenarios.xml_elements import Case

EGO = '<ego_vehicle x="1" y="2" z="0.5" yaw="90"/>'

THEIRS = """<?xml version="1.0"?>
<scenarios>
    <!-- a comment, and the attributes in the order of ScenarioRunner's files -->
    <scenario name="FollowLeadingVehicle_1" type="FollowLeadingVehicle" town="Linden">
        <ego_vehicle x="-31.5  " y="12" z="0.5" yaw="-90" model="vehicle.lincoln.mkz_2017" rolename="hero"/>
\t<other_actor x="-31.5" y="-20" z="-500" yaw="270" model="vehicle.tesla.model3" color="255,0,0" speed="4"/>
        <other_actor x="0" y="0" yaw="0"/>
        <weather cloudiness="0" precipitation="0" wind_intensity="0" sun_azimuth_angle="0" sun_altitude_angle="75" />
        <route>
            <waypoint x="-31.5" y="12" z="0" connection="RoadOption.LANEFOLLOW"/>
            <waypoint x="-31.5" y="-60" z="0" connection="RoadOption.LEFT"/>
        </route>
        <flow_speed value="30"/>
        <source_dist_interval from="35" to="50"/>
        <start_actor_flow x="16.2" y="220.6" z="0.2"/>
    </scenario>
    <scenario name="FollowLeadingVehicle_2" type="FollowLeadingVehicle" town="Linden">
        <ego_vehicle x="1" y="2" z="0.5" yaw="0" model="vehicle.lincoln.mkz_2017" />
    </scenario>
</scenarios>
"""

OURS = """<scenarios>
  <scenario name="parked_car_1" type="ParkedCar" town="Linden">
    <place name="Cleveland Ave at 8th Ave" route="true"/>
    <ego_vehicle x="1" y="2" yaw="90"/>
    <via x="1" y="40"/>
    <destination x="1" y="120" z="3"/>
    <trigger_point x="1" y="30" z="0.5" yaw="90"/>
    <ahead value=" 40 "/>
  </scenario>
</scenarios>
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "cases.xml"
    path.write_text(text)
    return path


def one(folder: Path, inside: str, attributes: str = 'name="a_1" type="A" town="Linden"') -> Case:
    (case,) = read_cases(written(folder, f"<scenarios>\n<scenario {attributes}>{inside}</scenario>\n</scenarios>"))
    return case


def test_a_file_in_scenario_runners_format_is_read_unchanged(tmp_path: Path) -> None:
    first, second = read_cases(written(tmp_path, THEIRS))
    assert (first.name, first.type, first.town) == ("FollowLeadingVehicle_1", "FollowLeadingVehicle", "Linden")
    assert first.ego.pose == Pose(-31.5, 12.0, 0.5, math.radians(-90.0))
    assert (first.ego.model, first.ego.role) == ("vehicle.lincoln.mkz_2017", "hero")
    leader, other = first.others
    assert (leader.role, leader.model, leader.speed_mps) == ("scenario", "vehicle.tesla.model3", 4.0)
    assert leader.attributes == (("color", "255,0,0"),)
    assert other.model == "vehicle.*"
    assert first.weather == {
        "cloudiness": 0.0,
        "precipitation": 0.0,
        "wind_intensity": 0.0,
        "sun_azimuth_angle": 0.0,
        "sun_altitude_angle": 75.0,
    }
    assert first.values == {
        "flow_speed": "30",
        "source_dist_interval_from": "35",
        "source_dist_interval_to": "50",
        "start_actor_flow_x": "16.2",
        "start_actor_flow_y": "220.6",
        "start_actor_flow_z": "0.2",
    }
    assert (second.weather, second.way, second.others, second.trigger, dict(second.values)) == (None, (), (), None, {})


def test_the_way_point_at_the_ego_is_where_it_stands_and_not_on_its_way(tmp_path: Path) -> None:
    first, _ = read_cases(written(tmp_path, THEIRS))
    assert first.way == (Pose(-31.5, -60.0, 0.0, 0.0),)


def test_our_elements_say_where_it_is_where_it_goes_and_what_arms_it(tmp_path: Path) -> None:
    (case,) = read_cases(written(tmp_path, OURS))
    assert (case.place, case.on_route) == ("Cleveland Ave at 8th Ave", True)
    assert case.way == (Pose(1.0, 40.0), Pose(1.0, 120.0, 3.0))
    assert case.trigger == Pose(1.0, 30.0, 0.5, math.pi / 2)
    assert case.values == {"ahead": "40"}
    assert case.ego.model == "vehicle.easymile.ez10"
    assert case.source == f"{tmp_path / 'cases.xml'}, line 2"


@pytest.mark.parametrize(
    ("inside", "sentence"),
    [
        ("", "'a_1' has no <ego_vehicle"),
        (EGO + EGO, "<ego_vehicle> stands 2 times in one <scenario>; one vehicle is under test here"),
        ('<ego_vehicle x="1" y="2"/>', "line 2: <ego_vehicle> lacks its attribute 'yaw'"),
        ('<ego_vehicle x="1" y="two" yaw="0"/>', "<ego_vehicle> has y='two', which is no number"),
        ('<ego_vehicle x="nan" y="2" yaw="0"/>', "has x='nan', which is no number"),
        ('<ego_vehicle x="1" y="2" yaw="0" modle="a"/>', "has the attribute 'modle', .* did you mean 'model'"),
        ('<ego_vehicle x="1" y="2" yaw="0" speed="4"/>', "has the attribute 'speed', which is not read here"),
        ('<ego_vehicle x="1" y="2" yaw="0" rolename="hero2"/>', "rolename='hero2'; the vehicle under test is 'hero'"),
        (EGO + '<other_actor x="1" y="2" yaw="0" autopilot="true"/>', "has the attribute 'autopilot'"),
        (EGO + '\n<weather rain="4"/>', "line 3: <weather> has the attribute 'rain', .*it may have cloudiness"),
        (EGO + '<weather cloudines="4"/>', "did you mean 'cloudiness'"),
        (EGO + '<weather cloudiness="much"/>', "has cloudiness='much', which is no number"),
        (EGO + "<weather/><weather/>", "<weather> stands 2 times"),
        (EGO + "<distance/>", 'gives no value; write <distance value="…"/>'),
        (EGO + '<distance value="1"/><distance value="2"/>', "gives 'distance' a second time"),
        (EGO + '<via x="1" y="2"/>', "<via> is on the way to nowhere; add <destination"),
        (EGO + '<destination x="1" y="2"/><route><waypoint x="1" y="9"/></route>', "both say where the ego is bound"),
        (EGO + '<route><waypoint x="1" y="2"/></route>', "no way point behind the ego's place"),
        (EGO + '<trigger_point x="1" y="2"/>', "<trigger_point> lacks its attribute 'yaw'"),
        (EGO + '<place name="here" route="yes"/>', "route='yes'; write true or false"),
        (EGO + '<place route="true"/>', "<place> lacks its attribute 'name'"),
    ],
)
def test_a_case_that_cannot_be_one_gets_a_sentence_with_its_line(tmp_path: Path, inside: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence) as raised:
        one(tmp_path, inside)
    assert "cases.xml, line " in str(raised.value)


@pytest.mark.parametrize(
    ("attributes", "sentence"),
    [
        ('type="A" town="Linden"', "<scenario> lacks its attribute 'name'"),
        ('name="a" town="Linden"', "<scenario> lacks its attribute 'type'"),
        ('name="a" type="A"', "<scenario> lacks its attribute 'town'"),
        ('name="a" type="A" town=" "', "<scenario> lacks its attribute 'town'"),
        ('name="a:b" type="A" town="Linden"', "the name 'a:b'; letters, digits"),
        ('name="../a" type="A" town="Linden"', "it names a folder"),
        ('name="a" type="A" town="Linden" Town="L"', "has the attribute 'Town', .*did you mean 'town'"),
    ],
)
def test_a_scenario_needs_name_type_and_town(tmp_path: Path, attributes: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        one(tmp_path, EGO, attributes)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "is empty; it needs <scenarios>"),
        ("<scenarios><scenario>", "is not XML: .*line 1"),
        ("name,type,town", "is not XML"),
        ("<routes/>", "is a route file .*basu run --routes cases.xml"),
        ("<OpenSCENARIO/>", "the outermost element is <OpenSCENARIO>; OpenSCENARIO, which is not read"),
        ("<html/>", "the outermost element is <html>; a scenario file is <scenarios>"),
        ("<scenarios/>", "<scenarios> holds no <scenario>"),
    ],
)
def test_a_file_that_is_none_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        read_cases(written(tmp_path, text))


def test_a_file_that_is_not_there_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"none\.xml cannot be read \(No such file or directory\)"):
        read_cases(tmp_path / "none.xml")


def test_two_cases_of_one_name_are_reported_with_both_lines(tmp_path: Path) -> None:
    case = f'<scenario name="a_1" type="A" town="Linden">{EGO}</scenario>\n'
    with pytest.raises(ScenarioError, match=r"line 3: the name 'a_1' is given in .*line 2 already"):
        read_cases(written(tmp_path, f"<scenarios>\n{case}{case}</scenarios>"))


def test_service_stops_lie_on_the_way_and_are_no_values(tmp_path: Path) -> None:
    case = one(tmp_path, f'{EGO}<stop name="8th Ave" x="1" y="60"/><destination x="1" y="120"/>')
    assert [(stop.name, stop.point.x_m, stop.point.y_m) for stop in case.stops] == [("8th Ave", 1.0, 60.0)]
    assert not case.values
    with pytest.raises(ScenarioError, match="<stop> lacks its attribute 'name'"):
        one(tmp_path, f'{EGO}<stop x="1" y="60"/>')
