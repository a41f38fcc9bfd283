"""What a world publishes, with a node that keeps it: names, topics, frames, commands, and what is refused."""

import logging
import sys
from types import SimpleNamespace as Fake
from typing import Any

import pytest

from linden.cli import main
from linden.errors import Refusal
from linden.maps.library import MapLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire.stream import StreamTable
from linden.server import frames
from linden.server.rpc.context import Context, Follower
from linden.simulation.actor_table import ActorRecord
from linden.world import World
from linden_ros2.commands import DEPTH
from linden_ros2.publisher import WorldPublisher
from linden_ros2.topic import Message, Topic
from linden_ros2.types import Generation, types_of
from opendrive_texts import SIGNS_AND_LIGHTS

DRIVE = "carla_msgs/msg/CarlaEgoVehicleControl"


class KeepingNode:
    """A node without a domain: keeps what is published, and has what a test puts in."""

    def __init__(self) -> None:
        self.types = types_of(Generation.ROS_2)
        self.announced: set[str] = set()
        self.listened: set[str] = set()
        self.published: list[Message] = []
        self.inbox: dict[str, list[Any]] = {}
        self.writers = 1

    def announce(self, *topics: Topic) -> None:
        self.announced |= {topic.name for topic in topics}

    def listen(self, *topics: Topic) -> None:
        self.listened |= {topic.name for topic in topics}

    def drop(self, *topics: Topic) -> None:
        self.announced -= {topic.name for topic in topics}
        self.listened -= {topic.name for topic in topics}

    def publish(self, *messages: Message) -> None:
        self.published += messages

    def received(self, topic: Topic) -> list[Any]:
        found = self.inbox.pop(topic.name, [])
        if found == ["foreign"]:
            raise ValueError("not a message")
        return found

    def unheard(self, _topic: Topic) -> list[str]:
        return []

    def writers_of(self, _topic: Topic) -> int:
        return self.writers


class Scene:
    """A server's state with a publisher."""

    def __init__(self) -> None:
        self.node = KeepingNode()
        world = World(MapLibrary().from_opendrive(SIGNS_AND_LIGHTS))
        self.context = Context(world, MapLibrary(), frames, StreamTable(0), lambda: 0.05)
        self.context.publisher = self.publisher = WorldPublisher(self.context, self.node)
        follower = Follower("publisher", self.publisher.after_frame, self.publisher.before_frame)
        self.context.followers.append(follower)

    def spawn(self, kind: str, parent_id: int = 0, **attributes: str) -> ActorRecord:
        values = tuple(AttributeValue(name, AttributeType.STRING, value) for name, value in attributes.items())
        uid = self.context.world.library.find(kind).definition.uid
        place = Transform(Vector3D(10.0, 2.0, 1.0), Rotation(0.0, 90.0, 0.0))
        if not parent_id:
            place = self.context.world.spawn_points[0]
        return self.context.world.spawn(ActorDescription(uid, kind, values), place, parent_id=parent_id)

    def topics(self) -> list[str]:
        """Make a frame; the topics that it was published on."""
        self.node.published.clear()
        self.context.advance()
        return [message.topic.name for message in self.node.published]

    def command(self, actor_name: str, *throttles: float) -> None:
        self.node.inbox[f"/carla/{actor_name}/vehicle_control_cmd"] = [
            self.node.types.message(DRIVE, throttle=throttle) for throttle in throttles
        ]
        self.context.advance()

    def throttle(self, actor: ActorRecord) -> float:
        return self.context.world.episode.bodies.control(actor.slot).throttle


@pytest.fixture
def scene() -> Scene:
    return Scene()


CAR = "vehicle.tesla.model3"


@pytest.mark.parametrize(
    ("attributes", "name"),
    [
        ({"ros_name": "shuttle", "role_name": "hero"}, "shuttle"),
        ({"role_name": "hero"}, "hero"),
        ({"role_name": "ego", "ros_name": CAR}, "ego"),
        ({"role_name": "autopilot"}, "vehicle{id}"),
    ],
)
def test_a_sensor_is_published_below_its_vehicles_name(scene: Scene, attributes: dict[str, str], name: str) -> None:
    car = scene.spawn(CAR, **attributes)
    imu = scene.spawn("sensor.other.imu", car.id)
    gnss = scene.spawn("sensor.other.gnss", car.id, ros_name="gps")
    assert scene.topics() == ["/clock", "/tf"]
    scene.publisher.enable(imu)
    scene.publisher.enable(gnss)
    name = name.format(id=car.id)
    assert scene.topics() == ["/clock", "/tf", f"/carla/{name}/imu{imu.stream_id}", f"/carla/{name}/gps"]
    tree = next(message.content for message in scene.node.published if message.topic.name == "/tf").transforms
    assert [(row.header.frame_id, row.child_frame_id) for row in tree] == [
        ("map", name), (name, f"imu{imu.stream_id}"), (name, "gps"),
    ]  # fmt: skip
    assert (tree[1].transform.translation.x, tree[1].transform.translation.y) == (10.0, -2.0)


