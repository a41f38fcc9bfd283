"""Claims about the streams: tokens, the handshake, the size before a message."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.errors import ProtocolError
from linden.protocol.wire.stream import StreamTable, Subscription, size_prefix, token_bytes


def test_a_token_names_stream_port_and_no_address() -> None:
    assert token_bytes(5, 2001) == struct.pack("<IHBB", 5, 2001, 1, 0) + bytes(16)


@given(st.integers(0, 2**32 - 1), st.lists(st.integers(1, 4), min_size=1, max_size=4))
def test_a_stream_id_cut_anywhere_waits_for_its_rest(stream_id: int, lengths: list[int]) -> None:
    rest = struct.pack("<I", stream_id)
    subscription = Subscription()
    for length in lengths:
        part, rest = rest[:length], rest[length:]
        if part:
            assert subscription.receive(part) == (not rest)
    assert subscription.stream_id == (None if rest else stream_id)


def test_more_than_a_stream_id_is_no_subscription() -> None:
    with pytest.raises(ProtocolError, match="4 bytes of a stream id"):
        Subscription().receive(b"GET / HTTP/1.1\r\n")
    late = Subscription()
    assert late.receive(b"\1\0\0\0")
    with pytest.raises(ProtocolError, match="nothing after them"):
        late.receive(b"\0")


def test_a_message_is_preceded_by_its_size_and_never_empty() -> None:
    assert size_prefix(258) == b"\x02\x01\0\0"
    with pytest.raises(ValueError, match="not 0"):
        size_prefix(0)


def test_a_stream_has_listeners_until_the_last_one_leaves() -> None:
    table = StreamTable(2001)
    table.subscribe(3)
    table.subscribe(3)
    table.unsubscribe(3)
    assert table.listened() == {3}
    table.unsubscribe(3)
    assert table.listened() == set()
    assert table.token(3).data == token_bytes(3, 2001)
