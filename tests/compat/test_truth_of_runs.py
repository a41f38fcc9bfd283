"""The same seed and the same commands give the same bytes of every sensor, whichever server makes them."""

import carla
import pytest

from servers import running_server
from watching import made, watching

FRAMES = 5
SMALL = {"image_size_x": 160, "image_size_y": 120}
ROOF = carla.Transform(carla.Location(x=0.6, z=2.0))

SEMANTIC = "sensor.lidar.ray_cast_semantic"
DICE: dict[str, dict[str, object]] = {
    "sensor.lidar.ray_cast": {"noise_stddev": 0.02},
    "sensor.other.radar": {},
    "sensor.other.gnss": {"noise_alt_stddev": 0.1, "noise_lat_stddev": 1e-6, "noise_lon_stddev": 1e-6},
    "sensor.other.imu": {"noise_accel_stddev_x": 0.1, "noise_gyro_stddev_z": 0.01},
}
OTHERWISE = ", another seed"


def rig() -> dict[str, tuple[str, dict[str, object]]]:
    """Blueprint and attributes of sensors by name: those that throw dice also from another seed.

    There is no event camera among them: it remembers since when it is heard, which no client can choose to the frame.
    """
    silent = {f"sensor.camera.{kind}": SMALL for kind in ("rgb", "depth", "instance_segmentation", "optical_flow")}
    found = {name: (name, chosen) for name, chosen in silent.items()} | {SEMANTIC: (SEMANTIC, {})}
    for seed, suffix in ((7, ""), (8, OTHERWISE)):
        found |= {name + suffix: (name, chosen | {"noise_seed": seed}) for name, chosen in DICE.items()}
    return found


def ridden() -> dict[int, dict[str, bytes]]:
    """What each sensor of a car told in each frame of a drive among others, in a server of its own."""
    with running_server("--sync") as server:
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(60.0)
        world = client.get_world()
        library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
        cars = [world.spawn_actor(library.find("vehicle.tesla.model3"), point) for point in points[:12:2]]
        for car in cars:
            car.apply_control(carla.VehicleControl(throttle=0.8, steer=0.1))
        sensors = {name: made(world, kind, ROOF, on=cars[0], chosen=chosen) for name, (kind, chosen) in rig().items()}
        with watching(world, sensors) as next_frame:
            found = [next_frame() for _ in range(FRAMES)]
        return {each[SEMANTIC].frame: {name: told.raw for name, told in each.items()} for each in found}


@pytest.mark.slow
def test_two_servers_send_the_same_bytes_and_another_seed_throws_other_dice() -> None:
    first, second = ridden(), ridden()
    frames = sorted(first.keys() & second.keys())  # one may have been heard a frame sooner
    assert len(frames) > FRAMES // 2
    for frame in frames:
        for name, told in first[frame].items():
            assert told == second[frame][name], (frame, name)
        for name in DICE:
            assert first[frame][name] != first[frame][name + OTHERWISE], (frame, name)
