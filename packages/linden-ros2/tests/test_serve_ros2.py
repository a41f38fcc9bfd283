"""Real rclpy on `linden serve --ros2`: what it hears without a client that listens, and the vehicle that it drives.

Neither side sets a variable but the domain, so the defaults of both find each other on this machine.
"""

import itertools
import json
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from subprocess import Popen

import carla
import pytest

from linden_ros2.sensor_messages import NATIVE, sensor_types
from linden_ros2.types import Generation, types_of
from rclpy_environment import Starts, rclpy_peer, rclpy_python
from servers import RunningServer, running_server

__all__ = ["rclpy_peer", "rclpy_python"]

LONGEST_S = 60.0
STEP_S = 0.05
SLOW_S = 0.1
KINDS = {
    "imu": "sensor.other.imu",
    "gnss": "sensor.other.gnss",
    "radar": "sensor.other.radar",
    "lidar": "sensor.lidar.ray_cast",
    "labels": "sensor.lidar.ray_cast_semantic",
    "front": "sensor.camera.rgb",
    "flow": "sensor.camera.optical_flow",
    "events": "sensor.camera.dvs",
}


class Drive:
    """A synchronous world with the vehicle `hero` and its sensors, none of which a client listens to."""

    def __init__(self, server: RunningServer) -> None:
        self.server = server
        self.client = carla.Client("127.0.0.1", server.port)
        self.client.set_timeout(300.0)
        self.world = self.client.get_world()
        self.library = self.world.get_blueprint_library()
        car = self.library.find("vehicle.tesla.model3")
        car.set_attribute("role_name", "hero")
        self.start = self.world.get_map().get_spawn_points()[0]
        self.car = self.world.spawn_actor(car, self.start)
        self.sensors = {name: self.sensor(kind, name) for name, kind in KINDS.items()}
        for sensor in self.sensors.values():
            sensor.enable_for_ros()

    def sensor(self, kind: str, name: str = "") -> carla.Sensor:
        """A small sensor on the vehicle; the inertial unit measures every other frame."""
        blueprint = self.library.find(kind)
        if name:
            blueprint.set_attribute("ros_name", name)
        if kind == "sensor.other.imu":
            blueprint.set_attribute("sensor_tick", str(SLOW_S))
        if ".camera." in kind:
            blueprint.set_attribute("image_size_x", "16")
            blueprint.set_attribute("image_size_y", "8")
        place = carla.Transform(carla.Location(x=1.0, y=0.5, z=2.0), carla.Rotation(yaw=90.0))
        return self.world.spawn_actor(blueprint, place, attach_to=self.car)

    def control(self, control: carla.VehicleControl) -> None:
        self.client.apply_batch_sync([carla.command.ApplyVehicleControl(self.car, control)])

    def rest(self) -> None:
        """Put the vehicle at the start, without a control; `apply_control` sends none that equals its last one."""
        for _ in range(20):  # commands that were on their way when the last node ended
            self.world.tick()
            time.sleep(0.01)
        self.control(carla.VehicleControl())
        self.car.set_transform(self.start)  # before it meets a house
        self.world.tick()

    def until(self, holds: Callable[[], bool]) -> bool:
        """Tick until something holds; whether it does within the limit."""
        until_s = time.monotonic() + LONGEST_S
        while not holds() and time.monotonic() < until_s:
            self.world.tick()
            time.sleep(0.01)  # a node's time between two frames is wall time
        return holds()

    def told(self, sentence: str) -> bool:
        """Tick until the server's log has a sentence."""
        return self.until(lambda: sentence in self.server.log())

    def heard(self, peer: "Popen[str]") -> list[dict]:
        """Tick until a node has printed what it heard."""
        with ThreadPoolExecutor(1) as pool:  # what was heard is more than a pipe holds
            told = pool.submit(peer.stdout.readline)
            if not self.until(told.done):
                peer.kill()
            return json.loads(told.result() or "[]")


@pytest.fixture(scope="module")
def drive() -> Iterator[Drive]:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "CYCLONEDDS_URI"):
            patch.delenv(name, raising=False)
        patch.setenv("ROS_DOMAIN_ID", str(101 + os.getpid() % 90))
        with running_server("--ros2", "--sync") as server:
            yield Drive(server)


@pytest.fixture(autouse=True)
def _at_rest(drive: Drive) -> None:
    drive.rest()


def test_every_topic_arrives_though_no_client_listens(drive: Drive, rclpy_peer: Starts) -> None:
    """Name, type with its hash, QoS, stamp and frame; the node is in the list of nodes."""
    own = [
        (f"/carla/hero/{name}{suffix}", kind, name)
        for name, type_id in KINDS.items()
        for suffix, kind in sensor_types(type_id, NATIVE)
    ]
    topics = [("/clock", "rosgraph_msgs/msg/Clock", None), ("/tf", "tf2_msgs/msg/TFMessage", None), *own]
    peer = rclpy_peer("hear")
    peer.stdin.write(json.dumps([[name, kind, False, True] for name, kind, _ in topics]) + "\n")
    peer.stdin.flush()
    drive.control(carla.VehicleControl(throttle=0.3))  # an event camera sees nothing where nothing moves
    heard = {each["topic"]: each for each in drive.heard(peer)}
    assert sorted(heard) == sorted(name for name, _, _ in topics)
    types = types_of(Generation.ROS_2)
    for name, kind, frame in topics:
        found = heard[name]
        assert (found["type"], found["hash"], found["frame"]) == (kind, types.store.hash_rihs01(kind), frame), name
        assert (found["latched"], found["reliable"], found["nodes"]) == (False, True, ["carla"]), name
        if frame is not None:
            sec, nanosec = found["stamp"]
            steps = (sec + 1e-9 * nanosec) / STEP_S
            assert steps == pytest.approx(round(steps), abs=1e-4), name
    tree = types.parsed(bytes.fromhex(heard["/tf"]["bytes"]), "tf2_msgs/msg/TFMessage").transforms
    rows = {each.child_frame_id: each for each in tree}
    assert {name: each.header.frame_id for name, each in rows.items()} == {
        "hero": "map", **dict.fromkeys(KINDS, "hero"),
    }  # fmt: skip
    place = drive.car.get_transform().location
    assert abs(place.y) > 10.0
    assert rows["hero"].transform.translation.y == pytest.approx(-place.y, abs=5.0)  # it has driven since
    turn = rows["lidar"].transform.rotation
    assert (turn.z, turn.w) == pytest.approx((-(0.5**0.5), 0.5**0.5))
    cloud = types.parsed(bytes.fromhex(heard["/carla/hero/lidar"]["bytes"]), "sensor_msgs/msg/PointCloud2")
    assert cloud.width > 0
    assert [field.name for field in cloud.fields] == ["x", "y", "z", "intensity"]


