"""Radios in a world of one wall and a few cars: which radio receives a message, with what power, and when."""

import math
from collections.abc import Sequence

import pytest

from fakes.solids import box, described, floor
from linden.errors import Refusal
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.values.v2x import DriveDirection, StationType, VehicleRole
from linden.scenery.mesh import join
from linden.sensors.devices.radio.path_loss import LIGHT_MPS, Edge, edge_loss_db
from linden.sensors.devices.radio.radio import MOST_TEXTS, CamReading, TextReading
from linden.simulation.actor_table import ActorRecord
from linden.world import World
from opendrive_texts import street_through_junction

STEP_S = 0.05
TEXT = street_through_junction()
MAP = LoadedMap(name="street", text=TEXT, **vars(derive(TEXT)))
QUIET = {"use_etsi_fading": "false"}
ANTENNA_GAIN_AND_POWER_DB = 31.5
CAM, CUSTOM = "sensor.other.v2x", "sensor.other.v2x_custom"


@pytest.fixture
def world() -> World:
    """A plain, and a wall of 4 m across x = 200 m that begins 10 m south of y = 0."""
    world = World(MAP)
    wall = box((0.5, 20.0, 2.0), centre_m=(200.0, 30.0, 2.0), tag=SemanticTag.WALLS)
    world.sensor_scene.standing_on = lambda _map, _scene: join([floor(2000.0), wall])
    return world


def car(
    world: World, x_m: float, y_m: float = 0.0, name: str = "vehicle.tesla.model3", yaw: float = 0.0
) -> ActorRecord:
    """A car that nothing moves."""
    made = world.spawn(described(name), Transform(Vector3D(x_m, y_m, 0.0), Rotation(yaw=yaw)))
    world.episode.bodies.set_simulate(made.slot, simulate=False)
    return made


def radio(world: World, carrier: ActorRecord | None, name: str = CAM, **chosen: str) -> ActorRecord:
    return world.spawn(described(name, **{**QUIET, **chosen}), Transform(), parent_id=carrier.id if carrier else 0)


def frame(world: World, *ears: ActorRecord) -> dict[int, Sequence]:
    """What each sensor hands over after one step."""
    world.step(STEP_S)
    readings = world.measure({ear.stream_id for ear in ears})
    assert all(isinstance(found.reading, CamReading | TextReading) for found in readings)
    return {found.sensor.id: found.reading.received for found in readings}


def power_dbm(world: World, ear: ActorRecord) -> float:
    (heard,) = frame(world, ear)[ear.id]
    return heard.power_dbm


def winner_dbm(distance_m: float) -> float:
    return ANTENNA_GAIN_AND_POWER_DB - (32.4 + 20.0 * math.log10(distance_m) + 20.0 * math.log10(5.9))


@pytest.mark.parametrize("distance_m", [10.0, 50.0, 180.0])
def test_power_falls_with_distance_as_the_model_says(world: World, distance_m: float) -> None:
    ear = radio(world, car(world, 0.0))
    radio(world, car(world, distance_m))
    assert power_dbm(world, ear) == pytest.approx(winner_dbm(distance_m), abs=0.02)


def test_the_geometric_model_has_the_antennas_on_the_roofs(world: World) -> None:
    mine, other = car(world, 0.0), car(world, 60.0, name="vehicle.easymile.ez10")
    ear = radio(world, mine, path_loss_model="geometric")
    radio(world, other)
    low_m, high_m = (each.box.location.z + each.box.extent.z + 0.02 for each in (mine, other))
    assert high_m - low_m > 1.0
    wavelength_m = LIGHT_MPS / 5.9e9
    direct_m, reflected_m = math.hypot(60.0, high_m - low_m), math.hypot(60.0, high_m + low_m)
    sine, cosine = (high_m + low_m) / reflected_m, 60.0 / reflected_m
    root = math.sqrt(1.02 - cosine**2)
    reflection = (sine - root) / (sine + root)
    phase = 2.0 * math.pi * (direct_m - reflected_m) / wavelength_m
    wave = abs(1.0 + reflection * complex(math.cos(phase), math.sin(phase)))
    expected_db = 20.0 * math.log10(4.0 * math.pi * 60.0 / wavelength_m / wave)
    assert power_dbm(world, ear) == pytest.approx(ANTENNA_GAIN_AND_POWER_DB - expected_db, abs=0.02)


