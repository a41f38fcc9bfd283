"""Claims about the questions that ScenarioRunner's metrics ask, on a recording whose every number is known."""

import struct
from pathlib import Path

import carla
import numpy as np
import pytest

from basu_carla_log import read_log
from basu_carla_log.layouts import NO_ACTOR
from basu_carla_log.metrics_log import MetricsLog
from fakes import recordings as made

HERO, OTHER, WALKER, LIGHT = 9, 8, 3, 5


@pytest.fixture
def log(tmp_path: Path) -> MetricsLog:
    """Three frames, half a second apart: the hero drives east, the other goes away, a light turns green."""
    actors = made.added(
        made.actor(HERO, "vehicle.tesla.model3", 1, attributes=[(3, "role_name", "hero"), (4, "color", "1,2,3")]),
        made.actor(OTHER, "vehicle.audi.tt", 1, attributes=[(3, "role_name", "scenario")]),
        made.actor(WALKER, "walker.pedestrian.0001", 2),
        made.actor(LIGHT, "traffic.traffic_light", 3),
    )
    return MetricsLog(
        read_log(
            made.write(
                tmp_path,
                made.header(),
                made.frame(1, 0.0, actors, *places(100), *motion(2.0), *of_the_first_frame()),
                made.frame(2, 0.5, *places(200), *motion(3.0), light(2), *touches()),
                made.frame(3, 1.0, made.removed(OTHER), made.positions((HERO, 350, *[0] * 5)), *motion(3.0), light(2)),
            )
        )
    )  # fmt: skip


def places(x_cm: float) -> list[bytes]:
    return [made.positions((HERO, x_cm, 0, 50, 1, 2, 90), (OTHER, 5000, 0, 0, 0, 0, 0), (WALKER, 0, 700, 0, 0, 0, 0))]


def motion(speed_mps: float) -> list[bytes]:
    return [
        made.several(8, "IfffBi", [(HERO, 0.25, 0.5, 0.75, 1, -1)]),
        made.several(9, "If", [(WALKER, 1.25)]),
        made.several(12, "I6f", [(HERO, speed_mps, 0, 0, 0, 0, 15)]),
    ]


def light(state: int) -> bytes:
    return made.several(7, "IBfb", [(LIGHT, 1, 2.5, state)])


def touches() -> list[bytes]:
    return [made.several(5, "IIIBB", [(1, HERO, OTHER, 1, 0), (2, HERO, NO_ACTOR, 1, 0), (3, OTHER, HERO, 0, 1)])]


def of_the_first_frame() -> list[bytes]:
    return [
        light(0),
        made.several(4, "II", [(LIGHT, HERO)]),
        made.several(10, "II", [(HERO, 0b1010)]),
        made.several(11, "if4fBB", [(12, 100.0, 1, 0.5, 0.25, 1, 1, 2)]),
        made.several(13, "I6f", [(HERO, 0, 0, 75, 240, 95, 75), (LIGHT, *(float("nan"),) * 3, *(float("-inf"),) * 3)]),
        made.packet(14, struct.pack("<d", 0.125)),
        made.several(16, "I3f", [(LIGHT, 10, 3, 2)]),
        made.several(17, "I6f", [(LIGHT, 0, 0, 0, 100, 200, 300)]),
    ]


def test_frames_count_from_one(log: MetricsLog) -> None:
    assert log.get_total_frame_count() == 3
    assert [log.get_elapsed_time(frame) for frame in (1, 2, 3)] == [0.0, 0.5, 1.0]
    assert [log.get_delta_time(frame) for frame in (1, 2, 3)] == [0.0, 0.5, 0.5]
    assert [log.get_platform_time(frame) for frame in (1, 2)] == [0.125, None]
    for frame in (0, 4):
        with pytest.raises(IndexError, match=f"there is no frame {frame}: the recording's count from 1 to 3"):
            log.get_actor_transform(HERO, frame)


