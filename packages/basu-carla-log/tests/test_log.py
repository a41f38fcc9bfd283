"""Claims about the benchmark's own reader of recorder files: columns, whole frames, and damage told in a sentence."""

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.errors import UserError
from basu_carla_log import Log, read_log
from basu_carla_log.layouts import Kind
from basu_carla_log.scan import scan
from fakes import recordings as made

HERO = made.actor(9, "vehicle.tesla.model3", 1, attributes=[(3, "role_name", "hero"), (4, "color", "1,2,3")])
CONTROL = made.several(8, "IfffBi", [(9, 0.25, 0.5, 0.75, 1, -1)])
SIGN = made.actor(4, "traffic.stop", 4)


def parts() -> list[bytes]:
    """A header and three frames."""
    return [
        made.header(),
        made.frame(1, 0.0, made.added(HERO, SIGN), made.positions((9, 100, 200, 300, 1, 2, 3), (4, 0, 0, 0, 0, 0, 0))),
        made.frame(2, 0.05, made.positions((9, 150, 200, 300, 1, 2, 4)), CONTROL),
        made.frame(3, 0.1, made.removed(9), made.packet(20, struct.pack("<d", 0.1)), duration_s=-1.0),
    ]  # fmt: skip


def read(folder: Path, *given_parts: bytes) -> Log:
    return read_log(made.write(folder, *given_parts))


def test_a_file_becomes_columns_over_all_frames(tmp_path: Path) -> None:
    log = read(tmp_path, *parts())
    assert (log.version, log.map_name, log.begun_unix_s) == (1, "Town01", made.NOON_19_NOV_2021_UTC)
    assert (log.frames, log.problem) == (3, None)
    np.testing.assert_array_equal(log.elapsed_s, [0.0, 0.05, 0.1])
    np.testing.assert_array_equal(log.duration_s, [0.05, 0.05, -1.0])
    assert np.isnan(log.platform_s).all()
    positions = log.table(Kind.POSITIONS)
    assert positions.frame.tolist() == [1, 1, 2]
    assert positions.rows["id"].tolist() == [9, 4, 9]
    assert [(one.frame, one.id, one.kind, one.type_id) for one in log.created] == [
        (1, 9, 1, "vehicle.tesla.model3"), (1, 4, 4, "traffic.stop"),
    ]  # fmt: skip
    assert log.created[0].attributes == (("role_name", "hero"), ("color", "1,2,3"))


def test_an_actors_records_are_found_by_frame(tmp_path: Path) -> None:
    positions = read(tmp_path, *parts()).table(Kind.POSITIONS)
    hero = positions.of(9)
    assert hero.frame.tolist() == [1, 2]
    np.testing.assert_array_equal(hero.rows["location_cm"][:, 0], [100, 150])
    second = positions.at(9, 2)
    assert second is not None
    assert second["rotation_deg"].tolist() == [1, 2, 4]
    assert positions.at(4, 2) is None
    assert positions.last(4, 3) == 1
    assert positions.last(9, 0) is None
    assert len(positions.of(77).rows) == 0


def test_a_kind_that_is_not_in_the_file_is_an_empty_table(tmp_path: Path) -> None:
    collisions = read(tmp_path, *parts()).table(Kind.COLLISIONS)
    assert len(collisions) == 0
    assert collisions.at(9, 1) is None
    assert len(collisions.of(9).frame) == 0


def test_actors_are_found_by_role_and_type(tmp_path: Path) -> None:
    log = read(tmp_path, *parts())
    assert log.ids_of(role_name="hero") == (9,)
    assert log.ids_of(type_id="traffic.*") == (4,)
    assert log.ids_of() == (9, 4)
    assert log.ids_of(role_name="hero", type_id="walker.*") == ()


def test_packets_no_query_asks_for_are_counted(tmp_path: Path) -> None:
    assert read(tmp_path, *parts()).unread == {20: 1}


def test_a_file_cut_anywhere_gives_its_whole_frames_and_says_what_is_missing(tmp_path: Path) -> None:
    whole = parts()
    content, ends = b"".join(whole), np.cumsum([len(part) for part in whole]).tolist()
    for length in range(ends[1], len(content)):
        log = read(tmp_path, content[:length])
        frames = sum(end <= length for end in ends) - 1
        assert log.frames == frames
        if length in ends:
            assert log.problem is None
        else:
            assert log.problem is not None
            assert f"frame {frames + 1} is not whole (the file ends at byte {length}" in log.problem
            assert log.problem.endswith(f"it was read up to frame {frames}")


@pytest.mark.parametrize(
    ("broken", "what"),
    [
        (made.packet(6, struct.pack("<H", 2) + bytes(28)), "packet 6, positions, .*: 30 bytes for 2 records, which"),
        (made.packet(6, b"\1"), "1 bytes have no room for a count"),
        (made.positions() + made.positions(), "packet 6, positions, .*: it stands twice"),
        (made.packet(2, struct.pack("<H", 1) + HERO[:-3]), "packet 2, created, .*: 5 bytes are announced where 2 are"),
        (made.packet(2, struct.pack("<H", 1) + HERO + b"abc"), "3 bytes are left over"),
        (made.packet(14, b"1234"), "packet 14, platform time, .*: 4 bytes instead of 8"),
        (made.packet(0, bytes(24)), "packet 0 at byte .* begins a frame inside another"),
    ],
)  # fmt: skip
def test_damage_ends_the_reading_before_its_frame_and_is_reported(tmp_path: Path, broken: bytes, what: str) -> None:
    log = read(tmp_path, *parts()[:2], made.frame(2, 0.05, broken), made.frame(3, 0.1))
    assert log.frames == 1
    assert log.problem is not None
    assert re.search(what, log.problem)
    assert log.problem.endswith("it was read up to frame 1")


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is no recorder file of CARLA: 2 bytes are announced where 0 are left"),
        (b"PK\3\4 and so on", "is no recorder file of CARLA"),
        (struct.pack("<H", 1) + made.text("SOMETHING_ELSE"), "CARLA_RECORDER should stand at its beginning"),
        (made.header(version=9), "is a recorder file of version 9; this program reads 1 and 2"),
        (made.header(), "has no whole frame; record it again"),
        (made.header() + made.frame(1, 0.0)[:-1], "has no whole frame: frame 1 is not whole"),
        (made.header() + made.packet(6, bytes(2)), "packet 6 at byte .* does not begin a frame"),
    ],
)
def test_what_is_no_recording_is_refused_in_a_sentence(tmp_path: Path, content: bytes, sentence: str) -> None:
    path = tmp_path / "drive.log"
    path.write_bytes(content)
    with pytest.raises(UserError, match=sentence):
        read_log(path)


def test_a_file_that_is_not_there_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"none\.log cannot be read: No such file or directory"):
        read_log(tmp_path / "none.log")


@given(st.data())
def test_no_single_wrong_byte_brings_the_reader_down(data: st.DataObject) -> None:
    content = bytearray(b"".join(parts()[1:]))
    place = data.draw(st.integers(0, len(content) - 1))
    content[place] = data.draw(st.integers(0, 255))
    contents, problem = scan(bytes(content), 0)
    assert len(contents.starts) <= 3
    assert (problem is None) == (len(contents.starts) == 3)
