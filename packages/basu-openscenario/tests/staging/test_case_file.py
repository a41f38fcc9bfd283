"""OpenSCENARIO files as cases: the class of a file, its parameters, its ego with its way, and what is refused."""

import math

import pytest

from basu.errors import ScenarioError, UserError
from basu.scenarios.cases import by_id, cases_of, is_led_by_file
from basu.scenarios.parameters import Choice, Number
from basu_openscenario.playing.mover import Mover
from basu_openscenario.reading.entities import BoundingBox, Entity, Performance
from basu_openscenario.roads.network import Network
from basu_openscenario.roads.place import Place
from basu_openscenario.staging.bodies import ADULT, CHILD, blueprint_of, middle_of, reference_of
from basu_openscenario.staging.refusals import light_of
from openscenario_texts import at_time, begins, event, lane_change, scenario, story, vehicle, written

NUMBER = """<ParameterDeclaration name="speed" parameterType="double" value="10"><ConstraintGroup>
  <ValueConstraint rule="greaterOrEqual" value="5"/><ValueConstraint rule="lessOrEqual" value="20"/>
</ConstraintGroup></ParameterDeclaration>
<ParameterDeclaration name="quick" parameterType="boolean" value="true"/>
<ParameterDeclaration name="word" parameterType="string" value="hello"/>"""


def two(**more):
    """Return the text of a file with an ego and another vehicle ahead."""
    return scenario(
        entities=vehicle("Other") + vehicle("Ego"),
        init=begins("Other", 120, "$speed") + begins("Ego", 50, 10),
        parameters=NUMBER,
        **more,
    )


@pytest.mark.usefixtures("plugin")
def test_a_file_is_a_case_with_a_class_of_its_own(tmp_path):
    path = written(tmp_path, two(), "cut-in.xosc")
    (playable,) = cases_of([str(path)])
    case = playable.case
    assert (case.name, case.town, case.map_file) == ("cut-in", "straight", tmp_path / "straight.xodr")
    assert playable.scenario.__name__ == "CutInXosc"
    assert playable.scenario.title() == "a test"
    assert playable.values == {"ego": "Ego", "driver": "agent", "speed": 10.0, "quick": "true"}


@pytest.mark.usefixtures("plugin")
def test_parameters_of_the_file_are_parameters_of_the_case(tmp_path):
    (playable,) = cases_of([str(written(tmp_path, two()))])
    by_name = {one.name: one for one in playable.scenario.parameters}
    assert isinstance(by_name["speed"], Number)
    assert (by_name["speed"].low, by_name["speed"].high) == (5.0, 20.0)
    assert isinstance(by_name["quick"], Choice)
    assert "word" not in by_name


@pytest.mark.usefixtures("plugin")
def test_the_ego_stands_where_the_file_puts_it_and_has_its_way(tmp_path):
    (playable,) = cases_of([str(written(tmp_path, two()))])
    ego = playable.case.ego
    assert (ego.pose.x_m, ego.pose.y_m, ego.pose.yaw_rad) == pytest.approx((51.4, 1.75, 0.0))
    assert playable.case.way[-1].x_m == pytest.approx(250.0, abs=1.0)  # 100 m beyond the last place
    assert {round(point.y_m, 6) for point in playable.case.way} == {1.75}


@pytest.mark.usefixtures("plugin")
def test_another_entity_may_be_the_ego(tmp_path):
    path = written(tmp_path, two(), "t.xosc")
    case = by_id("t:ego=Other,speed=20", [path]).case
    assert case.ego.pose.x_m == pytest.approx(121.4)
    assert case.way[-1].x_m == pytest.approx(420.0, abs=1.0)


@pytest.mark.usefixtures("plugin")
def test_an_ego_that_the_file_lacks_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match="it must be one of Ego, Other"):
        by_id("t:ego=Bus", [written(tmp_path, two(), "t.xosc")])