def test_actors_are_found_by_role_and_by_type(log: MetricsLog) -> None:
    assert log.get_ego_vehicle_id() == HERO
    assert log.get_actor_ids_with_role_name("scenario") == [OTHER]
    assert log.get_actor_ids_with_type_id("vehicle.*") == [HERO, OTHER]
    with pytest.raises(IndexError, match="no actor of the recording has the role 'ghost'; it has hero, scenario"):
        log.get_actor_velocity("ghost", 1)


def test_what_is_known_of_an_actor_is_under_scenario_runners_names(log: MetricsLog) -> None:
    hero = log.get_actor_attributes("hero")
    assert hero is not None
    assert (hero["type_id"], hero["color"], hero["created"]) == ("vehicle.tesla.model3", "1,2,3", 1)
    assert hero["location"] == carla.Location(1.0, 2.0, 3.0)
    other = log.get_actor_attributes(OTHER)
    assert other is not None
    assert other["destroyed"] == 3
    light_facts = log.get_actor_attributes(LIGHT)
    assert light_facts is not None
    assert light_facts["parent"] == HERO
    assert log.get_actor_attributes(77) is None
    assert log.get_actor_alive_frames(HERO) == (1, 3)
    assert log.get_actor_alive_frames(OTHER) == (1, 2)
    assert log.get_actor_alive_frames(77) == (None, None)


def test_boxes_are_in_metres_and_empty_for_one_that_has_no_size(log: MetricsLog) -> None:
    box = log.get_actor_bounding_box(HERO)
    assert box is not None
    assert (round(box.location.z, 5), round(box.extent.x, 5), round(box.extent.y, 5)) == (0.75, 2.4, 0.95)
    none = log.get_actor_bounding_box(LIGHT)
    assert none is not None
    assert (none.location, none.extent) == (carla.Location(), carla.Vector3D())
    volume = log.get_traffic_light_trigger_volume(LIGHT)
    assert volume is not None
    assert volume.extent == carla.Vector3D(1.0, 2.0, 3.0)
    assert log.get_actor_bounding_box(OTHER) is None


def test_places_and_motion_are_answered_by_id_or_role(log: MetricsLog) -> None:
    place = log.get_actor_transform("hero", 1)
    assert place == carla.Transform(carla.Location(1.0, 0.0, 0.5), carla.Rotation(pitch=2.0, yaw=90.0, roll=1.0))
    assert log.get_actor_transform(OTHER, 3) is None
    assert log.get_actor_velocity(HERO, 2) == carla.Vector3D(3.0, 0.0, 0.0)
    assert log.get_actor_angular_velocity("hero", 1) == carla.Vector3D(0.0, 0.0, 15.0)
    assert log.get_actor_velocity(OTHER, 1) is None
    assert log.get_walker_speed(WALKER, 2) == 1.25
    assert log.get_walker_speed(HERO, 2) is None


def test_acceleration_is_the_change_of_velocity(log: MetricsLog) -> None:
    assert [log.get_actor_acceleration(HERO, frame).x for frame in (1, 2, 3)] == [0.0, 2.0, 0.0]
    assert log.get_actor_acceleration(OTHER, 2) is None


def test_a_control_with_a_negative_gear_is_reverse(log: MetricsLog) -> None:
    control = log.get_vehicle_control("hero", 2)
    assert control is not None
    assert (control.steer, control.throttle, control.brake) == (0.25, 0.5, 0.75)
    assert (control.hand_brake, control.reverse, control.gear) == (True, True, -1)
    assert log.get_vehicle_physics_control(HERO, 3) is None


def test_lights_are_answered(log: MetricsLog) -> None:
    assert log.get_traffic_light_state(LIGHT, 1) == carla.TrafficLightState.Red
    assert log.get_traffic_light_state(LIGHT, 2) == carla.TrafficLightState.Green
    assert log.is_traffic_light_frozen(LIGHT, 1) is True
    assert log.get_traffic_light_elapsed_time(LIGHT, 1) == 2.5
    assert log.get_traffic_light_state_time(LIGHT, carla.TrafficLightState.Yellow, 3) == 3.0
    assert log.get_traffic_light_state_time(LIGHT, carla.TrafficLightState.Off, 3) is None
    assert log.get_vehicle_lights(HERO, 1) == [carla.VehicleLightState.LowBeam, carla.VehicleLightState.Brake]
    assert log.get_vehicle_lights(HERO, 2) is None
    assert log.is_vehicle_light_active(carla.VehicleLightState.Brake, HERO, 1)
    assert not log.is_vehicle_light_active(carla.VehicleLightState.Fog, HERO, 1)
    lamp = log.get_scene_light_state(12, 3)
    assert lamp is not None
    assert (lamp.intensity, lamp.group, lamp.active) == (100.0, carla.LightGroup.Street, True)
    assert (lamp.color.r, lamp.color.g, lamp.color.b) == (255, 127, 63)
    assert log.get_scene_light_state(99, 3) is None


