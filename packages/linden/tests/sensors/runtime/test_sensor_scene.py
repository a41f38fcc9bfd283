"""What sensors look at in an episode: who is there, where from, how fast, and what shines."""

from threading import Event

import numpy as np
import pytest

from fakes.solids import box, described, floor
from home_map import home_map
from linden.background import checkpoint
from linden.geometry import compose, rotation_matrix
from linden.maps.library import LoadedMap, MapLibrary
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.actors.posing import matrices
from linden.scenery.mesh import LampOf, Mesh, join
from linden.sensors.casting.caster import STATIC, Rays
from linden.sensors.runtime.sensor_scene import SensorScene
from linden.world import World
from opendrive_texts import street_through_junction

STEP_S = 0.05


@pytest.fixture(scope="module")
def world_map() -> LoadedMap:
    return home_map()


@pytest.fixture(scope="module")
def sensor_scene(world_map: LoadedMap) -> SensorScene:
    """For all episodes: what stands is a floor, and a box for the last box of the scene."""
    last = len(World(world_map).episode.surroundings.scene.boxes) - 1
    sensor_scene = SensorScene()
    sensor_scene.standing_on = lambda _map, _scene: join(
        [floor(2000.0), box((1.0, 1.0, 1.0), centre_m=(0.0, 0.0, 500.0), thing=last)]
    )
    return sensor_scene


@pytest.fixture
def simulation(world_map: LoadedMap, sensor_scene: SensorScene) -> World:
    simulation = World(world_map, EpisodeSettings())
    simulation.sensor_scene = sensor_scene
    return simulation


def look(simulation: World):
    return simulation.sensor_scene.look(simulation.episode, simulation.frame)


def test_many_poses_make_the_matrices_that_one_by_one_makes() -> None:
    dice = np.random.default_rng(3)
    poses = np.column_stack([dice.uniform(-9.0, 9.0, (20, 3)), dice.uniform(-180.0, 180.0, (20, 3))])
    for pose, made in zip(poses, matrices(poses), strict=True):
        np.testing.assert_allclose(made[:, :3], rotation_matrix(Rotation(*pose[3:])), atol=1e-12)
        np.testing.assert_allclose(made[:, 3], pose[:3])


def test_a_car_is_seen_where_it_is_with_all_its_wheels(simulation: World) -> None:
    point = simulation.spawn_points[0]
    car = simulation.spawn(described("vehicle.tesla.model3", color="10,20,30"), point)
    simulation.step(STEP_S)
    seen = look(simulation)
    mine = np.flatnonzero(seen.instances.actor_id == car.id)
    assert len(mine) >= 5
    assert {tuple(colour) for colour in seen.instances.colour[mine].tolist()} == {(10, 20, 30)}
    place = simulation.episode.transform(car.id).location
    above = np.array([[place.x, place.y, place.z + 20.0]], np.float32)
    hits = seen.caster.closest(Rays(above, np.float32([[0.0, 0.0, -1.0]])), 50.0)
    assert seen.instances.actor_id[hits.instance[0]] == car.id
    assert hits.distance_m[0] == pytest.approx(20.0 - 2.0 * car.box.extent.z, abs=0.1)


def test_before_is_where_a_body_was_a_frame_earlier_if_a_sensor_looked_then(simulation: World) -> None:
    prop = simulation.spawn(described("static.prop.container"), Transform(Vector3D(0.0, 0.0, 50.0)))
    simulation.step(STEP_S)
    simulation.sensor_scene.follow(simulation.episode, simulation.frame)
    simulation.episode.place(prop.id, Transform(Vector3D(3.0, 0.0, 50.0)))
    simulation.step(STEP_S)
    moved = look(simulation).instances
    assert moved.pose[0, :, 3].tolist() == [3.0, 0.0, 50.0]
    assert moved.before[0, :, 3].tolist() == [0.0, 0.0, 50.0]
    simulation.episode.place(prop.id, Transform(Vector3D(9.0, 0.0, 50.0)))
    simulation.step(STEP_S)
    simulation.step(STEP_S)  # a frame in which nobody looked
    later = look(simulation).instances
    assert later.before.tolist() == later.pose.tolist()


