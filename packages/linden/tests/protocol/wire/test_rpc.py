"""Claims about msgpack-RPC: whatever the cuts, the same calls; whatever the bytes, calls or a sentence."""

import gc
import random
import tracemalloc
from typing import Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.errors import ProtocolError
from linden.protocol.wire import rpc
from linden.protocol.wire.rpc import Call, Reply, RpcConnection

json_like = st.recursive(
    st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats(allow_nan=False) | st.text() | st.binary(),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=12,
)
calls = st.builds(Call, st.integers(0, 2**32 - 1), st.text(), st.lists(json_like, max_size=4), st.booleans())


def request(call: Call) -> bytes:
    packed: bytes = msgpack.packb(
        [0, call.id, call.method, [[call.is_async], *call.args]], unicode_errors="surrogatepass"
    )
    return packed


def unpacked(answer: bytes) -> Any:
    return msgpack.unpackb(answer)


CALL = Call(7, "tick_cue", [], is_async=False)


@given(st.lists(calls, max_size=4), st.data())
def test_a_message_cut_anywhere_waits_for_its_rest(sent: list[Call], data: st.DataObject) -> None:
    stream = b"".join(request(call) for call in sent)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=6)))
    connection = RpcConnection()
    received = []
    for start, end in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        received += connection.receive(stream[start:end])
    assert received == sent


def test_byte_by_byte_the_call_comes_with_the_last_byte() -> None:
    connection = RpcConnection()
    message = request(CALL)
    assert [connection.receive(message[i : i + 1]) for i in range(len(message))] == [[]] * (len(message) - 1) + [[CALL]]


@given(st.binary(max_size=200))
def test_any_bytes_are_calls_or_a_protocol_error(noise: bytes) -> None:
    connection = RpcConnection()
    assert outcome(connection, noise)


def outcome(connection: RpcConnection, data: bytes) -> bool:
    """Whether data ends in calls or in a sentence; anything else is raised."""
    try:
        return all(isinstance(call, Call) for call in connection.receive(data))
    except ProtocolError as error:
        return len(str(error)) > 10


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        ([1, 0, None, []], "expected a request"),
        ([0, 0, "version"], "an array of 3"),
        ([0, "zero", "version", [[False]]], "id str 'zero'"),
        ([0, 0, 3, [[False]]], "int 3"),
        ([0, 0, "version", []], "expected .is_async. before the arguments"),
        ([0, 0, "version", [[1]]], "'version': expected .is_async."),
        ([False, 0, "version", [[False]]], "expected a request"),
        (71, "got int 71"),  # the G of an HTTP request
        ({}, "got dict"),
    ],
)
def test_what_is_no_request_is_named(message: Any, sentence: str) -> None:
    with pytest.raises(ProtocolError, match=sentence):
        RpcConnection().receive(msgpack.packb(message))


def test_calls_before_the_broken_place_are_carried_out_first() -> None:
    connection = RpcConnection()
    assert connection.receive(request(CALL) + b"\xc1") == [CALL]
    assert connection.is_broken
    with pytest.raises(ProtocolError, match="not msgpack"):
        connection.receive(request(CALL))


def test_a_map_is_no_part_of_the_protocol() -> None:
    with pytest.raises(ProtocolError, match="max_map_len"):
        RpcConnection().receive(msgpack.packb([0, 0, "version", [[False], {"a": 1}]]))


def test_nesting_without_end_is_refused() -> None:
    with pytest.raises(ProtocolError, match="not msgpack"):
        RpcConnection().receive(b"\x91" * 5000)


def test_five_bytes_cannot_ask_for_gigabytes() -> None:
    gc.collect()
    tracemalloc.start()
    with pytest.raises(ProtocolError, match="max_array_len"):
        RpcConnection().receive(b"\xdd\xff\xff\xff\xff")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2**20


@pytest.mark.parametrize(
    "part",
    [
        pytest.param(b"\xdc\x00\x64" + b"\x01" * 98, id="arrays that are never full"),
        pytest.param(b"\xdb\xff\xff\xff\xff" + b"a" * 95, id="a text of 4 GB"),
        pytest.param(b"\xc6\xff\xff\xff\xff" + b"a" * 95, id="4 GB of bytes"),
    ],
)
def test_a_message_without_end_is_refused_at_the_limit(part: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rpc, "MAX_MESSAGE_BYTES", 10_000)
    connection, fed = RpcConnection(), []
    with pytest.raises(ProtocolError):
        feed_for_ever(connection, part, fed)
    assert sum(fed) <= 10_000


def feed_for_ever(connection: RpcConnection, part: bytes, fed: list[int]) -> None:
    while connection.receive(part) == []:
        fed.append(len(part))


def test_many_short_messages_are_no_long_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rpc, "MAX_MESSAGE_BYTES", 5000)
    connection = RpcConnection()
    assert sum(len(connection.receive(request(CALL))) for _ in range(500)) == 500


def test_a_text_that_is_not_utf8_comes_back_as_it_came() -> None:
    name = b"caf\xe9"
    message = b"\x94\x00\x01\xa7version\x92\x91\xc2" + bytes([0xA0 + len(name)]) + name
    (call,) = RpcConnection().receive(message)
    assert name in rpc.value(call, call.args[0])


