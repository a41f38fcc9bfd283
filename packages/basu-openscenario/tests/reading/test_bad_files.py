"""What bad input gets: a sentence with file, line and what to do, before anything starts."""

import re
import time
from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading import xml_node
from basu_openscenario.reading.scenario_file import read_scenario
from openscenario_texts import (
    begins,
    event,
    lane_position,
    scenario,
    speed_action,
    story,
    vehicle,
    written,
)


def refused(path: Path) -> str:
    """Return the sentence of a file that cannot be read or played."""
    began = time.perf_counter()
    with pytest.raises(ScenarioError) as caught:
        make_player(read_scenario(path))
    assert time.perf_counter() - began < 5.0
    return str(caught.value)


def catalog(*entries: str) -> str:
    """Return the text of a catalog of vehicles."""
    return f"""<OpenSCENARIO><FileHeader revMajor="1" revMinor="2" date="" author="" description=""/>
      <Catalog name="Vehicles">{"".join(entries)}</Catalog></OpenSCENARIO>"""


def folder_of_catalogs(path: str) -> str:
    """Return the element that names a folder of catalogs."""
    return f'<VehicleCatalog><Directory path="{path}"/></VehicleCatalog>'


def reference(entry: str, catalog_name: str = "Vehicles") -> str:
    """Return an entity that is given by reference."""
    return (
        f'<ScenarioObject name="Ego"><CatalogReference catalogName="{catalog_name}" entryName="{entry}"/>'
        "</ScenarioObject>"
    )


def test_a_good_file_is_read_and_played(tmp_path):
    player = make_player(read_scenario(written(tmp_path, scenario())))
    assert sum(1 for _ in player.play()) > 900


def test_broken_xml_is_named_with_its_line(tmp_path):
    text = scenario().replace("</Entities>", "</Entity>")
    sentence = refused(written(tmp_path, text))
    line = next(n for n, one in enumerate(text.splitlines(), 1) if "</Entity>" in one)
    assert f"test.xosc:{line}: " in sentence
    assert "not well-formed XML" in sentence


@pytest.mark.parametrize("content", ["", "not xml at all", "<a/>", "\x00\x01\x02"])
def test_a_file_of_another_kind_is_refused(tmp_path, content):
    assert re.search(r"test\.xosc:1: ", refused(written(tmp_path, content)))


def test_bytes_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "test.xosc"
    path.write_bytes(b'<?xml version="1.0" encoding="utf-8"?><OpenSCENARIO a="\xff\xfe"/>')
    assert "not well-formed XML" in refused(path)


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    assert "give the path of a file that exists" in refused(tmp_path / "none.xosc")


def test_a_folder_is_refused(tmp_path):
    assert "cannot be read" in refused(tmp_path)


def test_an_entity_bomb_is_refused_at_once(tmp_path):
    bomb = '<!DOCTYPE a [<!ENTITY x0 "ha">' + "".join(f'<!ENTITY x{n} "{f"&x{n - 1};" * 10}">' for n in range(1, 12))
    text = scenario().replace('<?xml version="1.0"?>', f'<?xml version="1.0"?>{bomb}]>')
    text = text.replace('description="a test"', 'description="&x11;"')
    assert "remove it" in refused(written(tmp_path, text)) or "not well-formed" in refused(written(tmp_path, text))


def test_an_external_entity_is_not_read(tmp_path):
    (tmp_path / "secret.txt").write_text("SECRET", encoding="utf-8")
    text = scenario().replace(
        '<?xml version="1.0"?>', f'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY s SYSTEM "{tmp_path}/secret.txt">]>'
    )
    sentence = refused(written(tmp_path, text.replace("<Entities>", "<Entities>&s;")))
    assert "document type definition" in sentence
    assert "SECRET" not in sentence


