"""Controls of many vehicles at once: the short way decodes what the long way does, and nothing else."""

import math
from collections.abc import Callable
from typing import Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire.commands import (
    COMMANDS,
    ApplyTransform,
    ApplyVehicleControl,
    Command,
    DestroyActor,
    decode_batch,
    decode_commands,
)
from linden.protocol.wire.controls import WORTH_COLUMNS, Controls, Transforms, plain_controls, plain_transforms
from linden.protocol.wire.decode import WireTypeError

CONTROL, DESTROY, TRANSFORM = (COMMANDS.index(kind) for kind in (ApplyVehicleControl, DestroyActor, ApplyTransform))
PLACE = [[1.0, -2.0, 3.0], [0.0, 90.0, 0.5]]
PLAIN = [0.4, -0.1, 0.0, False, False, False, 1]


def control(actor_id: Any, fields: Any = PLAIN) -> list[Any]:
    return [[CONTROL, [actor_id, fields]]]


def transform(actor_id: Any, place: Any = PLACE) -> list[Any]:
    return [[TRANSFORM, [actor_id, place]]]


def control_of(fields: Any) -> VehicleControl:
    """A row of numbers as the control it stands for."""
    *pedals, gear = map(float, fields)
    return VehicleControl(*pedals[:3], *map(bool, pedals[3:]), int(gear))


def one_by_one(members: tuple[Command | Controls | Transforms, ...]) -> list[Command]:
    found: list[Command] = []
    for member in members:
        if isinstance(member, Controls):
            found += [ApplyVehicleControl(int(i), control_of(row)) for i, row in zip(*member, strict=True)]
        elif isinstance(member, Transforms):
            found += [
                ApplyTransform(i, Transform(Vector3D(*place[:3]), Rotation(*place[3:])))
                for i, place in zip(*member, strict=True)
            ]
        else:
            found.append(member)
    return found


def test_controls_in_a_row_become_one_member_and_the_rest_of_the_batch_stays() -> None:
    first, last = [[[DESTROY, [number]]] for number in (1, 2)]
    members = decode_batch([first, *(control(i) for i in range(20)), last])
    assert [type(member) for member in members] == [DestroyActor, Controls, DestroyActor]
    assert isinstance(members[1], Controls)
    assert members[1].actor_ids.tolist() == list(range(20))
    assert members[1].fields.tolist() == [PLAIN] * 20


def test_transforms_in_a_row_become_one_member() -> None:
    members = decode_batch([*(transform(i) for i in range(20)), control(1)])
    assert [type(member) for member in members] == [Transforms, ApplyVehicleControl]
    assert members[0] == Transforms(tuple(range(20)), ((1.0, -2.0, 3.0, 0.0, 90.0, 0.5),) * 20)


@pytest.mark.parametrize(
    "place",
    [[[math.nan, 0.0, 0.0], PLACE[1]], [[1, 0.0, 0.0], PLACE[1]], [{1.0: 0, 2.0: 0, 3.0: 0}, PLACE[1]], [PLACE[0]], 5],
)
def test_an_unusual_transform_is_left_to_the_long_way(place: Any) -> None:
    assert plain_transforms([*(transform(i) for i in range(10)), transform(3, place)]) is None


def test_few_controls_are_decoded_one_by_one() -> None:
    assert len(decode_batch([control(i) for i in range(WORTH_COLUMNS - 1)])) == WORTH_COLUMNS - 1


@pytest.mark.parametrize(
    "unusual",
    [
        pytest.param(control(3, [math.nan, *PLAIN[1:]]), id="a number that is none"),
        pytest.param(control(3, [math.inf, *PLAIN[1:]]), id="an infinite number"),
        pytest.param(control(3, [1e30, *PLAIN[1:]]), id="a large number"),
        pytest.param(control(3, [1, *PLAIN[1:]]), id="an integer for a pedal"),
        pytest.param(control(3, PLAIN[:5]), id="fields left out"),
    ],
)
def test_an_unusual_control_is_decoded_as_if_it_were_alone(unusual: list[Any]) -> None:
    raw = [*(control(i) for i in range(10)), unusual]
    assert plain_controls(raw) is None
    assert decode_batch(raw) == decode_commands(raw)


@pytest.mark.parametrize("wrong", [control(True), control(2**32), control(-1), control(1, [*PLAIN, 1]), control(1, 5)])
def test_what_is_no_control_is_refused_with_its_place_in_the_whole_batch(wrong: list[Any]) -> None:
    raw = [[[DESTROY, [1]]], *(control(i) for i in range(10)), wrong]
    with pytest.raises(WireTypeError) as short:
        decode_batch(raw)
    with pytest.raises(WireTypeError) as long:
        decode_commands(raw)
    assert str(short.value) == str(long.value)
    assert str(short.value).startswith("[11] (ApplyVehicleControl)")


ANYTHING = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 3), st.integers(-(2**40), 2**40), st.floats(), st.text(max_size=2)
)
FIELDS = st.one_of(st.just(PLAIN), st.lists(ANYTHING, max_size=9), ANYTHING)
ITEMS = st.one_of(
    st.builds(control, st.integers(0, 5), st.just(PLAIN)),
    st.builds(control, ANYTHING, FIELDS),
    st.builds(transform, st.integers(0, 5), st.just(PLACE)),
    st.builds(transform, ANYTHING, st.one_of(st.just(PLACE), st.lists(st.lists(ANYTHING, max_size=4), max_size=3))),
    st.builds(lambda number: [[DESTROY, [number]]], st.integers(0, 5)),
    st.lists(st.lists(ANYTHING, max_size=3), max_size=2),
    ANYTHING,
)


def told(decode: Callable[[Any], tuple[Command | Controls | Transforms, ...]], raw: Any) -> str:
    """What a decoder makes of a batch: its commands, or its error."""
    try:
        return repr(one_by_one(decode(raw)))
    except WireTypeError as error:
        return str(error)


ROWS = st.sampled_from([control, transform]).flatmap(
    lambda build: st.lists(st.builds(build, st.integers(0, 9)), max_size=12)
)


@given(ROWS, st.lists(ITEMS, max_size=4))
def test_both_ways_find_the_same_commands_or_the_same_error(usual: list[Any], more: list[Any]) -> None:
    raw = msgpack.unpackb(msgpack.packb([*usual, *more]))
    assert told(decode_batch, raw) == told(decode_commands, raw)
