"""Real rclpy (ROS 2 Kilted, Fast DDS) and our nodes: every topic by name, type, QoS and bytes; what does not fit."""

import itertools
import json
import os
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace as Fake

import numpy as np
import pytest

from basu_ros import autoware
from basu_ros.dds import Ros2Node
from basu_ros.moment import Actor, Control, Light, Measurement, Moment, Motion, Vehicle
from basu_ros.output.record_bag import event_topics
from basu_ros.topics import STATUS, first_messages, info_of, moment_messages, path_message, path_of, vehicle_topics
from linden_ros2.mount import Mount
from linden_ros2.sensor_messages import SEMANTIC_ROW
from linden_ros2.topic import Message, Topic, ackermann_of
from rclpy_environment import Starts, rclpy_peer, rclpy_python

__all__ = ["rclpy_peer", "rclpy_python"]

DOMAINS = itertools.count(1)
LONGEST_S = 50.0
PICTURE = Fake(raw_data=bytes(range(32)), height=2, width=4, fov=90.0)
STILL = Fake(x=0.5, y=1.0, z=-2.0)
MEASURED = {
    "sensor.lidar.ray_cast": Fake(raw_data=np.arange(40_000, dtype=np.float32).tobytes()),
    "sensor.lidar.ray_cast_semantic": Fake(raw_data=np.array([(1, 2, 3, 0.5, 7, 14)], dtype=SEMANTIC_ROW).tobytes()),
    "sensor.other.radar": Fake(raw_data=np.array([[-3.0, 0.5, 0.1, 20.0]], dtype=np.float32).tobytes()),
    "sensor.other.gnss": Fake(latitude=48.5, longitude=9.25, altitude=400.0),
    "sensor.other.imu": Fake(
        gyroscope=STILL, accelerometer=STILL, transform=Fake(rotation=Fake(roll=0.0, pitch=0.0, yaw=90.0))
    ),
    "sensor.camera.rgb": PICTURE,
    "sensor.camera.depth": PICTURE,
    "sensor.camera.semantic_segmentation": PICTURE,
}
MOUNTS = [Mount(kind.replace(".", "_"), kind) for kind in MEASURED]
VEHICLE = Vehicle("hero", MOUNTS)
MOMENT = Moment(
    1.25,
    20,
    Motion(12.5, 7.0, 0.25, 0.0, 0.1, 0.5, *np.arange(9.0).tolist()),
    Control(0.5, -0.25, 0.0),
    others=[Actor(7, "vehicle.lincoln.mkz_2020", 20.0, 5.0, 0.0, 0.5, 3.0, 0.0, 2.4, 1.0)],
    lights=[Light(3, 2)],
    measured=[Measurement(mount, MEASURED[mount.type_id]) for mount in MOUNTS],
    server_frame=4711,
)
WAY = [(0.0, 0.0, 0.0, 0.0), (10.0, 5.0, 0.0, 0.5)]


@pytest.fixture(autouse=True)
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """This machine alone, and a domain of this test's own."""
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + (os.getpid() + 7 * next(DOMAINS)) % 90))


def heard_by(peer: "subprocess.Popen[str]", node: Ros2Node, messages: list[Message]) -> dict[str, dict[str, object]]:
    """What a node of rclpy hears of messages, by topic. Those of volatile topics are repeated until it has all."""
    topics = [message.topic for message in messages]
    assert peer.stdin is not None
    peer.stdin.write(json.dumps([[each.name, each.type, each.is_latched, each.is_reliable] for each in topics]) + "\n")
    peer.stdin.flush()
    assert peer.stdout is not None
    until_s = time.monotonic() + LONGEST_S
    with ThreadPoolExecutor(1) as pool:  # what was heard is more than a pipe holds
        told = pool.submit(peer.stdout.read)
        while not told.done() and time.monotonic() < until_s:
            node.publish(*(message for message in messages if not message.topic.is_latched))
            time.sleep(0.05)  # a best-effort message may be lost, so this goes on
        if not told.done():
            peer.kill()
    return {each["topic"]: each for each in json.loads(told.result() or "[]")}