def test_contacts_are_reported_from_both_sides_once_a_frame(log: MetricsLog) -> None:
    assert log.get_actor_collisions("hero") == {2: [OTHER, NO_ACTOR]}
    assert log.get_actor_collisions(OTHER) == {2: [HERO]}
    assert log.get_actor_collisions(WALKER) == {}
    assert [(c.frame, c.t_s, c.actor_id, c.other_id) for c in log.get_collisions()] == [
        (2, 0.5, HERO, OTHER), (2, 0.5, HERO, NO_ACTOR), (2, 0.5, OTHER, HERO),
    ]  # fmt: skip


def test_lists_have_an_answer_a_frame(log: MetricsLog) -> None:
    assert [place is None for place in log.get_all_actor_transforms(OTHER)] == [False, False, True]
    assert [velocity.x for velocity in log.get_all_actor_velocities("hero", 2, 3) if velocity] == [3.0, 3.0]
    assert len(log.get_all_actor_angular_velocities(HERO)) == 3
    assert [value.x for value in log.get_all_actor_accelerations(HERO, last_frame=2) if value] == [0.0, 2.0]


def test_dicts_have_an_answer_an_actor(log: MetricsLog) -> None:
    assert set(log.get_actor_transforms_at_frame(1)) == {HERO, OTHER, WALKER}
    assert set(log.get_actor_transforms_at_frame(3)) == {HERO}
    assert set(log.get_actor_transforms_at_frame(1, [HERO, 77])) == {HERO}
    assert set(log.get_actor_velocities_at_frame(1)) == {HERO}
    assert set(log.get_actor_angular_velocities_at_frame(1)) == {HERO}
    assert log.get_actor_accelerations_at_frame(2)[HERO].x == 2.0


def test_a_whole_run_comes_as_arrays(log: MetricsLog) -> None:
    hero, other = log.get_actor_arrays("hero"), log.get_actor_arrays(OTHER)
    assert hero.frame.tolist() == [1, 2, 3]
    np.testing.assert_allclose(hero.location_m[:, 0], [1.0, 2.0, 3.5])
    np.testing.assert_allclose(hero.speed_mps, [2.0, 3.0, 3.0])
    np.testing.assert_allclose(hero.acceleration_mps2[:, 0], [0.0, 2.0, 0.0])
    np.testing.assert_allclose(hero.rotation_deg[0], [1.0, 2.0, 90.0])
    assert hero.gear.tolist() == [-1, -1, -1]
    assert other.frame.tolist() == [1, 2]
    assert np.isnan(other.velocity_mps).all()


def test_lindens_last_bits_make_places_exact(tmp_path: Path) -> None:
    exact = np.float32(123.456)
    plain = np.float32(exact * np.float32(100)) / np.float32(100)
    off = int(np.array(exact).view(np.int32)) - int(np.array(plain).view(np.int32))
    bits = made.several(240, "3b", [(off, 0, 0)])
    row = (HERO, float(exact * np.float32(100)), 0, 0, 0, 0, 0)
    actor = made.added(made.actor(HERO, "vehicle.audi.tt", 1))
    frames = [made.frame(1, 0.0, actor, made.positions(row), bits), made.frame(2, 0.1, made.positions(row))]
    arrays = MetricsLog(read_log(made.write(tmp_path, made.header(), *frames))).get_actor_arrays(HERO)
    assert arrays.location_m[:, 0].tolist() == [float(exact), float(plain)]
