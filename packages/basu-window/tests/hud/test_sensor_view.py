"""Claims about the agent's own sensors in the window: which one is shown, and as what."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pygame
import pytest

from basu_window.hud.canvas import Canvas
from basu_window.hud.sensor_view import SensorView, _draw_points, picture, readings, tag_colours

TYPES = {"FRONT": "sensor.camera.rgb", "TOP": "sensor.lidar.ray_cast", "GPS": "sensor.other.gnss"}


@pytest.fixture
def canvas(monkeypatch: pytest.MonkeyPatch) -> Canvas:
    """A window without a display."""
    pygame.display.quit()
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    return Canvas((640, 400), "test")


def image(bgra: list[tuple[int, int, int, int]]) -> Any:
    """A camera's picture of one row."""
    return SimpleNamespace(raw_data=bytes(value for pixel in bgra for value in pixel), width=len(bgra), height=1)


def test_the_sensors_come_one_after_the_other_and_then_none() -> None:
    view = SensorView(SimpleNamespace())  # type: ignore[arg-type]
    shown = []
    for _ in range(5):
        view.step(TYPES)
        shown.append(view.shown)
    assert shown == ["FRONT", "TOP", "GPS", None, "FRONT"]


def test_an_agent_without_sensors_shows_none() -> None:
    view = SensorView(SimpleNamespace())  # type: ignore[arg-type]
    view.step({})
    assert view.shown is None


def test_colours_stay_and_depth_becomes_logarithmic_grey() -> None:
    seen = image([(1, 2, 3, 255)])
    assert picture(seen, "sensor.camera.rgb") == seen.raw_data
    ends = [round(0xFFFFFF * depth_m / 1000.0) for depth_m in (1.0, math.sqrt(1000.0), 1000.0)]
    coded = [(code >> 16, code >> 8 & 255, code & 255, 255) for code in ends]  # blue holds the highest part
    grey = np.frombuffer(picture(image(coded), "sensor.camera.depth"), np.uint8).reshape(-1, 4)[:, 0]
    assert grey.tolist() == pytest.approx([0, 127, 255], abs=1)


def test_every_tag_has_a_colour_of_its_own() -> None:
    colours = {tuple(colour) for colour in tag_colours(np.arange(29)).tolist()}
    assert len(colours) == 29
    assert (0, 0, 0) in colours


def test_points_ahead_are_up_and_points_to_the_right_are_right(canvas: Canvas) -> None:
    canvas.fill((0, 0, 0))
    red, green = (255, 0, 0), (0, 255, 0)
    _draw_points(canvas, 240.0, (np.array([[6.0, 0.0], [0.0, 6.0]]), np.array([red, green], dtype=np.uint8)))
    pixels = pygame.surfarray.array3d(pygame.display.get_surface())
    middle_x, middle_y = 440, 200
    up_x, up_y = np.argwhere((pixels == red).all(axis=2))[0]
    right_x, right_y = np.argwhere((pixels == green).all(axis=2))[-1]
    assert abs(up_x - middle_x) <= 1
    assert up_y < middle_y - 50
    assert right_x > middle_x + 50
    assert abs(right_y - middle_y) <= 1


def test_points_outside_of_the_window_or_under_the_panel_are_left_out(canvas: Canvas) -> None:
    canvas.fill((0, 0, 0))
    places = np.array([[-5.0, 10.0], [100.0, 100.0], [300.0, 100.0], [639.0, 399.0], [9e3, 9e3]])
    canvas.points(places, np.full((5, 3), 255, dtype=np.uint8), 240.0)
    lit = np.argwhere(pygame.surfarray.array3d(pygame.display.get_surface()).any(axis=2))
    assert lit.tolist() == [[300, 100], [300, 101], [301, 100], [301, 101]]


def test_a_picture_keeps_its_shape_right_of_the_panel(canvas: Canvas) -> None:
    canvas.fill((0, 0, 0))
    canvas.picture(bytes([255] * 4 * 100), (10, 10), 240.0)
    lit = np.argwhere(pygame.surfarray.array3d(pygame.display.get_surface()).any(axis=2))
    assert (lit.max(axis=0) - lit.min(axis=0) + 1).tolist() == [400, 400]
    assert lit.min(axis=0).tolist() == [240, 0]


def test_what_is_unknown_is_called_by_its_type() -> None:
    assert readings(SimpleNamespace(), 3.0) == [("Measured", "float")]  # type: ignore[arg-type]