def test_answers_are_wrapped_as_the_client_reads_them() -> None:
    assert unpacked(rpc.value(CALL, 5)) == [1, 7, None, [[1, 5]]]
    assert unpacked(rpc.void(CALL)) == [1, 7, None, [[False]]]
    assert unpacked(rpc.bare(CALL, [((1, 5),)])) == [1, 7, None, [[[1, 5]]]]
    lamps = [(3, 0), (70_000, 5)]
    assert rpc.value(CALL, rpc.packed_result(lamps)) == rpc.value(CALL, lamps)
    assert rpc.bare(CALL, rpc.packed_result([((1, 5),)])) == rpc.bare(CALL, [((1, 5),)])
    assert unpacked(rpc.refusal(CALL, "no", Reply.VALUE)) == [1, 7, None, [[0, ["no"]]]]
    assert unpacked(rpc.refusal(CALL, "no", Reply.VOID)) == [1, 7, None, [[True, ["no"]]]]
    assert unpacked(rpc.refusal(CALL, "no", Reply.BARE)) == [1, 7, "no", None]
    assert unpacked(rpc.unknown(CALL, "what?")) == [1, 7, "what?", None]


def test_a_failed_answer_leaves_nothing_behind_for_the_next() -> None:
    with pytest.raises(TypeError):
        rpc.value(CALL, [1, 2, object()])
    assert unpacked(rpc.value(CALL, 5)) == [1, 7, None, [[1, 5]]]


def test_ten_thousand_damaged_requests_end_in_calls_or_sentences() -> None:
    chance = random.Random(2000)
    for _ in range(10_000):
        call = Call(chance.randrange(2**32), "set_actor_location", [3, [1.0, 2.0, 3.0]], is_async=True)
        message = bytearray(request(call))
        for _ in range(chance.randrange(1, 5)):
            message[chance.randrange(len(message))] = chance.randrange(256)
        assert outcome(RpcConnection(), bytes(message[: chance.randrange(len(message) + 1)]))


@pytest.mark.parametrize("array", [b"\x90", b"\x80", b"\xdc\x00\x00", b"\xdd\x00\x00\x00\x00"])
def test_empty_arrays_cannot_ask_for_gigabytes(array: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rpc, "MAX_ARRAYS", 1000)
    connection, head = RpcConnection(), b"\x94\x00\x01\xa7version\xdd\x00\x00\xff\xff\x91\xc2"
    assert connection.receive(head + array * 990) == []
    with pytest.raises(ProtocolError, match="more than 1000 arrays"):
        connection.receive(array * 20)
    assert connection.is_broken


def test_the_arrays_of_one_message_do_not_count_for_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rpc, "MAX_ARRAYS", 50)
    connection, sent = RpcConnection(), Call(1, "version", [[], []] * 10, is_async=False)
    for _ in range(20):
        assert connection.receive(request(sent)) == [sent]


def test_what_is_quoted_of_a_long_text_is_its_beginning() -> None:
    connection = RpcConnection()
    message = msgpack.packb([0, 1, "\udcff" * 1_000_000, [1]], unicode_errors="surrogateescape")
    with pytest.raises(ProtocolError) as caught:
        connection.receive(message)
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("method", rpc.OF_PIXELS)
@pytest.mark.parametrize("cut", [0, 100, 2000])
def test_pixels_are_passed_over_and_the_calls_round_them_are_not(
    method: str, cut: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rpc, "MAX_ARRAYS", 500)
    picture = request(Call(9, method, [["House_0"], 3, [1000, 1, [[1, 2, 3, 4]] * 1000]], is_async=False))
    connection = RpcConnection()
    received = connection.receive(request(CALL))
    received += connection.receive(picture[:cut]) if cut else []
    received += connection.receive(picture[cut:] + request(CALL))
    assert received == [CALL, Call(9, method, [["House_0"], None, None], is_async=False), CALL]
    assert connection.unfinished_bytes == 0


def test_pixels_of_a_call_without_sense_get_a_sentence() -> None:
    broken = b"\x94\x00\x01\xbe" + rpc.OF_PIXELS[0].encode() + b"\x91\xc1"
    with pytest.raises(ProtocolError, match="not msgpack"):
        RpcConnection().receive(broken)


def test_a_long_message_leaves_no_buffer_and_what_follows_it_is_read() -> None:
    connection, text = RpcConnection(), "x" * 5_000_000
    long = Call(1, "copy_opendrive_to_file", [text], is_async=False)
    stream = request(long)
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    for begin in range(0, len(stream), 262_144):
        received = connection.receive(stream[begin : begin + 262_144])
    assert received == [long]
    del received
    assert tracemalloc.get_traced_memory()[0] - before < 500_000
    tracemalloc.stop()
    assert connection.receive(request(CALL) + request(CALL)[:3]) == [CALL]
    assert connection.unfinished_bytes == 3
    assert connection.receive(request(CALL)[3:]) == [CALL]
