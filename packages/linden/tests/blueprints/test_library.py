"""The blueprint library against what CARLA 0.9.16 has, and what it refuses to spawn."""

import itertools
import math
import time

import pytest

from linden.blueprints.attributes import bounds_of
from linden.blueprints.library import Blueprint, BlueprintKind, BlueprintLibrary
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDefinition, ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType, SemanticTag

LIBRARY = BlueprintLibrary.load()
VEHICLES = [blueprint for blueprint in LIBRARY if blueprint.kind is BlueprintKind.VEHICLE]
SHUTTLE = LIBRARY.find("vehicle.easymile.ez10")


def default_of(blueprint: Blueprint, name: str) -> str:
    return {attribute.id: attribute.value for attribute in blueprint.definition.attributes}[name]


def described(blueprint_id: str, **attributes: str) -> ActorDescription:
    chosen = tuple(AttributeValue(name, AttributeType.STRING, value) for name, value in attributes.items())
    return ActorDescription(0, blueprint_id, chosen)


@pytest.mark.parametrize(
    ("prefix", "count"),
    [("vehicle.", 42), ("walker.pedestrian.", 52), ("sensor.camera.", 8), ("sensor.lidar.", 2), ("sensor.other.", 9)],
)
def test_the_library_has_as_many_as_carla_and_one_shuttle(prefix: str, count: int) -> None:
    assert sum(definition.id.startswith(prefix) for definition in LIBRARY.definitions) == count


def test_ids_and_numbers_are_unique() -> None:
    assert len({definition.id for definition in LIBRARY.definitions}) == len(LIBRARY.definitions)
    assert [definition.uid for definition in LIBRARY.definitions] == list(range(1, len(LIBRARY.definitions) + 1))


def test_tags_are_the_words_of_the_id() -> None:
    assert LIBRARY.find("vehicle.tesla.model3").definition.tags == "vehicle,tesla,model3"
    assert LIBRARY.find("static.prop.bike helmet").definition.tags == "static,prop,bike helmet"


def test_loading_is_quick() -> None:
    best_s = math.inf
    for _ in range(3):
        begun_s = time.perf_counter()
        BlueprintLibrary.load()
        best_s = min(best_s, time.perf_counter() - begun_s)
    assert best_s < 0.2  # 0.01 s where nothing else runs


def test_every_recommended_value_is_allowed() -> None:
    for definition in LIBRARY.definitions:
        assert LIBRARY.validate(described(definition.id)).attribute("role_name") == definition.attributes[0].value
        for attribute in definition.attributes:
            for choice in attribute.recommended_values:
                complete = LIBRARY.validate(described(definition.id, **{attribute.id: choice}))
                assert complete.attribute(attribute.id) == choice


def test_every_default_converts_to_its_type() -> None:
    for definition in LIBRARY.definitions:
        for attribute in definition.attributes:
            if attribute.type == AttributeType.INT:
                int(attribute.value)
            elif attribute.type == AttributeType.FLOAT:
                float(attribute.value)
            elif attribute.type == AttributeType.BOOL:
                assert attribute.value in {"true", "false"}
            elif attribute.type == AttributeType.RGB_COLOR:
                assert all(0 <= int(part) <= 255 for part in attribute.value.split(","))


def test_every_body_has_a_size_and_stands_on_its_origin() -> None:
    for blueprint in LIBRARY:
        assert min(blueprint.box.extent) > 0.0, blueprint.definition.id
        if blueprint.kind is BlueprintKind.VEHICLE:
            assert abs(blueprint.box.location.z - blueprint.box.extent.z) < 0.2, blueprint.definition.id
        if blueprint.kind is BlueprintKind.WALKER:
            assert blueprint.box.location.z == 0.0