def test_a_destroyed_sensor_and_another_episode_take_their_topics_back(scene: Scene) -> None:
    car = scene.spawn(CAR, role_name="hero")
    imu = scene.spawn("sensor.other.imu", car.id, ros_name="imu")
    scene.publisher.enable(imu)
    scene.context.advance()
    assert "/carla/hero/imu" in scene.node.announced
    scene.context.world.destroy(imu.id)
    assert scene.topics() == ["/clock", "/tf"]
    assert scene.node.announced == {"/clock", "/tf"}
    assert "/carla/hero/vehicle_control_cmd" in scene.node.listened
    scene.context.world.load(MapLibrary().from_opendrive(SIGNS_AND_LIGHTS), reset_settings=False)
    assert scene.topics() == ["/clock"]
    assert not scene.node.listened
    assert not scene.publisher.streams


def test_two_vehicles_with_sensors_of_one_name_have_topics_and_frames_of_their_own(scene: Scene) -> None:
    one = scene.spawn("sensor.other.gnss", ros_name="a")
    two = scene.spawn("sensor.other.gnss", ros_name="b")
    for mast in (one, two):
        scene.publisher.enable(scene.spawn("sensor.other.imu", mast.id, ros_name="imu"))
    assert scene.topics() == ["/clock", "/tf", "/carla/a/imu", "/carla/b/imu"]
    frames_of = [message.content.header.frame_id for message in scene.node.published[2:]]
    assert frames_of == ["imu", "b/imu"]


@pytest.mark.parametrize(
    ("kind", "name", "reason"),
    [
        ("sensor.other.imu", "no name", "'hero/no name' cannot be part of a topic's name"),
        ("sensor.other.imu", "gps", r"/carla/hero/gps is already the topic of sensor \d+"),
        ("sensor.other.obstacle", "wall", "CARLA's publisher has no topic for its kind"),
        ("sensor.other.lane_invasion", "lane", "the client computes what it measures, not the server"),
    ],
)
def test_what_cannot_be_published_is_refused(scene: Scene, kind: str, name: str, reason: str) -> None:
    car = scene.spawn(CAR, role_name="hero")
    scene.publisher.enable(scene.spawn("sensor.other.gnss", car.id, ros_name="gps"))
    sensor = scene.spawn(kind, car.id, ros_name=name)
    with pytest.raises(Refusal, match=reason):
        scene.publisher.enable(sensor)
    assert sensor.stream_id not in scene.publisher.streams


def test_the_newest_command_drives_and_holds(scene: Scene) -> None:
    car = scene.spawn(CAR, role_name="hero")
    scene.context.advance()
    scene.command("hero", 0.25, 0.5)
    assert scene.throttle(car) == 0.5
    scene.context.advance()
    assert scene.throttle(car) == 0.5


def test_bad_commands_are_refused_with_a_sentence(scene: Scene, caplog: pytest.LogCaptureFixture) -> None:
    car = scene.spawn(CAR, role_name="hero")
    scene.context.advance()
    with caplog.at_level(logging.WARNING):
        scene.command("hero", float("inf"))
        assert scene.throttle(car) == 0.0
        scene.node.inbox["/carla/hero/vehicle_control_cmd"] = ["foreign"]
        scene.context.advance()
        scene.command("hero", *[0.5] * DEPTH)
        assert scene.throttle(car) == 0.5
    said = caplog.text
    assert "/carla/hero/vehicle_control_cmd: a command is refused, because its throttle is inf" in said
    assert f"a message is refused, because its bytes are no {DRIVE}" in said
    assert f"{DEPTH} or more commands came within a frame; only the newest counts (frame 4)" in said


def test_of_two_vehicles_of_one_name_the_first_is_driven(scene: Scene, caplog: pytest.LogCaptureFixture) -> None:
    first = scene.spawn(CAR, ros_name="bus")
    second = scene.context.world.spawn(first.description, scene.context.world.spawn_points[1])
    with caplog.at_level(logging.WARNING):
        scene.context.advance()
    assert f"vehicle {second.id} hears no commands of ROS 2: /carla/bus is vehicle {first.id} already" in caplog.text
    scene.command("bus", 0.5)
    assert (scene.throttle(first), scene.throttle(second)) == (0.5, 0.0)


def test_a_publisher_that_fails_leaves_the_server_running(scene: Scene, caplog: pytest.LogCaptureFixture) -> None:
    scene.node.publish = Fake()  # type: ignore[method-assign] # what cannot be called
    with caplog.at_level(logging.WARNING):
        assert [scene.context.advance(), scene.context.advance()] == [1, 2]
    assert caplog.text.count("internal error in the publisher; the server goes on without it.") == 1


def test_without_the_distribution_the_server_names_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "cyclonedds", None)
    for name in [each for each in sys.modules if each.startswith("linden_ros2.")]:
        monkeypatch.delitem(sys.modules, name)
    assert main(["serve", "--port", "0", "--ros2"]) == 2
    assert "--ros2 needs the package cyclonedds, which comes with: pip install linden-ros2" in capsys.readouterr().err


def test_a_domain_that_is_none_ends_the_start(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "233")
    assert main(["serve", "--port", "0", "--ros2"]) == 2
    assert "--ros2: ROS_DOMAIN_ID is '233'; it must be a number from 0 to 232" in capsys.readouterr().err
