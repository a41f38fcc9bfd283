"""Services of the ros-bridge on `linden serve --ros2`, called by real rclpy, and what bad requests get."""

import json
import math
import os
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import carla
import pytest

from linden_ros2.rtps_wire import MAGIC
from rclpy_environment import Starts, rclpy_peer, rclpy_python
from servers import RunningServer, running_server

__all__ = ["rclpy_peer", "rclpy_python"]

LONGEST_S = 60.0
SPAWN = ("/carla/spawn_object", "carla_msgs/srv/SpawnObject")
DESTROY = ("/carla/destroy_object", "carla_msgs/srv/DestroyObject")
BLUEPRINTS = ("/carla/get_blueprints", "carla_msgs/srv/GetBlueprints")
CAR = "vehicle.tesla.model3"


class Caller:
    """A node of rclpy that calls services, and a CARLA client that looks at the world."""

    def __init__(self, server: RunningServer, start: Starts) -> None:
        self.server = server
        self.peer = start("call")
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(LONGEST_S)
        self.world = client.get_world()

    def call(self, service: tuple[str, str], **fields: Any) -> dict[str, Any]:
        """The answer of a service, with what the node knows of it."""
        self.peer.stdin.write(json.dumps([*service, fields]) + "\n")
        self.peer.stdin.flush()
        return json.loads(self.peer.stdout.readline())

    def answer(self, service: tuple[str, str], **fields: Any) -> dict[str, Any]:
        told = self.call(service, **fields)
        assert told["ready"]
        return told["answer"]

    def spawn_car(self, name: str) -> int:
        found = self.answer(SPAWN, type=CAR, id=name, transform=pose(self.world.get_map().get_spawn_points()[0]))
        assert found["error_string"] == ""
        return found["id"]


def pose(place: carla.Transform) -> dict[str, Any]:
    """A pose of ROS where CARLA has this one, which turns about z only; half a metre above."""
    turn = -math.radians(place.rotation.yaw) / 2.0
    return {
        "position": {"x": place.location.x, "y": -place.location.y, "z": place.location.z + 0.5},
        "orientation": {"z": math.sin(turn), "w": math.cos(turn)},
    }


def udp_ports(process: int) -> list[int]:
    """The ports of a process's sockets."""
    folder = Path(f"/proc/{process}")
    own = {str(file.readlink()) for file in (folder / "fd").iterdir()}
    rows = [line.split() for line in (folder / "net/udp").read_text().splitlines()[1:]]
    return [int(row[1].partition(":")[2], 16) for row in rows if f"socket:[{row[9]}]" in own]


@pytest.fixture(scope="module")
def server() -> Iterator[RunningServer]:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "CYCLONEDDS_URI"):
            patch.delenv(name, raising=False)
        patch.setenv("ROS_DOMAIN_ID", str(101 + os.getpid() % 90))
        with running_server("--ros2", "--sync") as server:
            yield server


@pytest.fixture
def caller(server: RunningServer, rclpy_peer: Starts) -> Iterator[Caller]:
    caller = Caller(server, rclpy_peer)
    yield caller
    for actor in caller.world.get_actors().filter("*"):
        if actor.type_id.startswith(("vehicle.", "sensor.")):
            actor.destroy()
    caller.world.tick()


def test_blueprints_are_those_of_the_client(caller: Caller) -> None:
    told = caller.call(BLUEPRINTS)
    assert sorted(told["answer"]["blueprints"]) == sorted(each.id for each in caller.world.get_blueprint_library())
    known = dict(told["services"])
    assert {name: known[name] for name, _ in (SPAWN, DESTROY, BLUEPRINTS)} == {
        name: [kind] for name, kind in (SPAWN, DESTROY, BLUEPRINTS)
    }
    matching = caller.answer(BLUEPRINTS, filter="vehicle.tesla.*")["blueprints"]
    assert sorted(matching) == sorted(
        each.id for each in caller.world.get_blueprint_library().filter("vehicle.tesla.*")
    )
    assert CAR in matching


def test_a_vehicle_and_its_sensor_are_spawned_published_and_destroyed(caller: Caller, rclpy_peer: Starts) -> None:
    """No frame is made until the vehicle and the sensor are there."""
    start = caller.world.get_map().get_spawn_points()[0]
    car_id = caller.spawn_car("bus")
    mount = {"position": {"x": 1.0, "y": 0.5, "z": 2.0}, "orientation": {"z": math.sqrt(0.5), "w": math.sqrt(0.5)}}
    sensor = caller.answer(
        SPAWN, type="sensor.other.imu", id="imu", transform=mount, attach_to=car_id, attributes=[["sensor_tick", "0.1"]]
    )
    assert sensor["error_string"] == ""
    caller.world.tick()
    car, imu = caller.world.get_actor(car_id), caller.world.get_actor(sensor["id"])
    assert (car.type_id, car.attributes["role_name"]) == (CAR, "bus")
    assert car.get_location().distance(start.location) < 1.0
    assert math.cos(math.radians(car.get_transform().rotation.yaw - start.rotation.yaw)) > 0.999
    assert imu.parent.id == car_id
    assert imu.attributes["sensor_tick"] == "0.1"
    place = imu.get_transform()
    assert math.cos(math.radians(place.rotation.yaw - start.rotation.yaw + 90.0)) > 0.999
    counter = rclpy_peer("count", "/carla/bus/imu", "sensor_msgs/msg/Imu", "5")
    until_s = time.monotonic() + LONGEST_S
    while counter.poll() is None and time.monotonic() < until_s:
        caller.world.tick()
        time.sleep(0.01)
    assert len(json.loads(counter.stdout.readline())) == 5
    assert caller.answer(DESTROY, id=car_id) == {"success": True}
    caller.world.tick()
    snapshot = caller.world.get_snapshot()
    assert not any(snapshot.has_actor(each) for each in (car_id, sensor["id"]))


