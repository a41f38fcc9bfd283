"""Claims about decoding: what fits arrives typed, what does not is named with its place."""

import math
from enum import IntEnum
from typing import Annotated, Any, NamedTuple

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.protocol.values.control import VehicleControl, VehiclePhysicsControl
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.protocol.wire.decode import I32, LARGEST_NUMBER, U8, U64, DecodedBy, WireTypeError, decoder
from linden.protocol.wire.rpc import encoder

floats = st.floats(allow_nan=False, allow_infinity=False, width=32)
vectors = st.builds(Vector3D, floats, floats, floats)
controls = st.builds(
    VehicleControl,
    throttle=floats,
    steer=floats,
    brake=floats,
    hand_brake=st.booleans(),
    reverse=st.booleans(),
    manual_gear_shift=st.booleans(),
    gear=st.integers(-1, 8),
)
anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=5)
    | st.binary(max_size=5),
    lambda inner: st.lists(inner, max_size=9),
    max_leaves=30,
)


class Colour(IntEnum):
    RED = 0
    GREEN = 2


class Line(NamedTuple):
    begin: Vector3D
    end: Vector3D


def sent(value: Any) -> Any:
    """What msgpack makes of a value at the other end."""
    return msgpack.unpackb(msgpack.packb(value))


@given(controls, st.builds(Transform, vectors, st.builds(Rotation, floats, floats, floats)))
def test_a_struct_arrives_as_it_was_sent(control: VehicleControl, pose: Transform) -> None:
    for value in (control, pose):
        decoded = decoder(type(value))(sent(value))
        assert decoded == value
        assert type(decoded) is type(value)


@given(anything)
@pytest.mark.parametrize(
    "annotation", [VehicleControl, Transform, EpisodeSettings, VehiclePhysicsControl, tuple[U8, ...], Vector3D | Line]
)
def test_anything_else_is_refused_by_a_sentence_and_nothing_worse(annotation: Any, value: Any) -> None:
    try:
        decoded = decoder(annotation)(value)
    except WireTypeError as error:
        assert "expected" in str(error)  # noqa: PT017 - either outcome is right, any other exception is not
    else:
        assert isinstance(decoded, tuple)


@pytest.mark.parametrize(
    ("annotation", "value", "sentence"),
    [
        (float, "1", "expected a number, got str '1'"),
        (float, True, "expected a number, got bool True"),
        (float, math.nan, "expected a finite number of 32 bits, got nan"),
        (float, None, "expected a number, got nil"),
        (bool, 1, "expected true or false, got int 1"),
        (int, 1.0, "expected an integer, got float 1.0"),
        (int, False, "expected an integer, got bool False"),
        (int, 2**32, f"expected an integer from {-(2**31)} to {2**32 - 1}, got {2**32}"),
        (U8, 256, "expected an integer from 0 to 255, got 256"),
        (I32, 2**31, f"expected an integer from {-(2**31)} to {2**31 - 1}, got {2**31}"),
        (str, b"x", "expected a text, got bytes b'x'"),
        (bytes, "x", "expected raw bytes, got str 'x'"),
        (str, ["x"], "expected a text, got an array of 1"),
        (float | None, None, "expected [false] or [true, value], got nil"),
        (float | None, [False, None], "expected [false] or [true, value], got an array of 2"),
        (float | None, [1, 2.0], "expected [false] or [true, value], got an array of 2"),
        (Colour, 1, "expected one of 0 (RED), 2 (GREEN), got int 1"),
        (tuple[str, int], ["a"], "expected an array of 2, got an array of 1"),
        (tuple[str, int], ["a", "b"], "[1]: expected an integer, got str 'b'"),
        (tuple[float, ...], [1.0, 2, "c"], "[2]: expected a number, got str 'c'"),
        (Vector3D, [1.0, 2.0, math.inf], ".z: expected a finite number of 32 bits, got inf"),
        (Vector3D, "xyz", "expected Vector3D, an array of 3, got str 'xyz'"),
        (Line, [[0, 0, 0]], "expected Line, an array of 2, got an array of 1"),
        (Line, [[0, 0, 0], [0, 0, None]], ".end.z: expected a number, got nil"),
        (Vector3D, [1.0, 2.0, 3.0, 4.0], "expected Vector3D, an array of 3, got an array of 4"),
        (Vector3D | Line, [2, []], "expected an index from 0 to 1, got int 2"),
        (Vector3D | Line, [True, []], "expected an index from 0 to 1, got bool True"),
        (str, "x" * 100 + "y", None),
    ],
)
def test_what_does_not_fit_is_named_with_its_place(annotation: Any, value: Any, sentence: str | None) -> None:
    if sentence is None:
        assert decoder(annotation)(value) == value
        return
    with pytest.raises(WireTypeError) as caught:
        decoder(annotation)(value)
    assert str(caught.value) == sentence