@pytest.mark.parametrize("blueprint", VEHICLES, ids=lambda blueprint: blueprint.definition.id)
def test_the_wheels_stand_on_the_ground_and_inside_the_box(blueprint: Blueprint) -> None:
    assert blueprint.vehicle is not None
    physics, offsets = blueprint.vehicle.physics, blueprint.vehicle.wheel_offsets_m
    assert len(physics.wheels) == 4
    assert len(offsets) == int(default_of(blueprint, "number_of_wheels"))
    for wheel, offset in zip(physics.wheels[:: 4 // len(offsets)], offsets, strict=True):
        assert 100.0 * offset.z == pytest.approx(wheel.radius)
        assert abs(offset.x - blueprint.box.location.x) < blueprint.box.extent.x
        assert abs(offset.y) < blueprint.box.extent.y
    front, back = offsets[: len(offsets) // 2], offsets[len(offsets) // 2 :]
    assert min(offset.x for offset in front) > max(offset.x for offset in back)
    assert sum(offset.y for offset in offsets) == pytest.approx(0.0)
    assert physics.mass == blueprint.mass_kg
    assert physics.mass > 0.0


@pytest.mark.parametrize("blueprint", VEHICLES, ids=lambda blueprint: blueprint.definition.id)
def test_curves_rise_in_their_argument_and_engines_reach_their_limit(blueprint: Blueprint) -> None:
    assert blueprint.vehicle is not None
    physics = blueprint.vehicle.physics
    for curve in (physics.torque_curve, physics.steering_curve):
        assert all(left.x < right.x for left, right in itertools.pairwise(curve))
    assert physics.max_rpm >= physics.torque_curve[-1].x
    assert all(0.0 < point.y <= 1.0 for point in physics.steering_curve)


def test_the_lincoln_drives_as_it_was_recorded() -> None:
    lincoln = LIBRARY.find("vehicle.lincoln.mkz_2017")
    assert lincoln.vehicle is not None
    physics, offsets = lincoln.vehicle.physics, lincoln.vehicle.wheel_offsets_m
    assert (physics.mass, physics.max_rpm, physics.final_ratio, physics.moi) == (1696.0, 6500.0, 3.21, 1.0)
    assert [gear.ratio for gear in physics.forward_gears] == [4.584, 2.964, 1.912, 1.446, 1.0, 0.746]
    assert [gear.up_ratio for gear in physics.forward_gears] == [0.54, 0.5, 0.46, 0.46, 0.46, 0.46]
    assert {gear.down_ratio for gear in physics.forward_gears} == {0.23}
    assert physics.torque_curve[3] == (3000.0, 695.0)
    assert [wheel.max_handbrake_torque for wheel in physics.wheels] == [0.0, 0.0, 1600.0, 1600.0]
    assert [wheel.max_steer_angle for wheel in physics.wheels] == [70.0, 70.0, 0.0, 0.0]
    assert offsets[0].x - offsets[2].x == pytest.approx(2.871)
    assert offsets[1].y - offsets[0].y == pytest.approx(1.57)


def test_the_shuttle_has_the_size_of_its_profile() -> None:
    assert tuple(2.0 * half for half in SHUTTLE.box.extent) == pytest.approx((4.02, 2.00, 2.87))
    assert SHUTTLE.mass_kg == 2050.0
    assert SHUTTLE.vehicle is not None
    assert SHUTTLE.vehicle.wheel_offsets_m[0].x - SHUTTLE.vehicle.wheel_offsets_m[2].x == pytest.approx(2.8)


def test_the_shuttle_has_sixteen_kilowatts_and_nothing_left_above_forty_kilometres_an_hour() -> None:
    assert SHUTTLE.vehicle is not None
    physics = SHUTTLE.vehicle.physics
    watts = [torque.y * torque.x * 2.0 * math.pi / 60.0 for torque in physics.torque_curve]
    assert max(watts) == pytest.approx(16_000.0, rel=0.005)
    rpm_at_40 = 40.0 / 3.6 / (0.01 * physics.wheels[0].radius) * physics.final_ratio * 60.0 / (2.0 * math.pi)
    last_with_full_power, without_torque = physics.torque_curve[-2].x, physics.torque_curve[-1].x
    assert last_with_full_power < rpm_at_40 < without_torque < 1.02 * rpm_at_40


def test_tags_tell_cars_trucks_buses_and_riders_apart() -> None:
    def tags(name: str) -> list[int]:
        return list(LIBRARY.find(name).semantic_tags)

    assert tags("vehicle.audi.a2") == [SemanticTag.CAR]
    assert tags("vehicle.carlamotors.firetruck") == [SemanticTag.TRUCK]
    assert tags("vehicle.mitsubishi.fusorosa") == tags("vehicle.easymile.ez10") == [SemanticTag.BUS]
    assert tags("vehicle.bh.crossbike")[0] == SemanticTag.BICYCLE
    assert tags("vehicle.yamaha.yzf")[0] == SemanticTag.MOTORCYCLE
    assert tags("walker.pedestrian.0001") == [SemanticTag.PEDESTRIANS]


def test_lights_and_doors_follow_the_generation_but_for_the_exceptions() -> None:
    def flags(name: str) -> tuple[str, str]:
        blueprint = LIBRARY.find(name)
        return default_of(blueprint, "has_lights"), default_of(blueprint, "has_dynamic_doors")

    assert flags("vehicle.lincoln.mkz_2020") == ("true", "true")
    assert flags("vehicle.lincoln.mkz_2017") == ("false", "false")
    assert flags("vehicle.tesla.cybertruck") == ("false", "false")
    assert flags("vehicle.mitsubishi.fusorosa") == ("true", "false")


def test_a_cybertruck_has_no_colour_to_choose() -> None:
    assert not any(a.id == "color" for a in LIBRARY.find("vehicle.tesla.cybertruck").definition.attributes)


def test_every_walker_stands_walks_and_runs() -> None:
    for blueprint in LIBRARY:
        if blueprint.kind is BlueprintKind.WALKER:
            speed = next(a for a in blueprint.definition.attributes if a.id == "speed")
            standing, walking, running = map(float, speed.recommended_values)
            assert 0.0 == standing < walking < running


def test_every_sensor_streams_but_the_one_that_the_client_computes() -> None:
    silent = {blueprint.definition.id for blueprint in LIBRARY if not blueprint.has_stream}
    assert {name for name in silent if name.startswith("sensor.")} == {"sensor.other.lane_invasion"}


def test_a_description_is_completed_in_the_blueprints_order() -> None:
    complete = LIBRARY.validate(described("sensor.other.gnss", noise_seed="7"))
    assert [a.id for a in complete.attributes][:4] == ["role_name", "ros_name", "sensor_tick", "noise_seed"]
    assert complete.attribute("noise_seed") == "7"
    assert complete.attribute("noise_alt_bias") == "0.0"
    assert complete.uid == LIBRARY.find("sensor.other.gnss").definition.uid


def test_pythons_true_is_taken_for_true() -> None:
    complete = LIBRARY.validate(described("vehicle.tesla.model3", sticky_control="False"))
    assert complete.attribute("sticky_control") == "false"


@pytest.mark.parametrize(
    ("value", "read"), [("64.0", "64"), ("64.", "64"), ("1388888.888888889", "1388888"), ("800.5", "800")]
)
def test_a_whole_number_is_read_up_to_its_point(value: str, read: str) -> None:
    complete = LIBRARY.validate(described("sensor.lidar.ray_cast", points_per_second=value))
    assert complete.attribute("points_per_second") == read


def _reads(definition: ActorDefinition, name: str) -> str | None:
    return next((attribute.value for attribute in definition.attributes if attribute.id == name), None)


def test_a_walker_without_a_wheelchair_may_be_asked_to_use_one() -> None:
    definition = next(d for d in LIBRARY.definitions if _reads(d, "can_use_wheelchair") == "false")
    complete = LIBRARY.validate(described(definition.id, use_wheelchair="true"))
    assert complete.attribute("use_wheelchair") == "true"


@pytest.mark.parametrize(
    ("blueprint_id", "attributes", "sentence"),
    [
        ("vehicle.tesla.model4", {}, "no blueprint 'vehicle.tesla.model4'; 42 begin with 'vehicle.'"),
        ("car", {}, "ids begin with one of controller, sensor, static, util, vehicle, walker"),
        ("vehicle.tesla.model3", {"colour": "0,0,0"}, "no attribute 'colour', only base_type, color"),
        ("vehicle.tesla.model3", {"color": "0,0"}, "'0,0' as color: expected red,green,blue of 0 to 255 each"),
        ("vehicle.tesla.model3", {"color": "0,0,256"}, "'0,0,256' as color"),
        ("vehicle.tesla.model3", {"number_of_wheels": "3"}, "it is '4' and can only be read"),
        ("vehicle.tesla.model3", {"sticky_control": "perhaps"}, "expected true or false"),
        ("sensor.camera.rgb", {"exposure_mode": "auto"}, "allowed are histogram, manual"),
        ("sensor.camera.rgb", {"image_size_x": "800.x"}, "expected a whole number, such as '800'"),
        ("sensor.camera.rgb", {"image_size_x": "0"}, "expected at least 1"),
        ("sensor.camera.depth", {"fov": "1e300"}, "expected at most 1000000000"),
        ("sensor.camera.dvs", {"positive_threshold": "1e-300"}, "expected at least 0.01"),
        ("sensor.lidar.ray_cast", {"channels": "2000000000"}, "expected at most 4096"),
        ("sensor.lidar.ray_cast_semantic", {"points_per_second": "2000000000"}, "expected at most 20000000"),
        ("sensor.lidar.ray_cast", {"rotation_frequency": "1e300"}, "expected at most 10000"),
        ("sensor.other.radar", {"points_per_second": "20000001"}, "expected at most 20000000"),
        ("sensor.other.obstacle", {"hit_radius": "1e300"}, "expected at most 1000"),
        ("sensor.other.imu", {"noise_accel_stddev_x": "1e300"}, "expected at most 1000000000"),
        ("sensor.other.gnss", {"noise_seed": "9999999999"}, "expected at most 2147483647"),
        ("static.prop.mesh", {"scale": "1e300"}, "expected at most 1000"),
        ("static.trigger.friction", {"extent_x": "1e300"}, "expected at most 1000000"),
        ("sensor.other.gnss", {"sensor_tick": "soon"}, "expected a finite number"),
        ("sensor.other.gnss", {"sensor_tick": "nan"}, "expected a finite number"),
        ("sensor.other.gnss", {"sensor_tick": "-0.1"}, "expected at least 0"),
        ("sensor.other.imu", {"noise_gyro_stddev_x": "-1"}, "expected at least 0"),
        ("sensor.other.gnss", {"noise_seed": "²"}, "expected a whole number"),
    ],
)
def test_a_bad_description_is_refused_with_carlas_words_and_the_reason(
    blueprint_id: str, attributes: dict[str, str], sentence: str
) -> None:
    with pytest.raises(Refusal) as refusal:
        LIBRARY.validate(described(blueprint_id, **attributes))
    assert str(refusal.value).startswith("Spawn failed because of invalid actor description: ")
    assert sentence in str(refusal.value)


def test_every_number_of_a_sensor_has_bounds_that_allow_its_default() -> None:
    numbers = [
        attribute
        for definition in LIBRARY.definitions
        for attribute in definition.attributes
        if attribute.is_modifiable and attribute.type in (AttributeType.INT, AttributeType.FLOAT)
    ]
    for attribute in numbers:
        least, most = bounds_of(attribute)
        assert least <= float(attribute.value) <= most <= 2**31, attribute.id


def test_animals_have_sizes_and_masses_of_their_own_and_come_after_carlas_blueprints() -> None:
    assert [definition.id for definition in LIBRARY.definitions[-2:]] == ["walker.animal.deer", "walker.animal.dog"]
    deer, dog, child = map(LIBRARY.find, ("walker.animal.deer", "walker.animal.dog", "walker.pedestrian.0048"))
    assert (deer.mass_kg, dog.mass_kg, child.mass_kg) == (66.0, 32.0, 30.0)
    assert tuple(deer.box.extent) == pytest.approx((0.85, 0.225, 0.455))  # half of length, width, shoulder height
    assert deer.semantic_tags == dog.semantic_tags == bytes([SemanticTag.DYNAMIC])
    # a script that takes any walker finds all that it asks of people
    people = {attribute.id for attribute in child.definition.attributes}
    assert people <= {attribute.id for attribute in deer.definition.attributes}
    assert default_of(deer, "height") == "0.91"