def test_a_wall_in_between_costs_what_the_model_says(world: World) -> None:
    ear = radio(world, car(world, 150.0, 30.0))
    radio(world, car(world, 250.0, 30.0))
    expected = ANTENNA_GAIN_AND_POWER_DB - (36.85 + 30.0 * 2.0 + 18.9 * math.log10(5.9))
    assert power_dbm(world, ear) == pytest.approx(expected, abs=0.05)


def test_past_the_walls_end_the_way_is_free(world: World) -> None:
    ear = radio(world, car(world, 150.0, 5.0))
    radio(world, car(world, 250.0, 5.0))
    assert power_dbm(world, ear) == pytest.approx(winner_dbm(100.0), abs=0.02)


def test_a_truck_in_between_costs_the_edge_of_its_roof(world: World) -> None:
    mine, other = car(world, 0.0), car(world, 60.0)
    truck = car(world, 20.0, name="vehicle.carlamotors.european_hgv")
    ear = radio(world, mine)
    radio(world, other)
    antenna_m = mine.box.location.z + mine.box.extent.z + 0.02
    edge = Edge(20.0, 40.0, truck.box.location.z + truck.box.extent.z - antenna_m)
    lost_db = edge_loss_db(edge, LIGHT_MPS / 5.9e9)
    assert lost_db > 15.0
    assert power_dbm(world, ear) == pytest.approx(winner_dbm(60.0) - lost_db, abs=0.02)


def test_walkers_do_not_count_and_props_do(world: World) -> None:
    ear, voice = radio(world, car(world, 0.0)), radio(world, car(world, 30.0), fixed_rate="true", gen_cam_min="0.001")
    world.spawn(described("walker.pedestrian.0001"), Transform(Vector3D(15.0, 0.0, 1.2)))
    assert power_dbm(world, ear) == pytest.approx(winner_dbm(30.0), abs=0.02)
    world.spawn(described("static.prop.container"), Transform(Vector3D(20.0, 0.0, 0.0)))
    assert power_dbm(world, ear) < winner_dbm(30.0) - 15.0
    assert voice.id in world.sensors.radios


def test_beyond_the_filter_or_below_the_sensitivity_nothing_arrives(world: World) -> None:
    mine = car(world, 0.0)
    near, deaf = radio(world, mine, filter_distance="99"), radio(world, mine, receiver_sensitivity="-50")
    far, keen = radio(world, mine, filter_distance="101"), radio(world, mine, receiver_sensitivity="-57")
    radio(world, car(world, 100.0))
    assert set(frame(world, near, deaf, far, keen)) == {far.id, keen.id}  # -56.3 dBm


def test_senders_power_and_receivers_gain_count(world: World) -> None:
    ear = radio(world, car(world, 0.0), combined_antenna_gain="3", transmit_power="40")
    radio(world, car(world, 50.0), combined_antenna_gain="20", transmit_power="10")
    assert power_dbm(world, ear) == pytest.approx(winner_dbm(50.0) - ANTENNA_GAIN_AND_POWER_DB + 13.0, abs=0.02)


def fadings(world: World, seed: str, *, others: bool = False) -> list[float]:
    ear = radio(world, car(world, 0.0), use_etsi_fading="true", noise_seed=seed)
    radio(world, car(world, 50.0), fixed_rate="true", gen_cam_min="0.05")
    if others:
        radio(world, car(world, 20.0, 20.0), fixed_rate="true", gen_cam_min="0.05")
    return [frame(world, ear)[ear.id][0].power_dbm - winner_dbm(50.0) for _ in range(300)]


def test_fading_has_etsis_deviation_and_its_seed_repeats_it(world: World) -> None:
    first = fadings(world, "4")
    mean_db = sum(first) / len(first)
    deviation_db = math.sqrt(sum((each - mean_db) ** 2 for each in first) / len(first))
    assert mean_db == pytest.approx(0.0, abs=0.6)
    assert deviation_db == pytest.approx(3.3, rel=0.12)
    for seed, others, alike in (("4", False, True), ("4", True, True), ("5", False, False)):
        again = World(MAP)
        again.sensor_scene = world.sensor_scene
        assert (fadings(again, seed, others=others) == first) is alike


def test_what_a_radio_sends_does_not_depend_on_listeners(world: World) -> None:
    ear = radio(world, car(world, 0.0))
    radio(world, car(world, 50.0))
    frames = [bool(frame(world, *([ear] if number > 30 else []))) for number in range(80)]
    assert [number for number, heard in enumerate(frames) if heard] == [40, 60]


