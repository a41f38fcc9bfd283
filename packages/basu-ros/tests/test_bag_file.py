"""Bags: written by us, read by the readers of others (mcap and rosbags)."""

from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from basu.errors import UserError
from basu_ros.bag_file import BagFile
from basu_ros.moment import Control, Moment, Motion, Vehicle
from basu_ros.topics import TF_STATIC, first_messages, moment_messages, vehicle_topics
from linden_ros2.types import Generation

VEHICLE = Vehicle("hero")
FRAMES = 5


def write(path: Path, generation: Generation) -> int:
    bag = BagFile(path, generation)
    bag.announce(vehicle_topics(VEHICLE))
    bag.write(0.0, first_messages(bag.types, VEHICLE, 0.0))
    for tick in range(FRAMES):
        motion = Motion(float(tick), 2.0, *([0.0] * 13))
        moment = Moment(tick * 0.05, tick, motion, Control(throttle=0.5))
        bag.write(moment.t_s, moment_messages(bag.types, VEHICLE, moment))
    bag.close()
    return bag.messages


def test_mcap_s_own_reader_decodes_every_message(tmp_path: Path) -> None:
    count = write(tmp_path / "drive", Generation.ROS_2)
    with (tmp_path / "drive" / "drive.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [(channel.topic, message.log_time, decoded) for _, channel, message, decoded in
                 reader.iter_decoded_messages()]  # fmt: skip
        summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert (len(found), summary.statistics.message_count) == (count, count)
    places = [each.pose.pose.position.x for topic, _, each in found if topic == "/carla/hero/odometry"]
    assert places == [0.0, 1.0, 2.0, 3.0, 4.0]
    clocks = [(at, each.clock.sec * 10**9 + each.clock.nanosec) for topic, at, each in found if topic == "/clock"]
    assert clocks == [(ns, ns) for ns in range(0, 250_000_000, 50_000_000)]


@pytest.mark.parametrize(("generation", "name"), [(Generation.ROS_2, "drive"), (Generation.ROS_1, "drive.bag")])
def test_rosbags_reads_topics_types_and_times(generation: Generation, name: str, tmp_path: Path) -> None:
    count = write(tmp_path / name, generation)
    with AnyReader([tmp_path / name]) as reader:
        assert reader.message_count == count
        assert {each.topic for each in reader.connections} == {each.name for each in vehicle_topics(VEHICLE)}
        statuses = [each for each in reader.connections if each.topic == "/carla/hero/vehicle_status"]
        seen = [
            (at, reader.deserialize(data, each.msgtype).control.throttle)
            for each, at, data in reader.messages(connections=statuses)
        ]
    assert seen == [(tick * 50_000_000, 0.5) for tick in range(FRAMES)]


def test_a_late_subscriber_gets_the_still_transforms(tmp_path: Path) -> None:
    write(tmp_path / "drive", Generation.ROS_2)
    with AnyReader([tmp_path / "drive"]) as reader:
        [still] = [each for each in reader.connections if each.topic == TF_STATIC.name]
        [offered] = still.ext.offered_qos_profiles  # type: ignore[union-attr]
    assert offered.durability.name == "TRANSIENT_LOCAL"


@pytest.mark.parametrize("generation", Generation)
def test_the_same_messages_are_the_same_bytes(generation: Generation, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        write(tmp_path / folder / "drive", generation)
    files = [sorted(path for path in (tmp_path / folder).rglob("*") if path.is_file()) for folder in ("a", "b")]
    assert [path.name for path in files[0]] == [path.name for path in files[1]]
    assert [path.read_bytes() for path in files[0]] == [path.read_bytes() for path in files[1]]


@pytest.mark.parametrize("generation", Generation)
def test_nothing_is_overwritten_and_what_is_abandoned_is_gone(generation: Generation, tmp_path: Path) -> None:
    path = tmp_path / "drive"
    bag = BagFile(path, generation)
    with pytest.raises(UserError, match=r"drive cannot be written: .*exists"):
        BagFile(path, generation)
    bag.abandon()
    assert not path.exists()


def test_a_place_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="make room or name another place"):
        BagFile(tmp_path / "file" / "drive", Generation.ROS_2)
