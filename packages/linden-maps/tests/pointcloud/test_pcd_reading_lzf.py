"""Claims about the unpacking of LZF."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fakes.pcd_files import lzf
from linden_maps.pointcloud.pcd_reading import unpack


def bytes_of(packed: bytes, size: int) -> bytes | None:
    found = unpack(np.frombuffer(packed, np.uint8), size)
    return None if found is None else found.tobytes()


def test_literals_and_a_copy_that_reaches_into_itself() -> None:
    # two literal bytes, then 3 bytes from 2 back, then 12 bytes from 1 back
    assert bytes_of(b"\x01ab\x20\x01\xe0\x03\x00", 17) == b"ababa" + b"a" * 12


@given(st.lists(st.sampled_from([b"\x00", b"ab", b"abcdefgh" * 5, b"\xff\x01\x02", b"x" * 300]), max_size=40))
def test_what_was_packed_comes_back(parts: list[bytes]) -> None:
    raw = b"".join(parts)
    assert bytes_of(lzf(raw), len(raw)) == raw


@pytest.mark.parametrize(
    ("packed", "size"),
    [
        (b"\x05abc", 6),  # literals that are not there
        (b"\x00a\x20", 4),  # a copy without its distance
        (b"\x00a\xe0", 20),  # a long copy without its length
        (b"\x00a\x20\x05", 4),  # a copy from before the beginning
        (b"\x01ab", 3),  # too little
        (b"\x01ab", 1),  # too much
        (b"\x00a\x20\x00", 2),  # a copy beyond the end
    ],
)
def test_a_packing_of_another_length_gets_a_sentence(packed: bytes, size: int) -> None:
    assert bytes_of(packed, size) is None