def test_an_enormous_file_is_refused_before_it_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(xml_node, "LARGEST_FILE_BYTES", 2 * 2**20)
    path = written(tmp_path, scenario() + " " * 3 * 2**20)
    assert "files up to 2 MiB are read" in refused(path)


def test_elements_that_nest_without_end_are_refused(tmp_path):
    text = scenario().replace("<Entities>", "<Entities>" + "<a>" * 200 + "</a>" * 200)
    assert re.search(r"test\.xosc:\d+: elements nest deeper than 64 levels", refused(written(tmp_path, text)))


@pytest.mark.parametrize("revision", [(0, 9), (1, 9), (2, 0)])
def test_a_version_that_is_not_known_is_refused(tmp_path, revision):
    sentence = refused(written(tmp_path, scenario(revision=revision)))
    assert f"version {revision[0]}.{revision[1]} is unknown" in sentence
    assert "1.0, 1.1, 1.2, 1.3" in sentence


def test_a_parameter_that_is_not_declared_is_named(tmp_path):
    sentence = refused(written(tmp_path, scenario(init=begins("Ego", "$start", 10))))
    assert re.search(r"test\.xosc:\d+: .*'start' is not declared here", sentence)


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        ("${1/0}", "has no value"),
        ("${sqrt(-1)}", "has no value"),
        ("${2 + }", "ends early"),
        ("${" + "(" * 500 + "1" + ")" * 500 + "}", "nests more than"),
        ("${pow(10, 400)}", "has no value"),
        ("fast", "is no number"),
        ("NaN", "is no number"),
    ],
)
def test_an_expression_without_a_value_is_named(tmp_path, expression, words):
    sentence = refused(written(tmp_path, scenario(init=begins("Ego", 50, expression))))
    assert words in sentence
    assert re.search(r"test\.xosc:\d+: ", sentence)


def test_a_parameter_outside_its_type_is_refused(tmp_path):
    declared = '<ParameterDeclaration name="v" parameterType="double" value="quick"/>'
    assert "'quick' of 'v' is no double" in refused(written(tmp_path, scenario(parameters=declared)))


def test_a_value_that_is_given_for_no_parameter_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match="declares no parameter 'w'"):
        read_scenario(written(tmp_path, scenario()), {"w": "1"})


def test_a_catalog_without_a_folder_is_refused(tmp_path):
    sentence = refused(written(tmp_path, scenario(entities=reference("car"), catalogs=folder_of_catalogs("nowhere"))))
    assert "which does not exist" in sentence


def test_a_catalog_that_is_not_located_is_refused(tmp_path):
    assert "<CatalogLocations> has no folder" in refused(written(tmp_path, scenario(entities=reference("car"))))


def test_an_entry_that_a_catalog_lacks_is_refused_with_those_it_has(tmp_path):
    (tmp_path / "catalogs").mkdir()
    (tmp_path / "catalogs" / "c.xosc").write_text(catalog('<Vehicle name="bus"/>'), encoding="utf-8")
    text = scenario(entities=reference("car"), catalogs=folder_of_catalogs("catalogs"))
    assert "has no entry 'car'; it has bus" in refused(written(tmp_path, text))


def test_catalog_references_in_a_circle_are_refused(tmp_path):
    (tmp_path / "catalogs").mkdir()
    circle = [
        f'<CatalogReference name="{one}" catalogName="Vehicles" entryName="{other}"/>'
        for one, other in (("a", "b"), ("b", "a"))
    ]
    (tmp_path / "catalogs" / "c.xosc").write_text(catalog(*circle), encoding="utf-8")
    text = scenario(entities=reference("a"), catalogs=folder_of_catalogs("catalogs"))
    assert "go in a circle" in refused(written(tmp_path, text))


def test_a_broken_catalog_is_named_with_its_own_file(tmp_path):
    (tmp_path / "catalogs").mkdir()
    (tmp_path / "catalogs" / "c.xosc").write_text("<OpenSCENARIO>", encoding="utf-8")
    text = scenario(entities=reference("a"), catalogs=folder_of_catalogs("catalogs"))
    assert "c.xosc:1: this is not well-formed XML" in refused(written(tmp_path, text))


