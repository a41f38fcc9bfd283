"""Claims about the gate's policy: which calls pass, what a refused call reads, and what a snapshot shows."""

import struct

import msgpack
import pytest

from linden.gate.calls import CALLS, Rule, Track
from linden.gate.session import Gate
from linden.protocol.wire.answers import Call
from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.protocol.wire.stream import read_token, token_bytes

OWN, OTHER, LIGHT, SENSOR = 7, 8, 9, 10


def gate(track: Track = Track.WORLD) -> Gate:
    opened = Gate(track, OWN, 4002, known=[LIGHT])
    opened.add_sensors([SENSOR])
    return opened


def call(method: str, *args: object) -> Call:
    return Call(1, method, list(args), False)


def snapshot(frame: int, *ids: int) -> bytes:
    header = struct.pack("<QQ", 17, frame).ljust(48 + 36, b"\0")
    return header + b"".join(struct.pack("<I", each).ljust(119, b"\0") for each in ids)


def ids_in(payload: bytes | None) -> list[int]:
    assert payload is not None
    return [struct.unpack_from("<I", payload, at)[0] for at in range(84, len(payload), 119)]


def test_the_table_decides_about_each_function_of_carla() -> None:
    assert CALLS.keys() == CARLA_FUNCTIONS.keys()
    assert all(entry.why for entry in CALLS.values() if entry.rule is Rule.REFUSED)


@pytest.mark.parametrize("method", [name for name, entry in CALLS.items() if entry.rule is Rule.REFUSED])
def test_what_changes_the_world_is_refused_with_a_sentence_and_counted(method: str) -> None:
    opened = gate()
    answer = opened.refuse(call(method, OWN))
    assert answer is not None
    assert f"{method} is refused by the gate: {CALLS[method].why}" in str(msgpack.unpackb(answer))
    assert opened.refused == {method: 1}


def test_an_agent_controls_its_own_vehicle_only() -> None:
    assert gate().refuse(call("apply_control_to_vehicle", OWN, [])) is None
    assert gate().refuse(call("apply_control_to_vehicle", OTHER, [])) is not None
    assert gate().refuse(call("apply_batch", [[[2, [OWN, []]]]], False)) is None
    assert gate().refuse(call("apply_batch", [[[2, [OWN, []]]], [[2, [OTHER, []]]]], False)) is not None
    assert gate().refuse(call("apply_batch", [[[2, [OWN, []]]]], True)) is not None  # it would tick
    assert gate().refuse(call("no_such_function")) is not None


def test_a_track_hides_other_actors() -> None:
    frame = snapshot(5, OWN, OTHER, LIGHT)
    assert ids_in(gate().shown(frame)) == [OWN, OTHER, LIGHT]
    assert ids_in(gate(Track.SENSORS).shown(frame)) == [OWN]
    opened = gate(Track.OBJECTS)
    assert opened.shown(frame) is None  # until the benchmark says what the agent sees
    opened.see(5, [])
    assert ids_in(opened.shown(frame)) == [OWN, LIGHT]
    assert opened.refuse(call("get_physics_control", OTHER)) is not None
    opened.see(6, [OTHER])
    assert ids_in(opened.shown(snapshot(6, OWN, OTHER, LIGHT))) == [OWN, OTHER, LIGHT]
    assert opened.refuse(call("get_physics_control", OTHER)) is None


def test_only_the_agents_sensors_are_heard_and_tokens_name_the_gate() -> None:
    opened = gate(Track.SENSORS)

    def actor(key: int, stream_id: int) -> list[object]:
        return [key, 0, [1, "sensor.other.imu", [["role_name", 4, "hero"]]], [], b"", token_bytes(stream_id, 2001)]

    asked = call("get_actors_by_id", [SENSOR, OTHER])
    answer = msgpack.packb([1, 1, None, [[1, [actor(SENSOR, 30), actor(OTHER, 31)]]]])
    described = msgpack.unpackb(opened.rewritten(asked, answer))[3][0][1]
    assert [each[0] for each in described] == [SENSOR]
    assert described[0][2][2][0][2] == ""  # a role may say which part an actor has
    assert (opened.may_hear(30), opened.may_hear(31), opened.may_hear(1)) == (True, False, True)
    token = msgpack.packb([1, 1, None, [[1, [token_bytes(30, 2001)]]]])
    told = msgpack.unpackb(opened.rewritten(call("get_sensor_token", 30), token))[3][0][1][0]
    assert read_token(told) == (30, 4002, None)