def test_a_long_wrong_value_is_quoted_in_part() -> None:
    with pytest.raises(WireTypeError) as caught:
        decoder(float)("a" * 10_000)
    assert len(str(caught.value)) < 100


def test_integers_are_numbers() -> None:
    location = decoder(Vector3D)([1, 2, 3])
    assert location == Vector3D(1.0, 2.0, 3.0)
    assert all(type(field) is float for field in location)


@pytest.mark.parametrize("numbers", [[1e39, 0.0, 0.0], [0.0, 0.0, -1e308], [10**400, 0, 0], [math.inf, -math.inf, 0.0]])
def test_a_number_beyond_32_bits_is_refused(numbers: list[float]) -> None:
    with pytest.raises(WireTypeError, match="expected a finite number of 32 bits"):
        decoder(Vector3D)(numbers)


def test_the_largest_numbers_are_numbers() -> None:
    assert decoder(Vector3D)([LARGEST_NUMBER] * 3) == Vector3D(*[LARGEST_NUMBER] * 3)


def test_a_gear_beyond_32_bits_is_refused_among_plain_numbers() -> None:
    with pytest.raises(WireTypeError, match=r"\.gear: expected an integer from"):
        decoder(VehicleControl)([0.0, 0.0, 0.0, False, False, False, 2**40])


def test_trailing_fields_with_defaults_may_be_left_out() -> None:
    three = decoder(BoundingBox)([[0.0, 0.0, 1.0], [2.0, 1.0, 1.0], [0.0, 0.0, 0.0]])
    assert three == BoundingBox(Vector3D(0, 0, 1), Vector3D(2, 1, 1), Rotation(), 0)


def test_a_variant_is_chosen_by_its_index() -> None:
    assert decoder(Line | Vector3D)([1, [1.0, 2.0, 3.0]]) == Vector3D(1.0, 2.0, 3.0)


def test_object_ids_have_64_bits() -> None:
    assert decoder(U64)(2**64 - 1) == 2**64 - 1


def test_a_type_may_bring_its_own_decoder() -> None:
    assert decoder(Annotated[str, DecodedBy(lambda raw: f"<{raw}>")])(3) == "<3>"


def test_a_type_without_a_way_over_the_wire_is_found_at_start() -> None:
    with pytest.raises(TypeError, match="no way to read"):
        decoder(dict[str, int])
    with pytest.raises(TypeError, match="no way to write"):
        encoder(Vector3D | Line | None)


@given(st.none() | st.floats(0.001, 1.0), st.booleans())
def test_what_is_encoded_is_decoded_again(fixed_delta_s: float | None, synchronous: bool) -> None:  # noqa: FBT001
    settings = EpisodeSettings(synchronous_mode=synchronous, fixed_delta_seconds=fixed_delta_s)
    for annotation, value in (
        (EpisodeSettings, settings),
        (tuple[EpisodeSettings, ...], (settings, settings)),
        (tuple[str, EpisodeSettings], ("a", settings)),
        (EpisodeSettings | None, settings),
        (EpisodeSettings | None, None),
        (Annotated[float | None, "s"], fixed_delta_s),
    ):
        encode = encoder(annotation)
        assert encode is not None
        assert decoder(annotation)(sent(encode(value))) == value


def test_what_packs_as_it_lies_needs_no_encoder() -> None:
    assert encoder(Transform) is None
    assert encoder(tuple[Transform, ...]) is None
    assert encoder(tuple[str, int]) is None
