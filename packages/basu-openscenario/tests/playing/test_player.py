"""The kinematic mode against closed forms: speeds, lane changes, triggers, an agent's entity."""

import math

import pytest

from basu_openscenario.playing.mover import Given
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from openscenario_texts import (
    at_time,
    begins,
    event,
    lane_change,
    lane_position,
    scenario,
    speed_action,
    story,
    vehicle,
    written,
)


def player_of(folder, text):
    """Return the player of a file that is written with this content."""
    return make_player(read_scenario(written(folder, text)))


def played(folder, text, step_s=0.01):
    """Return the poses of the ego by time, rounded to milliseconds."""
    player = player_of(folder, text)
    return {round(frame.time_s, 3): frame.poses[0] for frame in player.play(step_s)}


def test_an_entity_goes_on_with_its_speed(tmp_path):
    poses = played(tmp_path, scenario())
    assert poses[0.0].x_m == pytest.approx(50.0)
    assert poses[5.0].x_m == pytest.approx(100.0, abs=1e-9)
    assert poses[5.0].y_m == pytest.approx(-1.75)
    assert max(poses) == pytest.approx(10.01)  # the stop is later than 10 s, as esmini has it


def test_against_the_road_an_entity_looks_along_its_lane(tmp_path):
    poses = played(tmp_path, scenario(init=begins("Ego", 500, 10, lane=1)))
    assert abs(math.remainder(poses[0.0].h_rad - math.pi, math.tau)) < 1e-9
    assert poses[5.0].x_m == pytest.approx(450.0)


@pytest.mark.parametrize(
    ("shape", "halfway"), [("linear", 15.0), ("sinusoidal", 15.0), ("cubic", 15.0)], ids=["line", "sine", "cubic"]
)
def test_a_speed_changes_along_its_shape(tmp_path, shape, halfway):
    text = scenario(stories=story("Ego", event("e", speed_action(20, shape, 4), at_time(1))))
    poses = played(tmp_path, text)
    began = next(t for t, pose in poses.items() if pose.speed_mps > 10.0) - 0.01
    assert poses[round(began + 2.0, 3)].speed_mps == pytest.approx(halfway, abs=0.05)
    assert poses[round(began + 4.05, 3)].speed_mps == pytest.approx(20.0)


def test_a_linear_change_of_speed_covers_its_way(tmp_path):
    poses = played(tmp_path, scenario(stories=story("Ego", event("e", speed_action(20, "linear", 4), at_time(1)))))
    began = next(t for t, pose in poses.items() if pose.speed_mps > 10.0) - 0.01
    way_m = poses[round(began + 4.0, 3)].x_m - poses[round(began, 3)].x_m
    assert way_m == pytest.approx(60.0, abs=0.06)  # one step of 10 ms


@pytest.mark.parametrize("shape", ["linear", "sinusoidal", "cubic"])
def test_a_lane_change_ends_in_the_middle_of_the_lane(tmp_path, shape):
    poses = played(tmp_path, scenario(stories=story("Ego", event("e", lane_change(-2, 3, shape), at_time(1)))))
    assert poses[9.0].y_m == pytest.approx(-5.25, abs=1e-6)
    assert poses[9.0].h_rad == pytest.approx(0.0, abs=1e-6)
    lengths = [
        math.dist((a.x_m, a.y_m), (b.x_m, b.y_m))
        for a, b in zip(list(poses.values())[:-1], list(poses.values())[1:], strict=True)
    ]
    assert max(abs(length - 0.1) for length in lengths) < 1e-3  # its speed over ground stays


def test_the_steps_may_be_longer_with_nearly_the_same_result(tmp_path):
    text = scenario(stories=story("Ego", event("e", lane_change(-2, 3), at_time(1))))
    fine, coarse = played(tmp_path, text, 0.005), played(tmp_path, text, 0.05)
    assert coarse[9.0].x_m == pytest.approx(fine[9.0].x_m, abs=0.05)
    assert coarse[9.0].y_m == pytest.approx(fine[9.0].y_m, abs=1e-6)


def test_an_event_follows_another_one(tmp_path):
    after = """<ConditionGroup><Condition name="c" delay="1" conditionEdge="none"><ByValueCondition>
      <StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="first"
        state="completeState"/>
    </ByValueCondition></Condition></ConditionGroup>"""
    events = event("first", speed_action(0), at_time(2)), event("second", speed_action(5), after)
    player = player_of(tmp_path, scenario(stories=story("Ego", *events)))
    list(player.play())
    begun = {one.path.rsplit("::")[-1]: one.time_s for one in player.changes if one.transition == "startTransition"}
    assert begun["second"] - begun["first"] == pytest.approx(1.0, abs=0.03)