def test_an_actor_that_comes_while_others_go_has_no_past_of_another(simulation: World) -> None:
    first = simulation.spawn(described("static.prop.container"), Transform(Vector3D(0.0, 0.0, 50.0)))
    second = simulation.spawn(described("static.prop.container"), Transform(Vector3D(0.0, 30.0, 50.0)))
    simulation.step(STEP_S)
    simulation.sensor_scene.follow(simulation.episode, simulation.frame)
    simulation.destroy(first.id)
    third = simulation.spawn(described("static.prop.container"), Transform(Vector3D(0.0, 60.0, 50.0)))
    simulation.step(STEP_S)
    seen = look(simulation).instances
    assert sorted(set(seen.actor_id.tolist())) == [second.id, third.id]
    assert seen.before[:, 1, 3].tolist() == seen.pose[:, 1, 3].tolist()


def test_what_is_attached_moves_as_its_bearer_does(simulation: World) -> None:
    car = simulation.spawn(described("vehicle.tesla.model3"), simulation.spawn_points[0])
    roof = Transform(Vector3D(0.0, 0.0, 3.0))
    box_on_it = simulation.spawn(described("static.prop.box01"), roof, parent_id=car.id)
    slot = car.slot
    simulation.episode.bodies.set_target_velocity(slot, (4.0, 1.0, 0.0))
    simulation.step(STEP_S)
    seen = look(simulation).instances
    row = int(np.flatnonzero(seen.actor_id == box_on_it.id)[0])
    expected = compose(simulation.episode.transform(car.id), roof).location
    np.testing.assert_allclose(seen.pose[row, :, 3], expected, atol=1e-3)
    np.testing.assert_allclose(seen.velocity_mps[row], simulation.episode.bodies.velocity[slot], atol=0.3)


def test_a_cars_lamps_shine_as_its_light_state_says_and_blinkers_blink(simulation: World) -> None:
    car = simulation.spawn(described("vehicle.tesla.model3"), simulation.spawn_points[0])
    car.light_state = 0x1 | 0x10  # position, right blinker
    seen_states = set()
    for _ in range(20):
        simulation.step(STEP_S)
        instances = simulation.sensor_scene.follow(simulation.episode, simulation.frame)
        seen_states.add(int(instances.lights[instances.actor_id == car.id][0]))
    assert seen_states == {1 << LampOf.TAIL, 1 << LampOf.TAIL | 1 << LampOf.BLINKER_RIGHT}


def test_lights_show_their_colour_and_are_known_by_their_actors_id(simulation: World) -> None:
    episode = simulation.episode
    episode.traffic.freeze_all(frozen=True)
    episode.traffic.set_colour(0, TrafficLightState.GREEN)
    episode.traffic.set_colour(1, TrafficLightState.RED)
    simulation.step(STEP_S)
    seen, things = look(simulation), episode.surroundings.scene.boxes["thing"]
    for light, lens in ((0, LampOf.TRAFFIC_GREEN), (1, LampOf.TRAFFIC_RED)):
        boxes = np.flatnonzero(seen.object_id == episode.light_ids[light])
        assert len(boxes)
        assert len(set(things[boxes].tolist())) == 1
        assert set(seen.object_lights[boxes].tolist()) == {1 << lens}


def test_ids_of_objects_are_their_own_even_in_the_16_bits_that_a_picture_has(simulation: World) -> None:
    ids = look(simulation).object_id
    scenery = ids[ids >= 0x8000_0000]
    assert len(set((scenery & 0xFFFF).tolist())) == len(scenery)
    assert (scenery & 0xFFFF).min() >= 0x8000


def test_objects_that_are_disabled_are_not_seen_and_come_back(simulation: World) -> None:
    scene = simulation.episode.surroundings.scene
    last, down = scene.objects[-1].id, Rays(np.float32([[0.0, 0.0, 510.0]]), np.float32([[0.0, 0.0, -1.0]]))
    distances = []
    for enabled in (True, False, True):
        simulation.episode.surroundings.enable([last], enabled=enabled)
        simulation.step(STEP_S)
        hits = look(simulation).caster.closest(down, 600.0)
        assert hits.instance[0] == STATIC
        distances.append(float(hits.distance_m[0]))
    assert distances == pytest.approx([9.0, 510.0, 9.0], abs=1e-3)