def test_sensor_tick_hands_over_together_what_came_in_between(world: World) -> None:
    ear = radio(world, car(world, 0.0), sensor_tick="0.5")
    radio(world, car(world, 50.0), fixed_rate="true", gen_cam_min="0.1")
    counts = [len(frame(world, ear).get(ear.id, ())) for _ in range(31)]
    assert counts == [1, *[0] * 9, 5, *[0] * 9, 5, *[0] * 9, 5]


def test_a_carrier_speaks_once_and_does_not_hear_itself(world: World) -> None:
    mine, other = car(world, 0.0), car(world, 50.0)
    mine_first, mine_second = radio(world, mine), radio(world, mine)
    ear = radio(world, other)
    heard = frame(world, mine_first, mine_second, ear)
    assert {ear_id: [each.message.station_id for each in found] for ear_id, found in heard.items()} == {
        mine_first.id: [other.id],
        mine_second.id: [other.id],
        ear.id: [mine.id],
    }


def test_a_message_tells_what_its_vehicle_does(world: World) -> None:
    ear, shuttle = (
        radio(world, car(world, 0.0)),
        world.spawn(described("vehicle.easymile.ez10"), Transform(Vector3D(60.0, 0.0, 0.0), Rotation(yaw=90.0))),
    )
    radio(world, shuttle, fixed_rate="true", gen_cam_min="0.05")
    bodies, slot = world.episode.bodies, shuttle.slot
    for _ in range(20):
        frame(world)
    bodies.set_target_velocity(slot, Vector3D(0.0, 6.0, 0.0))
    bodies.set_target_angular_velocity(slot, Vector3D(0.0, 0.0, math.radians(10.0)))  # to the right
    bodies.brake[slot] = 0.4
    world.episode.actors.set_lamps(shuttle.id, 0x2 | 0x20)
    (heard,) = frame(world, ear)[ear.id]
    message, state, pose = heard.message, heard.message.state, bodies.pose(slot)
    assert state is not None
    assert message.station_type is StationType.BUS
    assert state.heading == pytest.approx((pose.rotation.yaw + 90.0) * 10.0, abs=1)
    assert state.speed == pytest.approx(100.0 * math.hypot(*bodies.velocity[slot][:2]), abs=3)
    assert state.drive_direction is DriveDirection.FORWARD
    assert (state.length, state.width) == (40, 20)
    assert state.yaw_rate == pytest.approx(-100.0 * math.degrees(bodies.angular_velocity[slot, 2]), abs=1)
    assert state.yaw_rate < -100
    assert state.acceleration_control == 0x80
    slow = [frame(world, ear)[ear.id][0].message.facts for _ in range(10)]
    assert [each for each in slow if each is not None] == [(VehicleRole.PUBLIC_TRANSPORT, 0xA0)]
    bodies.set_target_velocity(slot, Vector3D(0.0, -2.0, 0.0))
    backward = frame(world, ear)[ear.id][0].message.state
    assert backward is not None
    assert backward.drive_direction is DriveDirection.BACKWARD
    assert backward.speed > 100


def test_noise_is_the_noise_asked_for_and_the_confidence_says_so(world: World) -> None:
    ear = radio(world, car(world, 0.0))
    radio(
        world, car(world, 50.0), fixed_rate="true", gen_cam_min="0.05", noise_head_stddev="2", noise_head_bias="5",
        noise_alt_stddev="1.5", noise_vel_stddev_x="30",
    )  # fmt: skip
    heard = [frame(world, ear)[ear.id][0].message for _ in range(300)]
    headings = [each.state.heading for each in heard if each.state is not None]
    mean = sum(headings) / len(headings)
    assert mean == pytest.approx(900 + 50, abs=5)
    assert math.sqrt(sum((each - mean) ** 2 for each in headings) / 300) == pytest.approx(20.0, rel=0.12)
    assert heard[0].state is not None
    assert (heard[0].state.heading_confidence, heard[0].state.speed_confidence) == (40, 126)
    altitudes = [each.altitude for each in heard]
    assert max(altitudes) - min(altitudes) > 500


