"""Whole runs with ``--rosbag``, in a live simulator; their bags are read by mcap's own reader."""

import json
import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from basu.cli import main
from basu.errors import UserError
from basu.records.history.files import read_history
from basu_ros.bag_file import BagFile
from basu_ros.dds import Ros2Node
from basu_ros.output.record_bag import write_record
from basu_ros.topics import TF_STATIC, odometry_of, path_of
from linden_ros2.topic import Message, Topic
from linden_ros2.types import Generation
from servers import RunningServer

AGENT = """
from basu.agents.builtin.basic import BasicAgent


class Sensing(BasicAgent):
    def config(self):
        return {}

    def sensors(self):
        return [
            {"type": "sensor.lidar.ray_cast", "id": "LIDAR", "z": 2.4, "points_per_second": 20000,
             "rotation_frequency": 20},
            {"type": "sensor.other.imu", "id": "IMU"},
            {"type": "sensor.other.gnss", "id": "GNSS", "sensor_tick": 0.1},
        ]
"""


def messages_in(bag: Path) -> list[tuple[str, int, object]]:
    with bag.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return [(channel.topic, message.log_time, decoded) for _, channel, message, decoded in
                reader.iter_decoded_messages()]  # fmt: skip


def test_a_run_with_sensors_is_a_bag_and_the_state_in_it_is_the_record_s(
    simulator: RunningServer, route_file: Path, tmp_path: Path
) -> None:
    agent = tmp_path / "sensing.py"
    agent.write_text(AGENT)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(tmp_path / "runs")]
    assert main(["run", str(agent), *address, "--routes", str(route_file), "--stop-after", "1.5", "--rosbag"]) == 0
    folder = tmp_path / "runs" / "latest"
    history = read_history(folder)
    found = messages_in(folder / "rosbag" / "rosbag.mcap")
    counts = Counter(topic for topic, *_ in found)
    ticks = len(history.frames)
    assert {counts[name] for name in ("/clock", "/tf", "/carla/hero/LIDAR", "/carla/hero/IMU")} == {ticks}
    assert ticks // 2 <= counts["/carla/hero/GNSS"] <= ticks // 2 + 1
    clouds = [each for topic, _, each in found if topic == "/carla/hero/LIDAR"]
    assert all(each.width > 100 and each.header.frame_id == "hero/LIDAR" for each in clouds)  # type: ignore[attr-defined]
    still = next(each for topic, _, each in found if topic == "/tf_static")
    children = {each.child_frame_id for each in still.transforms}  # type: ignore[attr-defined]
    assert children == {"odom", "hero", "hero/LIDAR", "hero/IMU", "hero/GNSS"}

    [info] = [each for topic, _, each in found if topic == "/carla/hero/vehicle_info"]
    assert info.type == "vehicle.easymile.ez10"  # type: ignore[attr-defined]
    places = [(wheel.position.x, wheel.position.y) for wheel in info.wheels]  # type: ignore[attr-defined]
    assert [(x > 0, y > 0) for x, y in places] == [(True, True), (True, False), (False, True), (False, False)]
    assert all(0.3 < abs(y) < 1.2 and 0.8 < abs(x) < 2.0 for x, y in places)

    write_record(history, tmp_path / "again", Generation.ROS_2)
    states = ("/carla/hero/odometry", "/carla/hero/vehicle_status", "/carla/hero/vehicle_control_cmd", "/tf", "/clock")
    live, later = (
        [(topic, at, str(each)) for topic, at, each in messages if topic in states]
        for messages in (found, messages_in(tmp_path / "again" / "again.mcap"))
    )
    assert live == later


def test_an_id_that_ros_cannot_name_is_the_set_up_s_fault(
    simulator: RunningServer, route_file: Path, tmp_path: Path
) -> None:
    agent = tmp_path / "sensing.py"
    agent.write_text(AGENT.replace('"IMU"', '"IMU left"'))
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(tmp_path / "runs")]
    assert main(["run", str(agent), *address, "--routes", str(route_file), "--rosbag"]) == 2
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert (result["fault"], "'IMU left' cannot be part of a ROS topic's name" in result["message"]) == ("setup", True)


def test_a_full_disk_ends_the_run_and_the_record_is_kept(
    simulator: RunningServer,
    route_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    write = BagFile.write

    def full(bag: BagFile, t_s: float, messages: Iterable[Message]) -> None:
        if t_s > 0.4:
            raise UserError(
                "the bag rosbag cannot be written: No space left on device; make room or name another place"
            )
        write(bag, t_s, messages)

    monkeypatch.setattr(BagFile, "write", full)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(tmp_path / "runs")]
    assert main(["run", "basic", *address, "--routes", str(route_file), "--rosbag"]) == 2
    folder = tmp_path / "runs" / "latest"
    result = json.loads((folder / "result.json").read_text())
    assert (result["fault"], "No space left on device" in result["message"]) == ("setup", True)
    assert len(read_history(folder).frames) == 10
    topics = [topic for topic, *_ in messages_in(folder / "rosbag" / "rosbag.mcap")]
    assert topics.count("/carla/hero/odometry") == 9  # what was written before is a whole bag


def test_a_run_is_heard_on_ros_2_while_it_lasts(
    simulator: RunningServer, route_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 200))
    listener = Ros2Node("listener")
    route, clouds = path_of("hero"), Topic("/carla/hero/LIDAR", "sensor_msgs/msg/PointCloud2")
    listener.listen(odometry_of("hero"), TF_STATIC, route, clouds)
    agent = tmp_path / "sensing.py"
    agent.write_text(AGENT)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(tmp_path / "runs")]
    assert main(["run", str(agent), *address, "--routes", str(route_file), "--stop-after", "2", "--ros2"]) == 0
    frames = read_history(tmp_path / "runs" / "latest").frames
    heard = listener.received(odometry_of("hero"))
    assert [each.pose.pose.position.x for each in heard] == frames["x_m"][-len(heard) :].tolist()
    assert len(heard) == odometry_of("hero").depth
    [tree], [way] = listener.received(TF_STATIC), listener.received(route)
    assert "hero/LIDAR" in {each.child_frame_id for each in tree.transforms}
    assert len(way.poses) > 25  # one a metre
    assert all(each.width > 100 for each in listener.received(clouds))
    listener.close()
