"""Claims about the bump of scenario I on a server: it lies on the road, sensors see it, and wheels roll over it."""

import math
from collections.abc import Iterator

import carla
import numpy as np
import pytest

from basu.managers.stage.scenario_actors import destroy_actors, member_of, spawn_actors
from basu.scenarios.library.control_loss.control_loss import BUMP_MODEL
from basu.scenarios.stage import ActorSpec, Pose
from basu.thresholds import is_rolled_over
from servers import RunningServer

PLACE = carla.Location(520.0, 128.1, 247.4)  # of control_loss_1, on Bonham Ave
AHEAD_M, TICKS = 8.0, 160


@pytest.fixture
def world(simulator: RunningServer) -> Iterator[carla.World]:
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(300.0)  # the first picture of a town waits for its scene
    world = client.load_world("Linden")
    before, settings = world.get_settings(), world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
    world.apply_settings(settings)
    yield world
    world.apply_settings(before)


def test_a_bump_is_seen_by_sensors_and_rolled_over_without_a_collision(
    world: carla.World, simulator: RunningServer
) -> None:
    client = carla.Client("127.0.0.1", simulator.port)
    lane = world.get_map().get_waypoint(PLACE)
    (ahead,) = lane.next(AHEAD_M)
    at, yaw_deg = ahead.transform.location, ahead.transform.rotation.yaw
    pose = Pose(at.x, at.y, at.z, math.radians(yaw_deg + 90.0))
    (bump,) = spawn_actors(client, world, [ActorSpec("bump 1", BUMP_MODEL, pose, on_ground=False)], "control_loss_2")
    library = world.get_blueprint_library()
    start = lane.transform
    start.location.z += 0.1
    shuttle = world.spawn_actor(library.find("vehicle.easymile.ez10"), start)
    front = carla.Transform(carla.Location(2.2, 0.0, 1.8), carla.Rotation(pitch=-10.0))
    lidar = world.spawn_actor(library.find("sensor.lidar.ray_cast_semantic"), front, attach_to=shuttle)
    picture = library.find("sensor.camera.instance_segmentation")
    for name, size in (("image_size_x", "200"), ("image_size_y", "150"), ("sensor_tick", "1.0")):
        picture.set_attribute(name, size)
    camera = world.spawn_actor(picture, front, attach_to=shuttle)
    touched = world.spawn_actor(library.find("sensor.other.collision"), carla.Transform(), attach_to=shuttle)
    met: set[int] = set()
    pixels, hits = [0], list[str]()
    lidar.listen(lambda scan: met.update(point.object_idx for point in scan))
    halves = {bump.actor.id & 0xFF, bump.actor.id >> 8 & 0xFF}  # of its number, in green and blue

    def count(image: carla.Image) -> None:
        blue, green = np.frombuffer(image.raw_data, np.uint8).reshape(-1, 4)[:, :2].T
        pixels.append(int((np.isin(blue, list(halves)) & np.isin(green, list(halves))).sum()))

    camera.listen(count)
    touched.listen(lambda event: hits.append(event.other_actor.type_id))
    try:
        assert is_rolled_over(member_of(bump.actor, "bump 1").height_m)
        shuttle.apply_control(carla.VehicleControl(throttle=0.6))
        for _ in range(TICKS):
            world.tick()
        passed_m = lane.transform.location.distance(shuttle.get_location())
        assert passed_m > AHEAD_M + 4.0
        assert bump.actor.id in met
        assert max(pixels) > 50
        assert hits == []
    finally:
        for sensor in (lidar, camera, touched):
            sensor.stop()
        destroy_actors(client, [lidar, camera, touched, shuttle, bump.actor])
