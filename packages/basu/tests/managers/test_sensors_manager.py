"""Claims about what an agent gets to see: what all its sensors measured, in step with a live simulator's ticks."""

import json
import queue
from pathlib import Path

import carla
import numpy as np
import pytest

import basu
from basu.agents.sensor_file import read_sensors
from basu.cli import main
from servers import RunningServer

AGENT = """
class Looking(AutonomousAgent):
    def setup(self):
        self.steps = []

    def sensors(self):
        small = {"width": 32, "height": 24}
        return [
            {"type": "sensor.camera.rgb", "id": "LEFT", "y": -0.5, "z": 2.4, **small},
            {"type": "sensor.camera.rgb", "id": "RIGHT", "y": 0.5, "z": 2.4, **small},
            {"type": "sensor.lidar.ray_cast", "id": "LIDAR", "z": 2.9, "channels": 4, "points_per_second": 4000},
            {"type": "sensor.other.radar", "id": "RADAR", "x": 2.1, "z": 0.7, "fov": 30},
            {"type": "sensor.other.gnss", "id": "GNSS"},
            {"type": "sensor.other.imu", "id": "IMU"},
            {"type": "sensor.camera.depth", "id": "SELDOM", "z": 2.4, "sensor_tick": 0.1, **small},
        ]

    def run_step(self, sensor_data):
        now = self.world.get_snapshot().frame
        self.steps.append((now, {name: frame for name, (frame, _) in sensor_data.items()}))
        assert (sensor_data["LEFT"][1].width, sensor_data["LEFT"][1].height) == (32, 24)
        if len(self.steps) > 20:
            open(FOLDER + "/steps.json", "w").write(json.dumps(self.steps))
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.3)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3"}
"""


@pytest.fixture
def steps(simulator: RunningServer, tmp_path: Path, route_file: Path) -> list[tuple[int, dict[str, int]]]:
    """The frames in which the agent ran, each with those of its measurements."""
    agent = tmp_path / "looking.py"
    agent.write_text(f"import json\nFOLDER = {str(tmp_path)!r}\n" + AGENT)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--agent-writes", str(tmp_path)]
    main(["run", str(agent), *address, "--routes", str(route_file), "--output", str(tmp_path / "runs")])
    return [(now, frames) for now, frames in json.loads((tmp_path / "steps.json").read_text())]


def test_every_measurement_is_of_the_frame_of_the_agents_step(
    steps: list[tuple[int, dict[str, int]]],
) -> None:
    numbers = [now for now, _ in steps]
    assert numbers == list(range(numbers[0], numbers[0] + 21))
    order = ["LEFT", "RIGHT", "LIDAR", "RADAR", "GNSS", "IMU", "SELDOM"]
    assert all(list(frames) == order for _, frames in steps)  # whichever answered first
    seldom = [frames.pop("SELDOM") for _, frames in steps]
    assert all(set(frames.values()) == {now} for now, frames in steps)
    assert {now - frame for now, frame in zip(numbers, seldom, strict=True)} == {0, 1}


def test_nothing_of_the_sensors_is_left_behind(
    simulator: RunningServer, steps: list[tuple[int, dict[str, int]]]
) -> None:
    assert steps
    world = carla.Client("127.0.0.1", simulator.port).get_world()
    assert not world.get_actors().filter("sensor.*")


POINT = np.dtype([("place", "<f4", 3), ("cosine", "<f4"), ("actor", "<u4"), ("label", "<u4")])
ROAD = 1
TURN_S = 0.05


@pytest.mark.parametrize(("name", "most_own"), [("rig.json", 0.1), ("autoware_sensors.json", 0.35)])
def test_the_lidar_of_a_packaged_rig_sees_the_road_and_little_of_its_own_shuttle(
    simulator: RunningServer, name: str, most_own: float
) -> None:
    (lidar,) = (
        spec
        for spec in read_sensors(Path(basu.__file__).parent / "config" / name)
        if spec.type_id == "sensor.lidar.ray_cast"
    )
    world = carla.Client("127.0.0.1", simulator.port).get_world()
    before = world.get_settings()
    with_whole_turns = world.get_settings()
    with_whole_turns.synchronous_mode, with_whole_turns.fixed_delta_seconds = True, TURN_S
    world.apply_settings(with_whole_turns)
    library, pose = world.get_blueprint_library(), carla.Location(lidar.x_m, lidar.y_m, lidar.z_m)
    shuttle = world.spawn_actor(library.find("vehicle.easymile.ez10"), world.get_map().get_spawn_points()[10])
    blueprint = library.find("sensor.lidar.ray_cast_semantic")
    for attribute, value in lidar.attributes:
        if attribute in {"channels", "range", "points_per_second", "upper_fov", "lower_fov"}:
            blueprint.set_attribute(attribute, value)
    blueprint.set_attribute("rotation_frequency", f"{1.0 / TURN_S:g}")
    eye = world.spawn_actor(blueprint, carla.Transform(pose), attach_to=shuttle)
    clouds: queue.Queue[bytes] = queue.Queue()
    eye.listen(lambda measured: clouds.put(bytes(measured.raw_data)))
    world.tick(60.0)
    points = np.frombuffer(clouds.get(timeout=60.0), POINT)
    eye.stop()
    for actor in (eye, shuttle):
        actor.destroy()
    world.apply_settings(before)
    assert np.mean(points["actor"] == shuttle.id) < most_own
    assert np.mean(points["label"] == ROAD) > 0.15