def test_a_road_network_that_does_not_exist_is_refused(tmp_path):
    sentence = refused(written(tmp_path, scenario(road="other.xodr")))
    assert re.search(r"test\.xosc:\d+: the road network .*other\.xodr does not exist", sentence)


def test_a_road_network_without_a_road_is_refused(tmp_path):
    (tmp_path / "empty.xodr").write_text('<OpenDRIVE><header revMajor="1" revMinor="6"/></OpenDRIVE>', encoding="utf-8")
    assert "empty.xodr" in refused(written(tmp_path, scenario(road="empty.xodr")))


def test_an_endless_road_is_refused(tmp_path):
    path = written(tmp_path, scenario(road="long.xodr"))
    road = (tmp_path / "straight.xodr").read_text(encoding="utf-8").replace('"1000"', '"1e15"')
    (tmp_path / "long.xodr").write_text(road, encoding="utf-8")
    assert "long.xodr" in refused(path)


def test_an_entity_without_a_name_of_its_own_is_refused(tmp_path):
    assert "two entities are called 'Ego'" in refused(
        written(tmp_path, scenario(entities=vehicle("Ego") + vehicle("Ego")))
    )


def test_an_actor_that_is_no_entity_is_refused(tmp_path):
    text = scenario(stories=story("Ghost", event("e", speed_action(5))))
    assert re.search(r"test\.xosc:\d+: .*'Ghost'", refused(written(tmp_path, text)))


def test_an_action_that_is_not_supported_is_refused_by_name(tmp_path):
    text = scenario(stories=story("Ego", event("e", "<FlyAction/>")))
    assert re.search(
        r"test\.xosc:\d+: <FlyAction> is not supported as a private action", refused(written(tmp_path, text))
    )


def test_a_condition_that_is_not_supported_is_refused_by_name(tmp_path):
    start = """<ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByValueCondition>
      <MoonCondition/></ByValueCondition></Condition></ConditionGroup>"""
    text = scenario(stories=story("Ego", event("e", speed_action(5), start)))
    assert re.search(r"test\.xosc:\d+: <MoonCondition> is not supported", refused(written(tmp_path, text)))


@pytest.mark.parametrize(("lane", "words"), [(7, "has no lane 7"), (-9, "has no lane -9")])
def test_a_lane_that_the_road_lacks_is_refused_when_the_file_is_played(tmp_path, lane, words):
    player = make_player(read_scenario(written(tmp_path, scenario(init=begins("Ego", 50, 10, lane)))))
    with pytest.raises(ScenarioError, match=words):
        player.step(0.0)


def test_an_endless_trajectory_is_refused(tmp_path):
    shape = f"""<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape>
      <Clothoid curvature="0" curvatureDot="0" length="1e12">{lane_position(50)}</Clothoid>
    </Shape></Trajectory></TrajectoryRef><TimeReference><None/></TimeReference>
    <TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>"""
    text = scenario(stories=story("Ego", event("e", shape)))
    assert "test.xosc" in refused(written(tmp_path, text))


def play_refused(path: Path) -> str:
    """Return the sentence with which the playing of a file ends."""
    with pytest.raises(ScenarioError) as caught:
        list(make_player(read_scenario(path)).play())
    return str(caught.value)


def test_a_place_that_does_not_exist_is_named_with_the_line_of_its_action(tmp_path):
    elsewhere = lane_position(50).replace('roadId="1"', 'roadId="7"')
    action = f"<TeleportAction>{elsewhere}</TeleportAction>"
    sentence = play_refused(written(tmp_path, scenario(stories=story("Ego", event("e", action)))))
    assert re.search(r"test\.xosc:\d+: .* has no road '7'", sentence)


