import struct
from pathlib import Path

import numpy as np
import pytest

from fakes import recordings as made
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import Gear, VehiclePhysicsControl, Wheel
from linden.protocol.values.space import Vector2D, Vector3D
from linden.replay.file import layouts
from linden.replay.file import write as encode
from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import ActorAdded, PhysicsRecord
from linden.replay.file.read import Recording
from linden.replay.file.write import RecordingWriter

HERO = ActorAdded(
    9, 1, (100.0, 200.0, 300.0), (1.0, 2.0, 3.0),
    ActorDescription(7, "vehicle.tesla.model3", (AttributeValue("role_name", 4, "hero"),)),
)  # fmt: skip
FULL = Path("/dev/full")
REMOVED = encode.records(PacketId.REMOVED, np.array([(9,)], layouts.REMOVED))


def test_the_bytes_are_as_carlas_headers_describe(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / "drive.log", "Town01", made.NOON_19_NOV_2021_UTC)
    writer.add(0.05, [encode.added([HERO])])
    writer.add(0.1, [REMOVED])
    writer.close()
    byte_by_byte = made.actor(9, "vehicle.tesla.model3", 1, attributes=[(4, "role_name", "hero")])
    assert writer.path.read_bytes() == b"".join(
        (
            made.header(),
            made.frame(1, 0.0, made.added(byte_by_byte), duration_s=0.1),
            made.frame(2, 0.1, made.removed(9), duration_s=-1.0),
        )
    )


def test_every_frame_is_in_the_file_as_soon_as_it_is_added(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / "drive.log", "Town01", 0)
    for count in range(4):
        with Recording(writer.path) as recording:
            assert [frame.number for frame in recording.frames()] == list(range(1, count + 1))
        writer.add(0.05, [REMOVED])
    writer.close()


def test_a_vehicles_physics_are_read_as_they_were_written(tmp_path: Path) -> None:
    control = VehiclePhysicsControl(
        torque_curve=(Vector2D(0.0, 500.0), Vector2D(5000.0, 250.0)),
        forward_gears=(Gear(4.5, 0.25, 0.5), Gear(2.5, 0.25, 0.75)),
        use_gear_autobox=False,
        center_of_mass=Vector3D(0.5, 0.0, -0.25),
        wheels=(Wheel(radius=35.5, position=Vector3D(1.0, 2.0, 3.0)), Wheel(max_steer_angle=0.0)),
    )
    exact = struct.unpack("<f", struct.pack("<f", 0.15))[0]
    control = control._replace(damping_rate_full_throttle=exact, drag_coefficient=exact,
                               damping_rate_zero_throttle_clutch_disengaged=exact)  # fmt: skip
    writer = RecordingWriter(tmp_path / "drive.log", "Town01", 0)
    writer.add(0.0, [encode.physics([PhysicsRecord(9, control)])])
    writer.close()
    with Recording(writer.path) as recording:
        assert next(recording.frames()).physics == (PhysicsRecord(9, control),)


def test_texts_longer_than_their_length_can_say_are_cut_between_characters() -> None:
    encoded = encode.text("ä" * 40_000)
    assert len(encoded) == 2 + 65_534
    assert encoded[2:].decode() == "ä" * 32_767


@pytest.mark.skipif(not FULL.exists(), reason="needs a device that is always full")
def test_a_full_disk_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space left"):
        RecordingWriter(FULL, "Town01", 0)


def test_a_disk_that_fills_up_leaves_the_frames_that_were_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = RecordingWriter(tmp_path / "drive.log", "Town01", 0)
    writer.add(0.05, [REMOVED])
    writer.add(0.05, [REMOVED])
    file = writer._file

    class Filling:
        """Takes ten bytes more, then no more."""

        left = 10

        def write(self, content: memoryview) -> int:
            if not self.left:
                raise OSError(28, "No space left on device")
            taken = file.write(content[: self.left])
            self.left -= taken
            return taken

        def __getattr__(self, name: str) -> object:
            return getattr(file, name)

    monkeypatch.setattr(writer, "_file", Filling())
    with pytest.raises(OSError, match="No space left"):
        writer.add(0.05, [REMOVED])
    writer.close()
    with Recording(writer.path) as recording:
        assert [frame.number for frame in recording.frames()] == [1, 2]