def test_nothing_is_built_before_a_sensor_that_looks_is_there(world_map: LoadedMap) -> None:
    simulation = World(world_map, EpisodeSettings())

    def never(_map: LoadedMap, _scene: object):
        pytest.fail("nobody looks")

    simulation.sensor_scene.standing_on = never
    simulation.spawn(described("sensor.other.gnss"), Transform())
    for _ in range(3):
        simulation.step(STEP_S)
        simulation.measure({1, 2, 3})


def test_building_begins_when_a_sensor_that_looks_is_spawned_and_is_waited_for(world_map: LoadedMap) -> None:
    simulation = World(world_map, EpisodeSettings())
    begun, may_go_on = Event(), Event()

    def late(_map: LoadedMap, _scene: object) -> Mesh:
        begun.set()
        assert may_go_on.wait(60.0)
        return floor(2000.0)

    simulation.sensor_scene.standing_on = late
    lidar = simulation.spawn(described("sensor.lidar.ray_cast"), Transform(Vector3D(0.0, 0.0, 3.0)))
    assert begun.wait(60.0)
    simulation.step(STEP_S)
    may_go_on.set()
    assert len(simulation.measure({lidar.stream_id})[0].reading.points) > 0


def test_a_reading_does_not_depend_on_earlier_listeners(simulation: World, world_map: LoadedMap) -> None:
    def sixth(listened_from: int) -> bytes:
        running = World(world_map, EpisodeSettings())
        running.sensor_scene = simulation.sensor_scene
        chosen = {"rotation_frequency": 7, "noise_stddev": 0.1, "range": 50}
        lidar = running.spawn(described("sensor.lidar.ray_cast", **chosen), Transform(Vector3D(0.0, 0.0, 3.0)))
        for frame in range(6):
            running.step(STEP_S)
            found = running.measure({lidar.stream_id} if frame >= listened_from else set())
        return found[0].reading.points.tobytes()

    assert sixth(0) == sixth(5)


def test_a_thread_that_waits_for_the_scene_has_it_or_goes_on_without_it(world_map: LoadedMap) -> None:
    sensor_scene, may_build = SensorScene(), Event()
    assert sensor_scene.wait(60.0)  # without any request

    def standing_on(*_: object) -> Mesh:
        may_build.wait()
        return floor(9.0)

    sensor_scene.standing_on = standing_on
    simulation = World(world_map, EpisodeSettings())
    sensor_scene.prepare(simulation.episode)
    assert not sensor_scene.wait(0.01)
    may_build.set()
    assert sensor_scene.wait(60.0)
    simulation.sensor_scene = sensor_scene
    assert len(look(simulation).standing.triangles) == len(floor(9.0).triangles)


def test_a_load_of_another_map_gives_up_what_was_being_built(world_map: LoadedMap) -> None:
    simulation, begun, ended = World(world_map, EpisodeSettings()), Event(), Event()

    def build_for_ever(_map: LoadedMap, _scene: object) -> Mesh:
        begun.set()
        try:
            while True:
                checkpoint()
        finally:
            ended.set()

    simulation.sensor_scene.standing_on = build_for_ever
    simulation.spawn(described("sensor.lidar.ray_cast"), Transform())
    assert begun.wait(20)
    simulation.load(world_map, reset_settings=False)
    assert not ended.is_set()  # the same map wants the same
    simulation.load(MapLibrary().from_opendrive(street_through_junction()), reset_settings=False)
    assert ended.wait(20)
    assert simulation.sensor_scene.wait(0.0)


def test_a_lidar_does_not_wait_for_the_kernels_of_cameras(world_map: LoadedMap, sensor_scene: SensorScene) -> None:
    simulation, waited = World(world_map, EpisodeSettings()), list[bool]()
    own = SensorScene()
    own.standing_on, own.await_kernels, own.is_compiling = sensor_scene.standing_on, waited.append, lambda: True
    simulation.sensor_scene = own
    simulation.spawn(described("sensor.lidar.ray_cast"), Transform())
    assert own.wait(60.0)
    look(simulation)
    assert waited == [False]
    simulation.spawn(described("sensor.camera.depth"), Transform())
    assert own.wait(60.0)
    look(simulation)
    assert waited == [False, True]
    look(simulation)
    assert waited == [False, True]  # the scene with pictures is kept
