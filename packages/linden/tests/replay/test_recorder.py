from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from fakes.street_drive import HERO, STEP_S, Drive, spawned
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.snapshot import VEHICLE_ROW
from linden.protocol.values.space import Vector3D
from linden.replay.file.layouts import SCENERY, PacketId, from_file
from linden.replay.file.packets import Frame
from linden.replay.file.read import Recording
from linden.replay.frame_records import collisions
from linden.world import World


@pytest.fixture
def drive() -> Drive:
    return Drive()


def read(path: Path) -> list[Frame]:
    with Recording(path) as recording:
        return list(recording.frames())


def ids(frame_rows: Iterable) -> list[int]:
    return [int(row["id"]) for row in frame_rows]


def test_a_frame_holds_the_rows_of_its_snapshot(drive: Drive, tmp_path: Path) -> None:
    drive.step(5)
    drive.record(tmp_path / "drive.log")
    shown = []
    rows = drive.simulation.episode.actors.rows
    for _ in range(5):
        drive.step(1)
        actors = drive.simulation.episode.actors
        placed = [actors.row(record.id) for record in (drive.hero, drive.other, drive.walker)]
        shown.append((rows[placed].copy(), rows.view(VEHICLE_ROW)[placed[:2]].copy()))
    drive.simulation.recorder.stop()
    frames = read(tmp_path / "drive.log")
    assert [frame.elapsed_s for frame in frames] == pytest.approx([n * STEP_S for n in range(5)])
    for frame, (moving, driven) in zip(frames, shown, strict=True):
        of = [ids(frame.positions).index(record.id) for record in (drive.hero, drive.other, drive.walker)]
        exact_m = from_file(frame.positions["location_cm"][of], frame.packets[PacketId.LOCATION_ULPS]["ulps"][of])
        np.testing.assert_array_equal(exact_m, moving["location"])
        np.testing.assert_array_equal(frame.positions["rotation_deg"][of], moving["rotation"][:, [2, 0, 1]])
        np.testing.assert_array_equal(frame.kinematics["velocity_mps"], moving["velocity"])
        np.testing.assert_array_equal(frame.kinematics["angular_velocity_degps"], moving["angular_velocity"])
        for field in ("steer", "throttle", "brake", "hand_brake", "gear"):
            np.testing.assert_array_equal(frame.vehicles[field], driven[field])
        assert frame.walkers["speed_mps"].tolist() == [1.5]


