"""Pictures as bytes."""

import struct

import numpy as np
import pytest

from linden.errors import ProtocolError
from linden.protocol.wire.measurements import events_payload, image_payload


def test_a_picture_is_its_size_its_field_of_view_and_its_pixels_row_by_row() -> None:
    pixels = np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
    assert b"".join(image_payload(pixels, 90.0)) == struct.pack("<IIf", 3, 2, 90.0) + bytes(range(24))


def test_a_flow_is_two_floats_a_pixel() -> None:
    packed = b"".join(image_payload(np.ones((1, 1, 2), np.float32), 45.0))
    assert packed == struct.pack("<IIfff", 1, 1, 45.0, 1.0, 1.0)


@pytest.mark.parametrize("pixels", [np.zeros((2, 3), np.uint8), np.zeros((2, 3, 3), np.uint8), np.zeros((2, 3, 2))])
def test_pixels_of_another_form_do_not_go_out(pixels: np.ndarray) -> None:
    with pytest.raises(ProtocolError, match="4 bytes or 2 floats a pixel"):
        image_payload(pixels, 90.0)


def test_events_lie_one_after_the_other() -> None:
    events = np.zeros(2, [("x", "<u2"), ("y", "<u2"), ("t", "<i8"), ("polarity", "?")])
    assert len(b"".join(events_payload(events, 8, 6, 90.0))) == 12 + 2 * 13