def test_the_roadside_has_stations_too(world: World) -> None:
    mine = car(world, 0.0)
    ear = radio(world, mine)
    pole = world.spawn(described(CAM, **QUIET), Transform(Vector3D(40.0, 0.0, 5.0)))
    heard = frame(world, ear, pole)
    (of_pole,), (of_car,) = heard[ear.id], heard[pole.id]
    assert (of_pole.message.station_id, of_pole.message.station_type) == (pole.id, StationType.ROAD_SIDE_UNIT)
    assert (of_pole.message.state, of_pole.message.facts) == (None, None)
    antenna_m = mine.box.location.z + mine.box.extent.z + 0.02
    assert of_car.power_dbm == pytest.approx(winner_dbm(math.hypot(40.0, 5.0 - antenna_m)), abs=0.02)
    assert of_pole.power_dbm == of_car.power_dbm


def test_a_walker_is_a_station_with_its_antenna_above_the_head(world: World) -> None:
    mine = car(world, 0.0)
    ear, walker = (
        radio(world, mine),
        world.spawn(described("walker.pedestrian.0001"), Transform(Vector3D(30.0, 0.0, 1.0))),
    )
    radio(world, walker)
    (heard,) = frame(world, ear)[ear.id]
    pose = world.episode.transform(walker.id).location
    roof_m = mine.box.location.z + mine.box.extent.z
    distance_m = math.hypot(pose.x, pose.y, pose.z + walker.box.extent.z - roof_m)
    assert heard.power_dbm == pytest.approx(winner_dbm(distance_m), abs=0.02)
    assert heard.message.station_type is StationType.PEDESTRIAN
    assert heard.message.state is not None
    assert heard.message.facts == (VehicleRole.DEFAULT, 0)


def test_texts_reach_radios_for_texts_in_the_next_frame_and_no_others(world: World) -> None:
    mine, other = car(world, 0.0), car(world, 50.0)
    first, second, cam = radio(world, mine, CUSTOM), radio(world, other, CUSTOM), radio(world, other, fixed_rate="true")
    frame(world, first, second, cam)
    world.sensors.radios.say(first.id, "brake! ü")
    world.sensors.radios.say(first.id, "brake again")
    heard = frame(world, first, second, cam)
    assert [each.message for each in heard.pop(second.id)] == [(mine.id, "brake! ü"), (mine.id, "brake again")]
    assert heard == {}
    world.sensors.radios.say(second.id, "yes")
    assert [each.message.text for each in frame(world, first, second)[first.id]] == ["yes"]
    assert frame(world, first, second) == {}


def test_what_cannot_be_said_is_refused(world: World) -> None:
    mine = car(world, 0.0)
    mouth, cam, radios = radio(world, mine, CUSTOM), radio(world, mine), world.sensors.radios
    for text in ("ä" * 50, "x" * 100, "a\0b"):
        with pytest.raises(Refusal, match="at most 99 bytes"):
            radios.say(mouth.id, text)
    radios.say(mouth.id, "x" * 99)
    with pytest.raises(Refusal, match=f"actor {cam.id} cannot send a text; only sensor.other.v2x_custom does"):
        radios.say(cam.id, "hello")
    for _ in range(MOST_TEXTS - 1):
        radios.say(mouth.id, "")
    with pytest.raises(Refusal, match="tick the world"):
        radios.say(mouth.id, "one more")


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [
        ({"scenario": "village"}, "allowed are highway, rural, urban"),
        ({"path_loss_model": "friis"}, "allowed are winner, geometric"),
        ({"frequency_ghz": "0"}, "expected at least 0.001"),
        ({"d_ref": "-1"}, "expected at least 0.001"),
        ({"transmit_power": "loud"}, "expected a finite number"),
        ({"custom_fading_stddev": "-2"}, "expected at least 0"),
        ({"gen_cam_min": "0.5", "gen_cam_max": "0.2"}, "gen_cam_min must not be above gen_cam_max"),
    ],
)
def test_attributes_that_mean_nothing_are_refused_and_leave_no_actor(
    world: World, chosen: dict[str, str], sentence: str
) -> None:
    mine = car(world, 0.0)
    before = [record.id for record in world.episode.actors]
    with pytest.raises(Refusal, match=sentence):
        radio(world, mine, **chosen)
    assert [record.id for record in world.episode.actors] == before


def test_a_destroyed_radio_is_silent(world: World) -> None:
    ear, voice = radio(world, car(world, 0.0)), radio(world, car(world, 50.0), fixed_rate="true")
    frame(world, ear)
    world.destroy(voice.id)
    assert [frame(world, ear) for _ in range(5)] == [{}] * 5