def test_a_place_that_does_not_exist_is_named_with_the_line_of_its_condition(tmp_path):
    start = f"""<ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByEntityCondition>
      <TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/></TriggeringEntities>
      <EntityCondition><ReachPositionCondition tolerance="2">{lane_position(50, 9)}</ReachPositionCondition>
      </EntityCondition></ByEntityCondition></Condition></ConditionGroup>"""
    sentence = play_refused(written(tmp_path, scenario(stories=story("Ego", event("e", speed_action(5), start)))))
    assert re.search(r"test\.xosc:\d+: .* has no lane 9", sentence)


def test_a_lateral_distance_with_limits_is_refused_with_its_line(tmp_path):
    action = """<LateralAction><LateralDistanceAction entityRef="Ego" distance="2" freespace="false" continuous="true">
      <DynamicConstraints maxSpeed="1" maxAcceleration="1" maxDeceleration="1"/>
    </LateralDistanceAction></LateralAction>"""
    sentence = refused(written(tmp_path, scenario(stories=story("Ego", event("e", action)))))
    assert re.search(r"test\.xosc:\d+: the LateralDistanceAction", sentence)


@pytest.mark.parametrize("content", ["", "no road", "<OpenDRIVE>", "<OpenSCENARIO/>"])
def test_a_road_network_that_is_no_road_network_is_named_with_its_line(tmp_path, content):
    path = written(tmp_path, scenario(road="broken.xodr"))
    (tmp_path / "broken.xodr").write_text(content, encoding="utf-8")
    assert re.search(r"broken\.xodr:1: ", refused(path))


def test_an_entity_bomb_in_a_road_network_is_refused_at_once(tmp_path):
    path = written(tmp_path, scenario(road="bomb.xodr"))
    bomb = '<!DOCTYPE a [<!ENTITY x0 "ha">' + "".join(f'<!ENTITY x{n} "{f"&x{n - 1};" * 10}">' for n in range(1, 12))
    road = (tmp_path / "straight.xodr").read_text(encoding="utf-8")
    text = road.replace('<?xml version="1.0"?>', f'<?xml version="1.0"?>{bomb}]>').replace('"straight"', '"&x11;"')
    (tmp_path / "bomb.xodr").write_text(text, encoding="utf-8")
    assert re.search(r"bomb\.xodr:\d+: ", refused(path))


def test_an_enormous_road_network_is_refused_before_it_is_read(tmp_path, monkeypatch):
    path = written(tmp_path, scenario(road="large.xodr"))
    (tmp_path / "large.xodr").write_bytes(b" " * 3 * 2**20)
    monkeypatch.setattr(xml_node, "LARGEST_FILE_BYTES", 2 * 2**20)
    assert "large.xodr has 3 MiB; files up to 2 MiB are read" in refused(path)


def test_a_parameter_that_is_its_own_value_is_named(tmp_path):
    declared = '<ParameterDeclaration name="v" parameterType="double" value="$v"/>'
    assert re.search(
        r"test\.xosc:\d+: .*'v' is not declared here", refused(written(tmp_path, scenario(parameters=declared)))
    )


@pytest.mark.parametrize(
    ("references", "words"), [({"a": "b", "b": "a"}, "go in a circle"), ({"a": "c"}, "'c', which does not exist")]
)
def test_controllers_of_signals_with_bad_references_are_named(tmp_path, references, words):
    controllers = "".join(
        f"""<TrafficSignalController name="{one}" reference="{other}" delay="1"><Phase name="p" duration="5">
        <TrafficSignalState trafficSignalId="1" state="green"/></Phase></TrafficSignalController>"""
        for one, other in references.items()
    )
    text = scenario().replace("</RoadNetwork>", f"<TrafficSignals>{controllers}</TrafficSignals></RoadNetwork>")
    sentence = refused(written(tmp_path, text))
    assert re.search(rf"test\.xosc:\d+: .*{words}", sentence)
