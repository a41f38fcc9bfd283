"""The two readers of recorder files hold each other to account, packet by packet: on a file with every kind of
packet, and on the recordings of the real CARLA that LINDEN_RECORDINGS names the folder of."""

import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basu_carla_log import Log, read_log
from basu_carla_log.layouts import Kind, Physics
from fakes import recordings as made
from linden.replay.file.packets import Frame
from linden.replay.file.read import Recording

FOLDER = os.environ.get("LINDEN_RECORDINGS", "")
PUBLIC = ("DistanceBetweenVehicles.log", "DistanceToLaneCenter.log")
TABLES = {
    Kind.DESTROYED: "removed",
    Kind.PARENTS: "parents",
    Kind.COLLISIONS: "collisions",
    Kind.POSITIONS: "positions",
    Kind.LIGHT_STATES: "light_states",
    Kind.CONTROLS: "vehicles",
    Kind.WALKER_SPEEDS: "walkers",
    Kind.VEHICLE_LIGHTS: "vehicle_lights",
    Kind.SCENE_LIGHTS: "scene_lights",
    Kind.VELOCITIES: "kinematics",
    Kind.BOXES: "boxes",
    Kind.LIGHT_TIMES: "light_times",
}


def everything(folder: Path) -> Path:
    """Two frames with every kind of packet that is read, and some that are not."""
    physics = struct.pack("<I5f?4f3f", 9, 6500, 1, 0.125, 2, 0.375, True, 10, 3.25, 1696, 0.25, 0.5, 0, -0.25)
    for width, rows in ((2, [(0, 500), (5000, 400)]), (3, [(4.5, 0.25, 0.5)]), (2, [(0, 1)]), (12, [range(1, 13)])):
        physics += struct.pack("<I", len(rows)) + b"".join(struct.pack(f"<{width}f", *row) for row in rows)
    hero = made.actor(9, "vehicle.tesla.model3", 1, attributes=[(3, "role_name", "hero")])
    first = made.frame(
        1,
        0.0,
        made.added(hero, made.actor(3, "walker.pedestrian.0001", 2), made.actor(5, "traffic.traffic_light", 3)),
        made.several(4, "II", [(6, 9)]),
        made.several(5, "IIIBB", [(1, 9, 3, 1, 0), (2, 9, 0xFFFFFFFF, 1, 0)]),
        made.positions((9, 100, 200, 300, 1, 2, 3), (3, 1.5, 2.5, -3.5, 0, 0, 90)),
        made.several(7, "IBfb", [(5, 1, 2.5, 2)]),
        made.several(8, "IfffBi", [(9, 0.25, 0.5, 0.75, 1, -1)]),
        made.several(9, "If", [(3, 1.25)]),
        made.several(10, "II", [(9, 0b1010)]),
        made.several(11, "if4fBB", [(12, 100.0, 1, 0.5, 0.25, 1, 1, 2)]),
        made.several(12, "I6f", [(9, 1, 2, 3, 4, 5, 6)]),
        made.several(13, "I6f", [(9, 0, 0, 75, 240, 95, 75), (6, *(float("nan"),) * 3, *(float("-inf"),) * 3)]),
        made.packet(14, struct.pack("<d", 0.125)),
        made.packet(15, struct.pack("<H", 1) + physics),
        made.several(16, "I3f", [(5, 10, 3, 2)]),
        made.several(17, "I6f", [(5, 0, 0, 0, 100, 200, 300)]),
        made.packet(18, struct.pack("<Q", 77)),
        made.several(240, "3b", [(1, -1, 0), (0, 0, 2)]),
    )
    second = made.frame(2, 0.05, made.removed(3), made.positions((9, 110, 200, 300, 1, 2, 3)), duration_s=-1.0)
    return made.write(folder, made.header(), first, second)


def assert_same(path: Path) -> Log:
    """Every record of every frame is the same to both."""
    log = read_log(path)
    with Recording(path) as recording:
        frames = list(recording.frames())
        assert (log.version, log.begun_unix_s, log.map_name) == recording.header
    assert log.problem is None
    assert log.frames == len(frames)
    for number, frame in enumerate(frames, start=1):
        assert (frame.elapsed_s, frame.duration_s) == (log.elapsed_s[number - 1], log.duration_s[number - 1])
        assert_same_frame(log, number, frame)
    for kind, name in TABLES.items():
        assert len(log.table(kind)) == sum(len(getattr(frame, name)) for frame in frames), kind
    return log


def assert_same_frame(log: Log, number: int, frame: Frame) -> None:
    for kind, name in TABLES.items():
        assert log.table(kind).in_frame(number).tobytes() == getattr(frame, name).tobytes(), (number, kind)
    platform_s = log.platform_s[number - 1]
    assert np.isnan(platform_s) if frame.platform_time_s is None else platform_s == frame.platform_time_s
    ours = [actor for actor in log.created if actor.frame == number]
    assert [
        (one.id, one.kind, one.location_cm, one.rotation_deg, one.type_id, one.attributes) for one in ours
    ] == [
        (one.id, one.kind, one.location_cm, one.rotation_deg, one.description.id,
         tuple((attribute.id, attribute.value) for attribute in one.description.attributes))
        for one in frame.added
    ]  # fmt: skip
    made_of = [one for one in log.physics if one.frame == number]
    for one, (actor_id, control) in zip(made_of, frame.physics, strict=True):
        assert one.id == actor_id
        assert flat(one[2:]) == flat(without_what_the_file_lacks(control))


def without_what_the_file_lacks(control: Any) -> list[object]:
    """A control's fields in the order of the file."""
    skipped = {"gear_switch_time", "use_sweep_wheel_collision"}
    assert set(Physics._fields[2:]) | skipped == set(control._fields)
    return [getattr(control, name) for name in Physics._fields[2:]]


def flat(value: Any) -> list[float]:
    """All numbers in a nest of tuples."""
    return [number for part in value for number in flat(part)] if isinstance(value, (list, tuple)) else [value]


def test_both_read_the_same_out_of_every_kind_of_packet(tmp_path: Path) -> None:
    log = assert_same(everything(tmp_path))
    assert {kind for kind in Kind if kind in log.tables and len(log.table(kind))} == set(log.tables)
    assert log.unread == {18: 1}


@pytest.mark.skipif(not FOLDER, reason="LINDEN_RECORDINGS names no folder with recordings of the real CARLA")
@pytest.mark.parametrize("name", PUBLIC)
def test_both_read_the_same_out_of_recordings_of_the_real_carla(name: str) -> None:
    log = assert_same(Path(FOLDER) / name)
    assert log.unread == {}
    assert len(log.table(Kind.POSITIONS)) in {99_939, 51_836}
