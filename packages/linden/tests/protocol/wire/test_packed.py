"""Batches read straight from bytes: the same controls as by way of msgpack, and nothing else."""

import math
from typing import Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.protocol.values.control import VehicleControl
from linden.protocol.wire import packed
from linden.protocol.wire.commands import COMMANDS, ApplyVehicleControl, decode_commands
from linden.protocol.wire.controls import LARGEST_PLAIN, WORTH_COLUMNS, Controls
from linden.protocol.wire.decode import WireTypeError
from linden.protocol.wire.rpc import Call, RpcConnection

PLAIN = [0.5, -0.25, 0.0, False, True, False, 1]


def control(actor_id: Any, fields: Any = PLAIN) -> list[Any]:
    return [[packed.CONTROL_INDEX, [actor_id, fields]]]


def request(commands: Any, call_id: int = 7, *, tick: Any = False, single: bool = True) -> bytes:
    sent: bytes = msgpack.packb([0, call_id, "apply_batch", [[False], commands, tick]], use_single_float=single)
    return sent


def test_the_index_is_that_of_a_control() -> None:
    assert COMMANDS[packed.CONTROL_INDEX] is ApplyVehicleControl


@pytest.mark.parametrize("call_id", [0, 127, 128, 2**16, 2**32 - 1])
@pytest.mark.parametrize("count", [WORTH_COLUMNS, 15, 16, 300, 70_000])
def test_a_batch_of_plain_controls_is_read_in_columns(call_id: int, count: int) -> None:
    ids = [number * 3 for number in range(count)]
    data = request([control(actor_id) for actor_id in ids], call_id, tick=True)
    batch = packed.read(data + b"\x94\x00")
    assert batch is not None
    assert (batch.call_id, batch.is_async, batch.do_tick, batch.end) == (call_id, False, True, len(data))
    assert batch.controls.actor_ids.tolist() == ids
    assert batch.controls.fields.tolist() == [PLAIN] * count


@pytest.mark.parametrize("number", [0, 127, 128, 255, 256, 65535, 65536, 2**32 - 1])
def test_ids_of_any_width_are_read(number: int) -> None:
    batch = packed.read(request([control(number)] * 10))
    assert batch is not None
    assert batch.controls.actor_ids.tolist() == [number] * 10


@pytest.mark.parametrize("gear", [-1, -32, -33, -128, -129, -32769, 127, 128, 255, 256, 65536, LARGEST_PLAIN, -(2**31)])
def test_gears_of_any_width_are_read(gear: int) -> None:
    batch = packed.read(request([control(1, [*PLAIN[:6], gear])] * 10))
    assert batch is not None
    assert batch.controls.fields[:, 6].tolist() == [gear] * 10


@pytest.mark.parametrize(
    "unusual",
    [
        pytest.param(control(3, [math.nan, *PLAIN[1:]]), id="a number that is none"),
        pytest.param(control(3, [0.0, -math.inf, *PLAIN[2:]]), id="an infinite number"),
        pytest.param(control(3, [1e30, *PLAIN[1:]]), id="a large number"),
        pytest.param(control(3, [1, *PLAIN[1:]]), id="an integer for a pedal"),
        pytest.param(control(3, [*PLAIN[:3], 0, *PLAIN[4:]]), id="a number for a switch"),
        pytest.param(control(3, [*PLAIN[:6], 1.0]), id="a float for a gear"),
        pytest.param(control(3, [*PLAIN[:6], 2**32 - 1]), id="a large gear"),
        pytest.param(control(3, PLAIN[:5]), id="fields left out"),
        pytest.param(control(3, [*PLAIN, 0]), id="a field too many"),
        pytest.param(control(-3), id="a negative id"),
        pytest.param(control(2**32), id="an id of 64 bits"),
        pytest.param(control(True), id="a switch for an id"),
        pytest.param([[0, [3]]], id="another command"),
        pytest.param(5, id="no command"),
    ],
)
def test_an_unusual_command_leaves_the_batch_to_msgpack(unusual: Any) -> None:
    usual = [control(number) for number in range(10)]
    for commands in ([*usual, unusual], [unusual, *usual]):
        assert packed.read(request(commands)) is None


def test_every_cut_leaves_the_batch_to_msgpack_and_ends_in_the_same_call() -> None:
    data = request([control(number) for number in range(20)])
    for cut in range(len(data)):
        assert packed.read(data[:cut]) is None
        connection = RpcConnection()
        (call,) = [*connection.receive(data[:cut]), *connection.receive(data[cut:])]
        assert (call.id, call.method, len(call.args), call.is_async) == (7, "apply_batch", 2, False)
        assert connection.unfinished_bytes == 0


def test_a_batch_in_the_midst_of_another_call_is_part_of_that() -> None:
    """A text that holds a batch's bytes, cut where they begin."""
    data = request([control(number) for number in range(20)])
    outer = msgpack.packb([0, 1, "set_map", [[False], data]])
    start = outer.index(data)
    connection = RpcConnection()
    assert connection.receive(outer[:start]) == []
    assert connection.receive(outer[start:]) == [Call(1, "set_map", [data], is_async=False)]


def test_calls_before_and_behind_a_batch_keep_their_order() -> None:
    tick = msgpack.packb([0, 8, "tick_cue", [[False]]])
    batch = request([control(number) for number in range(20)])
    connection = RpcConnection()
    received = connection.receive(batch + tick + batch + tick[:5]) + connection.receive(tick[5:] + batch)
    received += connection.receive(batch)
    assert [call.method for call in received] == [
        *("apply_batch", "tick_cue", "apply_batch", "tick_cue", "apply_batch", "apply_batch")
    ]
    assert isinstance(received[0].args[0], Controls)
    assert isinstance(received[-1].args[0], Controls)


NUMBERS = st.floats(-2.0, 2.0, width=32) | st.floats(width=32) | st.integers(-3, 3)
FIELDS = st.one_of(
    st.just(PLAIN),
    st.tuples(NUMBERS, NUMBERS, NUMBERS, st.booleans(), st.booleans(), st.booleans(), st.integers(-(2**33), 2**33)).map(
        list
    ),
    st.lists(NUMBERS, max_size=8),
)
COMMANDS_SENT = st.lists(st.builds(control, st.integers(-1, 2**33), FIELDS), min_size=0, max_size=4)


@given(COMMANDS_SENT, st.booleans(), st.integers(8, 20))
def test_what_is_read_is_what_the_decoders_find(unusual: list[Any], single: bool, count: int) -> None:  # noqa: FBT001
    commands = [*(control(number) for number in range(count)), *unusual]
    batch = packed.read(request(commands, single=single))
    raw = msgpack.unpackb(msgpack.packb(commands, use_single_float=single))
    try:
        one_by_one = decode_commands(raw)
    except WireTypeError:
        assert batch is None
        return
    if batch is None:
        return
    found = [
        ApplyVehicleControl(int(actor_id), VehicleControl(*row[:3], *map(bool, row[3:6]), int(row[6])))
        for actor_id, row in zip(batch.controls.actor_ids, batch.controls.fields.tolist(), strict=True)
    ]
    assert tuple(found) == one_by_one


@given(st.binary(max_size=400))
def test_any_bytes_behind_a_batchs_beginning_are_read_or_left(noise: bytes) -> None:
    beginning = request([control(number) for number in range(20)])[:19]
    batch = packed.read(beginning + noise)
    assert batch is None or batch.end <= len(beginning + noise)
