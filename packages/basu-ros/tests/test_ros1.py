"""ROS 1 over a real roscore, with peers in processes of their own, and the sentences where ROS 1 is absent."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from basu.errors import UserError
from basu_ros import rospy_start
from basu_ros.autoware_ai import COMMAND, old_types
from basu_ros.ros1 import Ros1Node
from basu_ros.rospy_start import INSTALL, master_uri
from basu_ros.topics import TF_STATIC, first_messages, moment_messages, odometry_of, vehicle_topics
from fakes.ros_vehicle import CLOUD, VEHICLE, moment
from linden_ros2.topic import Message, Topic, ackermann_of, control_of
from linden_ros2.types import Generation, Types, types_of
from roscore import SYSTEM_PYTHON, Starts, master, roscore, starts

__all__ = ["master", "roscore", "starts"]
PEER = Path(__file__).parents[3] / "tests" / "fakes" / "plain_rospy_peer.py"
LONG_S = 30.0


@pytest.fixture
def node(master: str) -> Iterator[Ros1Node]:
    del master
    made = Ros1Node("basu")
    yield made
    made.close()


def test_a_plain_rospy_node_hears_us_and_its_command_reaches_us(node: Ros1Node, starts: Starts) -> None:
    node.listen(control_of("hero"))
    node.announce(*vehicle_topics(VEHICLE))
    node.publish(*first_messages(node.types, VEHICLE, 0.0))  # before the peer is there: it gets them all the same
    peer = starts(PEER, python=SYSTEM_PYTHON)
    assert peer.stdin is not None
    assert peer.stdout is not None
    definition, _ = types_of(Generation.ROS_1).store.generate_msgdef(control_of("hero").type)
    peer.stdin.write(json.dumps(definition) + "\n")
    peer.stdin.flush()
    assert peer.stdout.readline() == "ready\n"
    for topic in (odometry_of("hero"), CLOUD, Topic("/clock", "rosgraph_msgs/msg/Clock")):
        assert node.wait_for_peers(topic, LONG_S)
    node.publish(*moment_messages(node.types, VEHICLE, moment(60_000)))
    heard = json.loads(peer.stdout.readline())
    assert node.wait_for_peers(control_of("hero"), LONG_S)
    peer.stdin.write("command\n")
    peer.stdin.flush()
    assert node.wait(control_of("hero"), LONG_S)
    [told] = node.received(control_of("hero"))
    until_s = time.monotonic() + LONG_S  # a connection has an address first, and its node's name after the handshake
    while (names := [peer.name for peer in node.peers_of(control_of("hero"))]) != ["/peer"]:
        assert time.monotonic() < until_s, names
        time.sleep(0.01)
    peer.stdin.write("end\n")
    peer.stdin.close()
    assert peer.wait(LONG_S) == 0
    assert heard["clock"] == 1.0
    assert heard["frames"] == ["odom", "hero", "hero/LIDAR"]
    assert (heard["place"], heard["frame"]) == ([12.5, -7.0], "map")
    assert (heard["points"], heard["fields"]) == (60_000, ["x", "y", "z", "intensity"])
    assert bytes(heard["bytes"]) == np.array([0.0, -1.0], dtype=np.float32).tobytes()
    assert (told.throttle, told.steer, told.gear, told.reverse, told.header.stamp.sec) == (0.5, -0.25, 2, True, 3)


def test_two_nodes_talk_and_a_latched_message_waits(node: Ros1Node) -> None:
    node.publish(*first_messages(node.types, VEHICLE, 0.0))
    other = Ros1Node("listener")
    other.listen(TF_STATIC)
    assert other.wait(TF_STATIC, LONG_S)
    [tree] = other.received(TF_STATIC)
    assert len(tree.transforms) == 3
    assert not other.wait(TF_STATIC, 0.01)
    until_s = time.monotonic() + LONG_S
    while (peers := (other.writers_of(TF_STATIC), node.readers_of(TF_STATIC))) != (1, 1):
        assert time.monotonic() < until_s, peers  # rospy hands a message over before it lists its sender
        time.sleep(0.01)
    assert node.publishers_of(TF_STATIC.name) == []
    assert other.publishers_of(TF_STATIC.name) == ["/basu"]
    other.close()
    with node._changed:
        assert node._changed.wait_for(lambda: not node._peers.get(node._numbers[TF_STATIC.name]), LONG_S)


def test_commands_of_both_generations_of_autoware_are_read(node: Ros1Node) -> None:
    node.listen(COMMAND, any_version=True)
    gears = []
    for name, types in (("new", node.types), ("old", old_types())):
        stack = Ros1Node(name)
        gear = {"gear": 2} if name == "old" else {"gear_cmd": types.message("autoware_msgs/msg/Gear", gear=2)}
        stack.publish_as(types, Message(COMMAND._replace(is_latched=True), types.message(COMMAND.type, **gear)))
        assert node.wait(COMMAND, LONG_S)
        [order] = node.received(COMMAND)
        gears.append(order.gear if name == "old" else order.gear_cmd.gear)
        stack.close()
    assert gears == [2, 2]


def test_a_peer_with_another_version_of_a_type_is_no_peer(node: Ros1Node) -> None:
    topic = ackermann_of("hero")
    node.listen(topic)
    other = Ros1Node("talker")
    older = Types(Generation.ROS_1, {topic.type: "float32 speed\n"})
    other.publish_as(older, Message(topic._replace(is_latched=True), older.message(topic.type, speed=1.0)))
    with node._changed:
        assert node._changed.wait_for(lambda: bool(node.warnings), LONG_S)
    assert "wants topic [/carla/hero/ackermann_cmd] to have datatype/md5sum" in node.warnings[-1]
    assert node.received(topic) == []
    other.close()


def test_a_second_node_of_a_name_is_refused(node: Ros1Node) -> None:
    del node
    with pytest.raises(UserError, match="has a node /basu already, such as another run's; end that one first"):
        Ros1Node("basu")


def test_a_node_with_a_dead_process_is_a_sentence(node: Ros1Node) -> None:
    node.listen(TF_STATIC)
    os.kill(node._process.pid, signal.SIGKILL)
    with pytest.raises(UserError, match="the ROS 1 node /basu ended: its process died"):
        node.wait(TF_STATIC, LONG_S)


def test_without_a_roscore_there_is_a_sentence(master: str, monkeypatch: pytest.MonkeyPatch) -> None:
    del master
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        nowhere = f"http://localhost:{free.getsockname()[1]}"
    monkeypatch.setenv("ROS_MASTER_URI", nowhere)
    with pytest.raises(UserError, match=rf"no roscore answers at {nowhere} .*; start one with `roscore`"):
        Ros1Node("basu")


def test_without_rospy_there_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rospy_start, "PYTHONS", (sys.executable,))
    rospy_start._python.cache_clear()
    try:
        has = subprocess.run([sys.executable, "-c", "import rospy"], check=False, capture_output=True).returncode == 0
        assert not has, "this Python is not the system's"
        with pytest.raises(UserError) as told:
            Ros1Node("basu")
    finally:
        rospy_start._python.cache_clear()
    assert str(told.value) == INSTALL


@pytest.mark.parametrize("text", ["11311", "localhost:11311", "ftp://localhost:1", "http://localhost:port"])
def test_an_address_that_is_none_is_a_sentence(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", text)
    with pytest.raises(UserError, match=f"ROS_MASTER_URI is '{text}'; it must be an address such as http://localhost"):
        master_uri()


def test_the_default_address_is_rospy_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_MASTER_URI", raising=False)
    assert master_uri() == "http://localhost:11311"