def test_a_condition_of_distance_begins_an_event(tmp_path):
    near = """<ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByEntityCondition>
      <TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/></TriggeringEntities>
      <EntityCondition><RelativeDistanceCondition entityRef="Other" relativeDistanceType="longitudinal" value="20"
        freespace="true" rule="lessThan" coordinateSystem="entity"/></EntityCondition>
    </ByEntityCondition></Condition></ConditionGroup>"""
    text = scenario(
        entities=vehicle("Ego") + vehicle("Other"),
        init=begins("Ego", 50, 10) + begins("Other", 100, 0),
        stories=story("Ego", event("brake", speed_action(0), near)),
    )
    poses = played(tmp_path, text)
    assert poses[9.0].x_m == pytest.approx(100.0 - 4.4 - 20.0, abs=0.2)  # bumper to bumper, at most two steps later


@pytest.mark.parametrize(("mode", "is_over"), [("on", True), ("flashing", False)])
def test_a_flashing_light_goes_on(tmp_path, mode, is_over):
    light = f"""<AppearanceAction><LightStateAction transitionTime="1"><LightType>
      <VehicleLight vehicleLightType="indicatorLeft"/></LightType><LightState mode="{mode}"/>
    </LightStateAction></AppearanceAction>"""
    player = player_of(tmp_path, scenario(stories=story("Ego", event("light", light, at_time(1)))))
    list(player.play(longest_s=5.0))
    ends = [one for one in player.changes if one.kind == "action" and one.transition == "endTransition"]
    assert bool(ends) == is_over
    if is_over:
        assert ends[0].time_s == pytest.approx(2.02, abs=0.011)


def test_a_light_ends_the_flashing_of_the_other_side(tmp_path):
    def light(side):
        return f"""<AppearanceAction><LightStateAction><LightType><VehicleLight vehicleLightType="indicator{side}"/>
          </LightType><LightState mode="flashing"/></LightStateAction></AppearanceAction>"""

    events = event("left", light("Left"), at_time(1)), event("right", light("Right"), at_time(3))
    player = player_of(tmp_path, scenario(stories=story("Ego", *events)))
    list(player.play(longest_s=5.0))
    ends = [one for one in player.changes if one.kind == "action" and one.transition == "endTransition"]
    assert [(one.path.rsplit("::")[-1], pytest.approx(one.time_s, abs=0.02)) for one in ends] == [("leftAction", 3.01)]


def test_a_height_from_an_entity_is_above_that_entity(tmp_path):
    above = """<TeleportAction><Position><RelativeObjectPosition entityRef="Other" dx="1" dy="2" dz="0.5">
      <Orientation type="relative" h="0" r="0.3"/></RelativeObjectPosition></Position></TeleportAction>"""
    private = f'<Private entityRef="Ego"><PrivateAction>{above}</PrivateAction></Private>'
    text = scenario(entities=vehicle("Other") + vehicle("Ego"), init=begins("Other", 100, 0) + private)
    pose = next(player_of(tmp_path, text).play()).poses[1]
    assert (pose.x_m, pose.y_m, pose.z_m, pose.r_rad) == pytest.approx((101.0, 0.25, 0.5, 0.3))


def test_an_entity_of_an_agent_goes_where_the_agent_drives_it(tmp_path):
    text = scenario(stories=story("Ego", event("e", lane_change(-2, 3), at_time(1))))
    player = player_of(tmp_path, text)
    player.step(0.0)
    mover = player.world.mover("Ego")
    mover.given = Given(50.0, -1.0, 0.1, 5.0, 0.0)
    for nth in range(1, 201):
        player.step(0.01)
        assert (mover.place.x_m, mover.place.y_m) == pytest.approx((50.0 + 0.05 * nth, -1.0))
    assert mover.speed_mps == pytest.approx(5.0 * math.cos(0.1))
    assert mover.travelled_m == pytest.approx(10.0)


def test_a_file_without_an_end_is_played_as_long_as_asked(tmp_path):
    text = scenario().replace(f"<StopTrigger>{at_time(10)}</StopTrigger>", "<StopTrigger/>")
    player = player_of(tmp_path, text)
    times = [frame.time_s for frame in player.play(0.1, 3.0)]
    assert times[-1] == pytest.approx(3.0)
    assert not player.is_over


def test_a_place_in_a_lane_may_be_given_by_a_parameter(tmp_path):
    declared = '<ParameterDeclaration name="s" parameterType="double" value="70"/>'
    text = scenario(parameters=declared, init=begins("Ego", "${$s / 2}", 10))
    assert played(tmp_path, text)[0.0].x_m == pytest.approx(35.0)
    assert lane_position("${$s / 2}") in text