def agrees(heard: dict[str, dict[str, object]], node: Ros2Node, messages: list[Message]) -> None:
    """Check what was heard against what was published."""
    assert sorted(heard) == sorted(message.topic.name for message in messages)
    for topic, content in messages:
        found = heard[topic.name]
        values = node.types.parsed(bytes.fromhex(str(found["bytes"])), topic.type)
        assert bytes(node.types.data(values)) == bytes(node.types.data(content)), (
            topic
        )  # Fast CDR leaves gaps as they are
        assert (found["type"], found["hash"]) == (topic.type, node.types.store.hash_rihs01(topic.type)), topic
        assert (found["latched"], found["reliable"], found["nodes"]) == (topic.is_latched, topic.is_reliable, ["basu"])
        header = getattr(content, "header", None)
        if header is not None:
            stamp = [header.stamp.sec, header.stamp.nanosec]
            assert (found["stamp"], found["frame"]) == (stamp, header.frame_id), topic


def test_every_topic_of_the_bridge_arrives_in_rclpy(rclpy_peer: Starts) -> None:
    """Messages that wait for a late reader are published before it is there."""
    node = Ros2Node("basu")
    blank = [info_of("hero"), *event_topics("hero")]
    messages = [
        *first_messages(node.types, VEHICLE, 0.0),
        path_message(node.types, "hero", WAY),
        *(Message(topic, node.types.message(topic.type)) for topic in blank),
        *moment_messages(node.types, VEHICLE, MOMENT),
    ]
    announced = [*vehicle_topics(VEHICLE), *blank, path_of("hero")]
    assert {topic.name for topic in announced} == {message.topic.name for message in messages}
    node.announce(*announced)
    node.publish(*(message for message in messages if message.topic.is_latched))
    agrees(heard_by(rclpy_peer("hear"), node, messages), node, messages)
    [status] = [content for topic, content in messages if topic == STATUS]
    assert status.frame == 4711
    node.close()


def test_every_topic_of_autoware_arrives_in_rclpy(rclpy_peer: Starts) -> None:
    node = Ros2Node("basu")
    by_topic = {
        message.topic: message
        for message in [
            *first_messages(node.types, VEHICLE, 0.0),
            *autoware.mission(node.types, WAY),
            *autoware.autoware_messages(node.types, VEHICLE, MOMENT, 0.25),
        ]
    }
    messages = list(by_topic.values())
    assert {topic.name for topic in autoware.all_topics(VEHICLE)} == {topic.name for topic in by_topic}
    node.announce(*by_topic)
    node.publish(*(message for message in messages if message.topic.is_latched))
    agrees(heard_by(rclpy_peer("hear"), node, messages), node, messages)
    node.close()


def test_two_domains_do_not_mix(rclpy_peer: Starts) -> None:
    """The same topic on two domains: each listener hears its own."""
    own = int(os.environ["ROS_DOMAIN_ID"])
    nodes = {domain: Ros2Node("basu", domain) for domain in (own, own + 1)}
    messages = {
        domain: [Message(STATUS, node.types.message(STATUS.type, frame=domain))] for domain, node in nodes.items()
    }
    for node in nodes.values():
        node.announce(STATUS)
    for domain, node in nodes.items():
        agrees(heard_by(rclpy_peer("hear", domain=domain), node, messages[domain]), node, messages[domain])
    for node in nodes.values():
        node.close()


def test_rclpy_with_another_version_of_a_type_is_no_peer(rclpy_peer: Starts) -> None:
    """Fast DDS is joined by the type's name, so the type's hash decides."""
    topic = ackermann_of("hero")
    node = Ros2Node("basu")
    node.listen(topic)
    rclpy_peer("publish", topic.name, topic.type, messages="other/messages")
    until_s = time.monotonic() + LONGEST_S
    while not node.unheard(topic) and time.monotonic() < until_s:
        time.sleep(0.05)  # discovery has no event that this could wait for
    [reason] = node.unheard(topic)
    assert reason.startswith("with another version of ackermann_msgs/msg/AckermannDrive: its type hash is RIHS01_")
    assert node.writers_of(topic) == 0
    assert node.wait(topic, LONGEST_S)
    assert node.received(topic) == []
    node.close()


def test_a_publisher_that_does_not_fit_is_named(rclpy_peer: Starts) -> None:
    topic = Topic("/carla/hero/vehicle_control_cmd", "carla_msgs/msg/CarlaEgoVehicleControl")
    node = Ros2Node("basu")
    node.listen(topic)
    rclpy_peer("drive", "best-effort")
    until_s = time.monotonic() + LONGEST_S
    while not node.unheard(topic) and time.monotonic() < until_s:
        time.sleep(0.05)  # as above
    assert node.unheard(topic) == ["with the QoS reliability BEST_EFFORT; it must be RELIABLE"]
    node.close()