@pytest.mark.parametrize(
    ("topic", "kind", "step_s"),
    [("/clock", "rosgraph_msgs/msg/Clock", STEP_S), ("/carla/hero/imu", "sensor_msgs/msg/Imu", SLOW_S)],
)
def test_a_late_joiner_hears_every_frame(
    drive: Drive, rclpy_peer: Starts, topic: str, kind: str, step_s: float
) -> None:
    stamps = drive.heard(rclpy_peer("count", topic, kind, "20"))
    assert [later - earlier for earlier, later in itertools.pairwise(stamps)] == pytest.approx([step_s] * 19)


def test_a_node_drives(drive: Drive, rclpy_peer: Starts) -> None:
    drive.until(lambda: drive.car.get_velocity().length() < 0.5)
    rclpy_peer("command", "pedals")
    assert drive.until(lambda: drive.car.get_velocity().length() > 2.0)
    assert drive.car.get_control().throttle == 0.75
    drive.control(carla.VehicleControl(brake=1.0))


def test_what_is_no_number_is_refused_and_another_domain_is_not_heard(drive: Drive, rclpy_peer: Starts) -> None:
    rclpy_peer("command", "pedals", domain=int(os.environ["ROS_DOMAIN_ID"]) + 1)
    rclpy_peer("command", "nan")
    assert drive.told(
        "/carla/hero/vehicle_control_cmd: a command is refused, because its throttle is nan; it must be a finite number"
    )
    assert drive.car.get_control().throttle == 0.0


def test_a_flood_is_limited_and_drives_all_the_same(drive: Drive, rclpy_peer: Starts) -> None:
    rclpy_peer("command", "flood")
    assert drive.until(lambda: drive.car.get_control().throttle == 0.75)
    assert drive.told("10 or more commands came within a frame; only the newest counts")


def test_a_node_that_leaves_is_noted_and_its_last_command_holds(drive: Drive, rclpy_peer: Starts) -> None:
    peer = rclpy_peer("command", "pedals")
    assert drive.until(lambda: drive.car.get_control().throttle == 0.75)
    peer.kill()
    assert drive.told("the last node that commanded has left; the vehicle keeps its last command")
    assert drive.car.get_control().throttle == 0.75


@pytest.mark.parametrize("successors", [("best-effort", "ackermann"), ("ackermann", "best-effort")])
def test_nodes_take_over_from_one_that_was_killed(
    drive: Drive, rclpy_peer: Starts, successors: tuple[str, str]
) -> None:
    """A node of the same machine takes the ports of the one before it."""
    peer = rclpy_peer("command", "pedals")
    for successor in successors:
        assert drive.until(lambda: drive.car.get_control().throttle > 0.0)
        peer.kill()
        peer.wait()
        assert drive.told("the last node that commanded has left")
        drive.rest()
        peer = rclpy_peer("command", successor)
    assert drive.until(lambda: drive.car.get_control().throttle > 0.0)


def test_a_reader_that_is_killed_does_not_hold_up_the_ticks(drive: Drive, rclpy_peer: Starts) -> None:
    peer = rclpy_peer("count", "/carla/hero/lidar", "sensor_msgs/msg/PointCloud2", "1000000")
    longest_s = 0.0
    drive.until(lambda: drive.world.get_snapshot().frame % 100 == 0)
    peer.kill()
    for _ in range(100):
        began_s = time.monotonic()
        drive.world.tick()
        longest_s = max(longest_s, time.monotonic() - began_s)
    assert longest_s < 2.0


def test_switching_a_sensor_off_and_on(drive: Drive) -> None:
    gnss = drive.sensors["gnss"]
    assert gnss.is_enabled_for_ros()
    gnss.disable_for_ros()
    assert not gnss.is_enabled_for_ros()
    gnss.enable_for_ros()
    assert gnss.is_enabled_for_ros()


@pytest.mark.parametrize(
    ("kind", "name", "sentence"),
    [
        ("sensor.other.gnss", "no-name", "'hero/no-name' cannot be part of a topic's name"),
        ("sensor.other.gnss", "gnss", "/carla/hero/gnss is already the topic of sensor"),
        ("sensor.other.obstacle", "wall", "CARLA's publisher has no topic for its kind"),
    ],
)
def test_what_cannot_be_published_is_refused_with_a_reason(drive: Drive, kind: str, name: str, sentence: str) -> None:
    sensor = drive.sensor(kind, name)
    sensor.enable_for_ros()
    assert not sensor.is_enabled_for_ros()
    assert drive.told(sentence)
    sensor.destroy()
    drive.world.tick()
