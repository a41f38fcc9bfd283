import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from linden.replay.file.layouts import from_file, to_file

LOCATIONS = arrays(np.float32, (5, 3), elements=st.floats(-1e7, 1e7, width=32, allow_subnormal=False))


@given(LOCATIONS)
def test_metres_come_back_bit_by_bit(location_m: np.ndarray) -> None:
    location_cm, ulps = to_file(location_m)
    assert from_file(location_cm, ulps).tobytes() == location_m.tobytes()


@given(LOCATIONS)
def test_centimetres_alone_are_as_good_as_carlas(location_m: np.ndarray) -> None:
    location_cm, ulps = to_file(location_m)
    np.testing.assert_allclose(from_file(location_cm, None), location_m, rtol=2e-7, atol=1e-36)
    assert np.abs(ulps).max() <= 2


def test_centimetres_alone_lose_bits_so_that_the_correction_is_needed() -> None:
    location_m = np.linspace(100.0, 200.0, 3000, dtype=np.float32).reshape(-1, 3)
    location_cm, ulps = to_file(location_m)
    assert np.any(ulps != 0)
    assert np.any(from_file(location_cm, None) != location_m)