def test_a_random_pose_is_a_free_spawn_point(caller: Caller) -> None:
    first = caller.answer(SPAWN, type="vehicle.tesla.*", random_pose=True)["id"]
    second = caller.answer(SPAWN, type="vehicle.tesla.*", random_pose=True)["id"]
    caller.world.tick()
    places = [caller.world.get_actor(each).get_location() for each in (first, second)]
    points = [each.location for each in caller.world.get_map().get_spawn_points()]
    assert all(min(place.distance(point) for point in points) < 2.0 for place in places)
    assert places[0].distance(places[1]) > 2.0


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"type": "vehicle.none"}, "there is no blueprint 'vehicle.none'"),
        ({"type": "none.*"}, "no blueprint matches 'none.*'; see /carla/get_blueprints"),
        ({"type": "sensor.pseudo.tf"}, "'sensor.pseudo.tf' is a part of the ros-bridge and no blueprint"),
        ({"type": CAR, "id": "no name"}, "the id 'no name' cannot be part of a topic's name"),
        ({"type": CAR, "attributes": [["wings", "2"]]}, "it has no attribute 'wings'"),
        ({"type": CAR, "transform": {"position": {"x": math.nan}}}, "a value that is no finite number"),
        ({"type": CAR, "transform": {"orientation": {"w": 0.0}}}, "the transform's orientation is no rotation"),
        ({"type": "sensor.other.gnss", "attach_to": 4_000_000}, "4000000"),
        ({"type": "sensor.other.obstacle", "id": "wall"}, "CARLA's publisher has no topic for its kind"),
    ],
)
def test_what_cannot_be_spawned_has_no_id_and_a_sentence(caller: Caller, fields: dict[str, Any], sentence: str) -> None:
    caller.world.tick()  # a new client knows no frame yet
    before = {actor.id for actor in caller.world.get_actors()}
    found = caller.answer(SPAWN, **fields)
    assert found["id"] == -1
    assert sentence in found["error_string"]
    caller.world.tick()
    assert {actor.id for actor in caller.world.get_actors()} == before


def test_what_is_not_there_cannot_be_destroyed(caller: Caller) -> None:
    assert caller.answer(DESTROY, id=4_000_000) == {"success": False}
    assert caller.answer(DESTROY, id=-1) == {"success": False}


def test_a_second_node_is_answered_after_the_first_was_killed(caller: Caller, rclpy_peer: Starts) -> None:
    assert caller.answer(BLUEPRINTS, filter=CAR) == {"blueprints": [CAR]}
    caller.peer.kill()
    caller.peer.wait()
    caller.peer = rclpy_peer("call")
    assert caller.answer(BLUEPRINTS, filter=CAR) == {"blueprints": [CAR]}


def test_answers_take_milliseconds(caller: Caller) -> None:
    caller.answer(BLUEPRINTS, filter=CAR)
    assert sorted(caller.call(BLUEPRINTS, filter=CAR)["took_s"] for _ in range(21))[10] < 0.5


def test_foreign_datagrams_do_not_end_the_services(caller: Caller) -> None:
    caller.answer(BLUEPRINTS, filter=CAR)
    ports = udp_ports(caller.server.process.pid)
    assert ports
    header = MAGIC + bytes(14)
    cut = (
        b"\x15\x03\xff\xff" + b"\xff" * 40,
        b"\x15" * 300,
        b"\x15\x07\x00\x00" + bytes(30),
        b"\x06\x01\x00\x00" + bytes(7),
    )
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for data in (b"", b"RTPS", b"\xff" * 100, *(header + each for each in cut)):
            for port in ports:
                sender.sendto(data, ("127.0.0.1", port))
    assert caller.answer(BLUEPRINTS, filter=CAR) == {"blueprints": [CAR]}


def test_a_node_sets_the_weather(caller: Caller, rclpy_peer: Starts) -> None:
    scattering = caller.world.get_weather().rayleigh_scattering_scale
    rclpy_peer("weather")
    until_s = time.monotonic() + LONGEST_S
    while caller.world.get_weather().cloudiness != 40.0 and time.monotonic() < until_s:
        caller.world.tick()
        time.sleep(0.01)
    weather = caller.world.get_weather()
    assert (weather.cloudiness, weather.sun_altitude_angle) == (40.0, 12.5)
    assert weather.rayleigh_scattering_scale == scattering