@pytest.mark.usefixtures("plugin")
def test_a_way_keeps_its_lane_though_the_entity_changes_it(tmp_path):
    changes = story("Ego", event("e", lane_change(-2, 3), at_time(2)))
    (playable,) = cases_of([str(written(tmp_path, two(stories=changes)))])
    assert {round(point.y_m, 6) for point in playable.case.way} == {1.75}


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize(
    ("action", "element"),
    [
        ('<VisibilityAction graphics="false" sensors="true" traffic="true"/>', "VisibilityAction"),
        ('<VisibilityAction graphics="true" sensors="false" traffic="true"/>', "VisibilityAction"),
    ],
)
def test_what_a_simulator_cannot_show_is_refused_with_its_line(tmp_path, action, element):
    path = written(tmp_path, two(stories=story("Ego", event("e", action))))
    with pytest.raises(ScenarioError, match=rf"test\.xosc:\d+: <{element}> is not supported in the simulator"):
        cases_of([str(path)])


@pytest.mark.usefixtures("plugin")
def test_a_storyboard_that_is_over_at_once_is_refused(tmp_path):
    text = two().replace(at_time(10), at_time(0, "greaterOrEqual"))
    with pytest.raises(ScenarioError, match="is over before it begins"):
        cases_of([str(written(tmp_path, text))])


@pytest.mark.usefixtures("plugin")
def test_a_file_without_a_vehicle_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match="no vehicle that an agent can drive"):
        cases_of([str(written(tmp_path, scenario(entities="", init="")))])


def test_without_the_plugin_its_installation_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr("basu.plugins.is_installed", lambda *_: False)
    with pytest.raises(UserError, match="pip install basu-openscenario"):
        cases_of([str(written(tmp_path, two()))])


@pytest.mark.parametrize(
    ("words", "is_led"),
    [
        (["a.xosc"], True),
        (["a.xosc", "b.xosc"], True),
        (["a.xosc", "all"], False),
        (["a.xml"], False),
        (["all"], False),
    ],
)
def test_only_files_of_a_plugin_move_an_ego(words, is_led):
    assert is_led_by_file(words) == is_led


@pytest.mark.parametrize(
    ("state", "light"),
    [
        ("green", "Green"),
        ("RED", "Red"),
        ("amber", "Yellow"),
        ("off;off;on", "Green"),
        ("on;on;off", "Yellow"),
        ("off;off;off", "Off"),
        ("on;off", "Red"),
        ("blink", None),
        ("on;off;off;off", None),
        ("on;dark;off", None),
    ],
)
def test_states_of_signals_are_states_of_lights(state, light):
    assert light_of(state) == light


def entity(kind, category="", height_m=1.6, model=""):
    """Return an entity with a box that is not about its reference point."""
    return Entity("e", kind, category, BoundingBox((1.4, 0.2, 0.8), 4.4, 1.8, height_m), Performance(), model=model)


@pytest.mark.parametrize(
    ("one", "blueprint"),
    [
        (entity("vehicle", "car"), "vehicle.nissan.micra"),
        (entity("vehicle", "bicycle"), "vehicle.gazelle.omafiets"),
        (entity("vehicle", "car", model="vehicle.tesla.model3"), "vehicle.tesla.model3"),
        (entity("pedestrian", height_m=1.8), ADULT),
        (entity("pedestrian", height_m=1.2), CHILD),
        (entity("miscellaneous", "barrier"), "static.prop.streetbarrier"),
    ],
)
def test_an_entity_has_the_blueprint_of_its_kind(one, blueprint):
    assert blueprint_of(one) == blueprint


@pytest.mark.parametrize("h_rad", [0.0, 0.7, -2.0, math.pi])
def test_the_middle_of_a_box_leads_back_to_the_reference_point(tmp_path, h_rad):
    mover = Mover(entity("vehicle"), Place(Network(tmp_path), x_m=3.0, y_m=-4.0, h_rad=h_rad))
    middle = middle_of(mover)
    back = reference_of(middle.x_m, middle.y_m, middle.yaw_rad, mover.entity)
    assert (back.x_m, back.y_m) == pytest.approx((3.0, -4.0))
    assert math.remainder(back.h_rad - h_rad, math.tau) == pytest.approx(0.0, abs=1e-12)
    assert math.dist((middle.x_m, -middle.y_m), (3.0, -4.0)) == pytest.approx(math.hypot(1.4, 0.2))
