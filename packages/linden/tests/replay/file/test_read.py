import struct
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes import recordings as made
from linden.protocol.values.space import Vector3D
from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import CutShortError, NoRecordingError, RecordingError
from linden.replay.file.read import Recording

HERO = made.actor(9, "vehicle.tesla.model3", 1, attributes=[(3, "role_name", "hero"), (4, "color", "1,2,3")])


def whole() -> list[bytes]:
    """A header and three frames."""
    return [
        made.header(),
        made.frame(1, 0.0, made.added(HERO), made.positions((9, 100, 200, 300, 1, 2, 3))),
        made.frame(2, 0.05, made.several(8, "IfffBi", [(9, 0.25, 0.5, 0.75, 1, -1)])),
        made.frame(3, 0.1, made.removed(9), duration_s=-1.0),
    ]


def test_a_frame_holds_what_its_bytes_say(tmp_path: Path) -> None:
    with Recording(made.write(tmp_path, *whole())) as recording:
        assert recording.header == (1, made.NOON_19_NOV_2021_UTC, "Town01")
        first, second, third = recording.frames()
    (hero,) = first.added
    assert (hero.id, hero.kind, hero.description.uid, hero.description.id) == (9, 1, 7, "vehicle.tesla.model3")
    assert (hero.location_cm, hero.rotation_deg) == ((100.0, 200.0, 300.0), (1.0, 2.0, 3.0))
    assert [tuple(a) for a in hero.description.attributes] == [("role_name", 3, "hero"), ("color", 4, "1,2,3")]
    np.testing.assert_array_equal(first.positions["location_cm"], [[100, 200, 300]])
    assert second.vehicles.tolist() == [(9, 0.25, 0.5, 0.75, 1, -1)]
    assert third.removed["id"].tolist() == [9]
    assert [(f.number, f.duration_s, f.elapsed_s) for f in (first, second, third)] == [
        (1, 0.05, 0.0), (2, 0.05, 0.05), (3, -1.0, 0.1),
    ]  # fmt: skip


def test_what_a_file_leaves_out_is_none_of_it(tmp_path: Path) -> None:
    with Recording(made.write(tmp_path, made.header(), made.frame(1, 0.0))) as recording:
        (frame,) = recording.frames()
    assert not frame.packets
    assert (len(frame.positions), len(frame.kinematics), frame.added, frame.physics) == (0, 0, (), ())
    assert frame.platform_time_s is None


def test_physics_come_back_with_every_list(tmp_path: Path) -> None:
    lists = [(2, [(0, 500), (5000, 400)]), (3, [(4.5, 0.25, 0.5)]), (2, [(0, 1)])]
    content = struct.pack("<I5f?4f3f", 9, 6500, 1, 0.125, 2, 0.375, True, 10, 3.25, 1696, 0.25, 0.5, 0, -0.25)
    for width, rows in lists:
        content += struct.pack("<I", len(rows)) + b"".join(struct.pack(f"<{width}f", *row) for row in rows)
    content += struct.pack("<I", 1) + struct.pack("<12f", *range(1, 13))
    parts = made.header(), made.frame(1, 0.0, made.packet(15, struct.pack("<H", 1) + content))
    with Recording(made.write(tmp_path, *parts)) as recording:
        ((actor_id, control),) = next(recording.frames()).physics
    assert (actor_id, control.max_rpm, control.mass, control.use_gear_autobox) == (9, 6500.0, 1696.0, True)
    assert control.center_of_mass == Vector3D(0.5, 0.0, -0.25)
    assert [tuple(point) for point in control.torque_curve] == [(0, 500), (5000, 400)]
    assert [tuple(gear) for gear in control.forward_gears] == [(4.5, 0.25, 0.5)]
    (wheel,) = control.wheels
    assert (wheel.tire_friction, wheel.radius, wheel.long_stiff_value) == (1.0, 4.0, 9.0)
    assert wheel.position == Vector3D(10.0, 11.0, 12.0)


def test_a_file_cut_anywhere_gives_its_whole_frames_and_then_says_where_it_ends(tmp_path: Path) -> None:
    parts = whole()
    content, ends = b"".join(parts), np.cumsum([len(part) for part in parts])
    for length in range(int(ends[0]), len(content)):
        path = tmp_path / "cut.log"
        path.write_bytes(content[:length])
        with Recording(path) as recording:
            if length not in ends:
                with pytest.raises(CutShortError, match=r"ends inside a frame \(the packet at byte \d+") as caught:
                    list(recording.frames())
                assert caught.value.offset <= length
            assert [frame.number for frame in recording.whole_frames()] == list(
                range(1, int(np.searchsorted(ends, length, side="right")))
            )


@pytest.mark.parametrize("number", [25, 99, 200, 255])
def test_packets_that_no_release_has_are_skipped_by_their_size(tmp_path: Path, number: int) -> None:
    parts = made.header(), made.frame(1, 0.0, made.packet(number, b"whatever"), made.positions((9, 1, 2, 3, 4, 5, 6)))
    with Recording(made.write(tmp_path, *parts)) as recording:
        (frame,) = recording.frames()
    assert list(frame.packets) == [PacketId.POSITIONS]


