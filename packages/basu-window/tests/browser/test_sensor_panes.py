"""Claims about the agent's own sensors in the page: pictures, points and readings."""

import json
import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from basu_window.browser.sensor_panes import picture, readings
from linden_window import panes
from linden_window.measured import MOST_WIDE_PX, tag_colours


def image(bgra: list[tuple[int, int, int, int]], width: int | None = None) -> Any:
    """Return a camera's picture, of one row unless a width is given."""
    width = width or len(bgra)
    raw = bytes(value for pixel in bgra for value in pixel)
    return SimpleNamespace(raw_data=raw, width=width, height=len(bgra) // width)


def unpacked(pane: bytes) -> tuple[dict[str, Any], bytes]:
    magic, length = panes.HEADER.unpack_from(pane)
    assert (magic, length % 4) == (panes.MAGIC, 0)
    return json.loads(pane[8 : 8 + length]), pane[8 + length :]


def test_colours_stay_and_depth_becomes_logarithmic_grey() -> None:
    seen = image([(1, 2, 3, 255), (4, 5, 6, 255)])
    assert picture(seen, "sensor.camera.rgb").tolist() == [[[3, 2, 1], [6, 5, 4]]]
    ends = [round(0xFFFFFF * depth_m / 1000.0) for depth_m in (1.0, math.sqrt(1000.0), 1000.0)]
    coded = [(code >> 16, code >> 8 & 255, code & 255, 255) for code in ends]  # blue holds the highest part
    grey = picture(image(coded), "sensor.camera.depth")[0, :, 0].astype(int)
    assert np.abs(grey - [0, 127, 255]).max() <= 1


def test_tags_are_shown_as_colours() -> None:
    shown = picture(image([(0, 0, 7, 255), (0, 0, 0, 255)]), "sensor.camera.semantic_segmentation")
    assert shown[0, 0].tolist() == tag_colours(np.array([7]))[0].tolist()
    assert shown[0, 1].tolist() == [0, 0, 0]


def test_a_wide_picture_is_thinned_and_keeps_its_shape() -> None:
    wide = image([(0, 0, 0, 255)] * (4 * MOST_WIDE_PX * 4), 4 * MOST_WIDE_PX)
    assert picture(wide, "sensor.camera.rgb").shape == (1, MOST_WIDE_PX, 3)


def test_every_tag_has_a_colour_of_its_own() -> None:
    colours = {tuple(colour) for colour in tag_colours(np.arange(29)).tolist()}
    assert len(colours) == 29
    assert (0, 0, 0) in colours


def test_points_are_packed_in_centimetres_with_their_colours() -> None:
    places_m = np.array([[6.0, -0.25], [400.0, 0.0]])
    head, content = unpacked(panes.points("TOP", 7, places_m, np.array([[255, 0, 0], [0, 255, 0]], dtype=np.uint8)))
    rows = np.frombuffer(content, panes.POINT)
    assert (head["kind"], head["name"], head["frame"], head["count"]) == ("points", "TOP", 7, 2)
    assert rows["place"].tolist() == [[600, -25], [32767, 0]]
    assert rows["colour"].tolist() == [[255, 0, 0], [0, 255, 0]]


def test_a_picture_is_packed_with_its_size_and_readings_with_their_words() -> None:
    head, content = unpacked(panes.picture("FRONT", 3, np.arange(18, dtype=np.uint8).reshape(2, 3, 3)))
    assert (head["width"], head["height"], content) == (3, 2, bytes(range(18)))
    head, content = unpacked(panes.lines("GPS", 3, [("Latitude", "40° N")]))
    assert (head["lines"], content) == ([{"name": "Latitude", "value": "40° N"}], b"")


def test_what_is_unknown_is_called_by_its_type() -> None:
    assert readings(SimpleNamespace(), 3.0) == [("Measured", "float")]  # type: ignore[arg-type]
