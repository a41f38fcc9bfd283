"""ROS 2 over real DDS on the loopback interface, with a peer in a process of its own."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from basu_ros.dds import Ros2Node
from basu_ros.topics import TF_STATIC, first_messages, moment_messages, odometry_of, vehicle_topics
from fakes.ros_vehicle import CLOUD, VEHICLE, moment
from linden_ros2.dds_domain import DdsError, domain_of_environment, is_local
from linden_ros2.dds_types import dds_name, dds_type
from linden_ros2.topic import Topic, control_of
from linden_ros2.types import Generation, Types, types_of

PEER = Path(__file__).parents[3] / "tests" / "fakes" / "plain_dds_peer.py"


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Iterator[Ros2Node]:
    """A node on a domain of this process's own, on this machine alone."""
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 200))
    made = Ros2Node("basu")
    yield made
    made.close()


def test_a_plain_peer_hears_us_and_its_command_reaches_us(node: Ros2Node) -> None:
    node.listen(control_of("hero"))
    node.announce(*vehicle_topics(VEHICLE))
    node.publish(*first_messages(node.types, VEHICLE, 0.0))  # before the peer is there: it gets them all the same
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, str(PEER), str(node.domain)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, env=environment, **pipes) as peer:
        assert peer.stdin is not None
        assert peer.stdout is not None
        assert node.wait_for_readers(odometry_of("hero"), 30.0)
        assert node.wait_for_readers(CLOUD, 30.0)
        node.publish(*moment_messages(node.types, VEHICLE, moment(60_000)))
        heard = json.loads(peer.stdout.readline())
        peer.stdin.write("command\n")
        peer.stdin.flush()
        assert node.wait(control_of("hero"), 30.0)
        [told] = node.received(control_of("hero"))
        assert node.writers_of(control_of("hero")) == 1
        peer.stdin.close()
        assert peer.wait(30.0) == 0
    assert heard["frames"] == ["odom", "hero", "hero/LIDAR"]
    assert (heard["x"], heard["y"], heard["frame"]) == (12.5, -7.0, "map")
    assert (heard["points"], heard["fields"]) == (60_000, ["x", "y", "z", "intensity"])
    assert bytes(heard["bytes"]) == np.array([0.0, -1.0], dtype=np.float32).tobytes()
    assert heard["nodes"] == ["basu"]
    assert heard["writers"] >= len(vehicle_topics(VEHICLE))
    assert (told.throttle, told.steer, told.gear, told.reverse, told.header.stamp.sec) == (0.5, -0.25, 2, True, 3)


def test_two_nodes_of_a_process_talk_and_a_latched_message_waits(node: Ros2Node) -> None:
    node.publish(*first_messages(node.types, VEHICLE, 0.0))
    other = Ros2Node("listener")
    other.listen(TF_STATIC)
    assert other.wait(TF_STATIC, 30.0)
    [tree] = other.received(TF_STATIC)
    assert len(tree.transforms) == 3
    assert not other.wait(TF_STATIC, 0.01)
    other.close()


def test_a_peer_with_another_version_of_a_type_is_no_peer(node: Ros2Node) -> None:
    """An older definition of the same name: DDS compares the members and does not join the two."""
    topic = Topic("/drive", "ackermann_msgs/msg/AckermannDrive")
    node.listen(topic)
    other = Ros2Node("talker")
    older = Types(Generation.ROS_2)
    older.store.fielddefs["ackermann_msgs/msg/AckermannDrive"][1].pop()
    other.types = older
    other.announce(topic)
    joined = Ros2Node("good")
    joined.announce(topic)
    assert joined.wait_for_readers(topic, 30.0)
    assert (other.readers_of(topic), node.writers_of(topic)) == (0, 1)
    for each in (other, joined):
        each.close()


def test_names_are_mangled_as_ros_2_does_it() -> None:
    types = types_of(Generation.ROS_2)
    assert dds_name("sensor_msgs/msg/PointCloud2") == "sensor_msgs.msg.dds_.PointCloud2_"
    made = dds_type(types, "sensor_msgs/msg/PointCloud2")
    assert made.__idl__.idl_transformed_typename == "sensor_msgs::msg::dds_::PointCloud2_"


@pytest.mark.parametrize("text", ["-1", "233", "one", "1.5"])
def test_a_domain_that_is_none_is_a_sentence(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(DdsError, match=f"ROS_DOMAIN_ID is '{text}'; it must be a number from 0 to 232"):
        domain_of_environment()


@pytest.mark.parametrize(
    ("settings", "stays"),
    [
        ({}, True),
        ({"ROS_LOCALHOST_ONLY": "1", "CYCLONEDDS_URI": "file:///a.xml"}, True),
        ({"ROS_LOCALHOST_ONLY": "0"}, False),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, True),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, False),
        ({"CYCLONEDDS_URI": "file:///a.xml"}, False),
    ],
)
def test_ros_stays_on_this_machine_unless_a_variable_says_otherwise(
    settings: dict[str, str], *, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DOMAIN_ID", "CYCLONEDDS_URI"):
        monkeypatch.delenv(name, raising=False)
    for name, value in settings.items():
        monkeypatch.setenv(name, value)
    assert (domain_of_environment(), is_local()) == (0, stays)