def test_the_first_frame_lists_all_actors_with_their_types(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(2)
    first, second = read(tmp_path / "drive.log")
    told = {actor.id: actor for actor in first.added}
    assert list(told) == [record.id for record in drive.simulation.episode.actors]
    assert {actor.description.id: actor.kind for actor in first.added} == {
        "spectator": 0, "traffic.traffic_light": 3, "traffic.speed_limit.-1": 4, HERO: 1, "vehicle.audi.tt": 1,
        "walker.pedestrian.0001": 2, "sensor.other.imu": 5,
    }  # fmt: skip
    assert told[drive.hero.id].description == drive.hero.description
    assert told[drive.imu.id].location_cm == (100.0, 0.0, 200.0)  # relative to its carrier
    assert first.parents.tolist() == [(drive.imu.id, drive.hero.id)]
    assert [record.id for record in first.physics] == [drive.hero.id, drive.other.id]
    assert drive.hero.id in ids(first.boxes)
    light = drive.simulation.episode.light_ids[0]
    assert light in ids(first.packets[PacketId.TRIGGER_VOLUMES])
    assert light not in ids(first.boxes)
    assert ids(first.light_times) == [light]
    assert (first.platform_time_s, second.platform_time_s) == (0.25, 0.5)
    for packet in (PacketId.BOXES, PacketId.TRIGGER_VOLUMES, PacketId.PHYSICS, PacketId.LIGHT_TIMES):
        assert packet not in second.packets
    assert not second.added


def test_without_additional_data_none_of_it_is_written(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log", additional_data=False)
    drive.step(1)
    (frame,) = read(tmp_path / "drive.log")
    additional = {PacketId.KINEMATICS, PacketId.BOXES, PacketId.TRIGGER_VOLUMES, PacketId.PLATFORM_TIME,
                  PacketId.PHYSICS, PacketId.LIGHT_TIMES}  # fmt: skip
    assert not additional & set(frame.packets)
    assert len(frame.positions) == 4


def test_arrivals_and_departures_are_in_the_frame_after(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(1)
    third = spawned(drive.simulation, HERO, drive.along(30.0, 0.0))
    drive.step(1)
    drive.simulation.destroy(drive.hero.id)  # and the sensor on it
    drive.step(2)
    _, came, went, after = read(tmp_path / "drive.log")
    assert [actor.id for actor in came.added] == [third.id]
    assert came.added[0].location_cm == pytest.approx(np.array(drive.along(30.0, 0.0).location) * 100.0, rel=1e-6)
    assert ids(went.removed) == [drive.hero.id]  # its IMU stays, attached to nothing
    assert not after.added
    assert not len(after.removed)
    assert drive.hero.id not in ids(after.positions)


def test_what_changes_seldom_is_written_when_it_changes(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(1)
    drive.simulation.episode.traffic.set_time(0, TrafficLightState.GREEN, 4.0)
    drive.simulation.recorder.physics_changed(drive.other.id)
    drive.other.light_state = 3
    drive.step(2)
    _, changed, after = read(tmp_path / "drive.log")
    assert changed.light_times["green_s"].tolist() == [4.0]
    assert [record.id for record in changed.physics] == [drive.other.id]
    assert changed.vehicle_lights.tolist() == [(drive.hero.id, 0), (drive.other.id, 3)]
    assert not after.physics
    assert not len(after.light_times)


def test_the_light_is_recorded_as_it_stands(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(1)
    drive.simulation.episode.traffic.set_colour(0, TrafficLightState.YELLOW)
    drive.simulation.episode.traffic.freeze_all(frozen=True)
    drive.step(1)
    first, second = read(tmp_path / "drive.log")
    light = drive.simulation.episode.light_ids[0]
    assert [tuple(f.light_states[["id", "frozen", "state"]][0]) for f in (first, second)] == [
        (light, 0, TrafficLightState.GREEN), (light, 1, TrafficLightState.YELLOW),
    ]  # fmt: skip
    assert first.light_states["elapsed_s"][0] == np.float32(STEP_S)


def test_a_collision_names_the_hero_first_and_each_frame_once(drive: Drive, tmp_path: Path) -> None:
    episode = drive.simulation.episode
    way_m = np.subtract(drive.along(12.0, 0.0).location, drive.along(0.0, 0.0).location)
    episode.bodies.set_target_velocity(drive.hero.slot, Vector3D(*(0.75 * way_m).tolist()))  # 9 m/s
    drive.record(tmp_path / "drive.log")
    drive.step(40)
    found = [row for frame in read(tmp_path / "drive.log") for row in frame.collisions.tolist()]
    assert [row[0] for row in found] == list(range(len(found)))
    with_car = [row for row in found if row[2] == drive.other.id]
    assert with_car
    assert all(row[1:] == (drive.hero.id, drive.other.id, 1, 0) for row in with_car)


def test_a_collision_with_the_scenery_names_no_second_actor(drive: Drive) -> None:
    episode = drive.simulation.episode
    contacts = np.zeros(2, episode.contacts.dtype)
    contacts["a"], contacts["b"] = drive.walker.slot, (-1, -1)
    episode.contacts = contacts
    assert collisions(episode, 5).tolist() == [(5, drive.walker.id, SCENERY, 0, 0)]


def test_a_load_of_a_map_ends_the_recording(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(3)
    drive.simulation.load(drive.simulation.episode.map, reset_settings=False)
    assert drive.simulation.recorder.path is None
    drive.simulation.step(STEP_S)
    assert len(read(tmp_path / "drive.log")) == 3


def test_a_second_recording_ends_the_first(drive: Drive, tmp_path: Path) -> None:
    drive.record(tmp_path / "one.log")
    drive.step(2)
    drive.record(tmp_path / "two.log")
    drive.step(3)
    assert (len(read(tmp_path / "one.log")), len(read(tmp_path / "two.log"))) == (2, 3)
    assert drive.simulation.recorder.path == tmp_path / "two.log"


def test_a_disk_that_is_full_ends_the_recording_and_nothing_else(
    drive: Drive, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    drive.record(tmp_path / "drive.log")
    drive.step(2)

    def full(_content: bytes) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(drive.simulation.recorder._tape.writer, "_append", full)
    frame = drive.simulation.frame
    drive.step(3)
    assert drive.simulation.frame == frame + 3
    assert drive.simulation.recorder.path is None
    assert "No space left on device; the simulation goes on" in caplog.text
    assert len(read(tmp_path / "drive.log")) == 2


def test_recording_changes_nothing(tmp_path: Path) -> None:
    def driven(path: Path | None) -> list[bytes]:
        drive, frames = Drive(), []
        if path is not None:
            drive.record(path)
        for _ in range(10):
            drive.step(1)
            frames.append(drive.simulation.episode.actors.rows.tobytes())
        return frames

    assert driven(None) == driven(tmp_path / "drive.log")


def test_the_same_drive_gives_the_same_file(tmp_path: Path) -> None:
    files = []
    for name in ("one.log", "two.log"):
        drive = Drive()
        drive.record(tmp_path / name)
        drive.step(10)
        files.append((tmp_path / name).read_bytes())
    assert files[0] == files[1]


def test_a_folder_that_cannot_be_written_gets_a_sentence_and_nothing_is_recorded(drive: Drive, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        drive.record(tmp_path / "none" / "drive.log")
    assert isinstance(drive.simulation, World)
    assert drive.simulation.recorder.path is None