DOORS = struct.pack("<HIBB", 1, 9, 2, 1)
WHEELS = struct.pack("<HIIBffBff", 1, 9, 2, 0, 12.5, 90.0, 1, 12.25, 80.0)
BIKERS = struct.pack("<HIff", 1, 9, 3.5, 0.5)


@pytest.mark.parametrize("number", [21, 22, 23])
@pytest.mark.parametrize(
    ("content", "kind"),
    [(DOORS, PacketId.DOORS), (WHEELS, PacketId.WHEELS), (BIKERS, PacketId.BIKERS)],
    ids=["doors", "wheels", "bikers"],
)
def test_doors_wheels_and_bikers_are_distinguished_under_each_number(
    tmp_path: Path, number: int, content: bytes, kind: PacketId
) -> None:
    with Recording(made.write(tmp_path, made.header(), made.frame(1, 0.0, made.packet(number, content)))) as recording:
        (frame,) = recording.frames()
    assert list(frame.packets) == [kind]
    ((actor_id, *_),) = frame.packets[kind]
    assert actor_id == 9


def test_empty_lists_of_wheels_bikers_and_doors_stand_beside_each_other(tmp_path: Path) -> None:
    empty = [made.packet(number, b"\0\0") for number in (21, 22, 23)]
    with Recording(made.write(tmp_path, made.header(), made.frame(1, 0.0, *empty))) as recording:
        (frame,) = recording.frames()
    assert list(frame.packets) == [PacketId.WHEELS, PacketId.BIKERS, PacketId.DOORS]
    assert frame.wheels == ()
    assert len(frame.doors) == 0


FRAME = made.frame(1, 0.0, made.positions((9, 1, 2, 3, 4, 5, 6)))
HEADER = len(made.header())
DAMAGES = {
    "a packet outside of a frame": (made.positions(), HEADER, "packet 6 (positions) outside of a frame"),
    "a frame inside another": (FRAME[:29] + FRAME, HEADER + 29, None),
    "records that do not fit": (made.frame(1, 0.0, made.packet(6, b"\2\0" + bytes(30))), HEADER + 36, None),
    "too many bytes": (made.frame(1, 0.0, made.packet(6, b"\1\0" + bytes(30))), HEADER + 64, "2 bytes too many"),
    "a packet twice": (made.frame(1, 0.0, made.removed(), made.removed()), HEADER + 26 + 7 + 5, "stands twice"),
    "neither doors nor wheels": (made.frame(1, 0.0, made.packet(21, b"\1\0abc")), HEADER + 33, "packet 21"),
}


@pytest.mark.parametrize(("content", "offset", "says"), DAMAGES.values(), ids=DAMAGES.keys())
def test_damage_is_reported_with_the_byte_where_it_shows(
    tmp_path: Path, content: bytes, offset: int, says: str | None
) -> None:
    path = made.write(tmp_path, made.header(), content)
    with Recording(path) as recording, pytest.raises(RecordingError) as caught:
        list(recording.frames())
    assert not isinstance(caught.value, CutShortError)
    assert str(caught.value.offset) in str(caught.value)
    assert abs(caught.value.offset - offset) <= 5, str(caught.value)
    assert (says or "damaged recording") in str(caught.value)


def test_a_size_beyond_the_file_takes_no_memory(tmp_path: Path) -> None:
    path = made.write(tmp_path, made.header(), made.frame(1, 0.0)[:-5], struct.pack("<BI", 6, 2**32 - 1), b"rest")
    with Recording(path) as recording, pytest.raises(CutShortError):
        list(recording.frames())


@pytest.mark.parametrize(
    "content", [b"", b"\1", b"\1\0\16\0CARLA_REC", b"\1\0\16\0CARLA_RECORDEX" + bytes(20), bytes(99)]
)
def test_what_is_no_recording_is_called_so(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(NoRecordingError, match="not a CARLA recorder file"):
        Recording(made.write(tmp_path, content))


def test_an_unknown_version_and_an_impossible_date_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="version 3"):
        Recording(made.write(tmp_path, made.header(version=3)))
    with pytest.raises(RecordingError, match="are no date"):
        Recording(made.write(tmp_path, made.header(date=-(2**62))))


def test_frames_are_found_without_reading_them(tmp_path: Path) -> None:
    parts = whole()
    with Recording(made.write(tmp_path, *parts)) as recording:
        found = list(recording.places())
        assert Counter(place.end - place.start for place in found) == Counter(len(part) for part in parts[1:])
        assert recording.frame(found[2]).removed["id"].tolist() == [9]
        assert recording.frame(found[0]).added[0].id == 9


@given(st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 255)), max_size=8), st.integers(0, 10_000))
def test_whatever_stands_in_a_file_is_read_or_refused(changes: list[tuple[int, int]], length: int) -> None:
    content = bytearray(b"".join(whole()))
    for at, value in changes:
        content[at % len(content)] = value
    with TemporaryDirectory() as folder:
        path = Path(folder) / "any.log"
        path.write_bytes(content[: max(1, length % (2 * len(content)))])
        said = ""
        try:
            with Recording(path) as recording:
                list(recording.frames())
        except RecordingError as error:
            said = str(error)
        assert not said or str(path) in said or "at byte" in said
