"""Claims about pictures of lines and areas: where they lie, how wide they are, what covers what, and the near plane."""

import numpy as np
import pytest

from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.camera.strokes import NEAR_M, Strokes, draw, joined

SPEC = CameraSpec(width_px=200, height_px=100, fov_deg=90.0)  # 100 px from the eye
EYE = Transform(Vector3D(0.0, 0.0, 1.0), Rotation())
RED, GREEN = (255, 0, 0), (0, 255, 0)


def line(start: tuple[float, ...], end: tuple[float, ...], width_m: float, colour: tuple[int, ...] = RED) -> Strokes:
    return Strokes.none()._replace(
        start_m=np.array([start]),
        end_m=np.array([end]),
        width_m=np.array([width_m]),
        line_colour=np.array([colour], np.uint8),
    )


def area(*corners: tuple[float, ...], colour: tuple[int, ...] = GREEN) -> Strokes:
    return Strokes.none()._replace(corners_m=np.array([corners], float), area_colour=np.array([colour], np.uint8))


def test_nothing_is_black_and_opaque() -> None:
    image = draw(SPEC, EYE, Strokes.none())
    assert image.shape == (100, 200, 4)
    assert not image[:, :, :3].any()
    assert (image[:, :, 3] == 255).all()


def test_an_upright_line_lies_where_the_pinhole_puts_it_and_is_as_wide_as_its_metres() -> None:
    image = draw(SPEC, EYE, line((10.0, 2.0, 0.0), (10.0, 2.0, 2.0), 1.0))
    rows, columns = np.nonzero(image[:, :, 2])
    assert columns.mean() + 0.5 == pytest.approx(100.0 + 100.0 * 2.0 / 10.0, abs=0.5)
    assert np.count_nonzero(image[50, :, 2]) == 10  # 1 m at 10 m
    assert (rows.min(), rows.max()) == (35, 64)  # 1 m above and below the eye, and round ends of half a metre
    assert not image[:, :, :2].any()  # red is the third byte


def test_a_thin_line_far_away_is_still_a_pixel_wide() -> None:
    image = draw(SPEC, EYE, line((500.0, 0.0, 0.0), (500.0, 0.0, 20.0), 0.1))
    assert image[49, :, 2].any()


def test_what_is_nearer_covers_what_is_farther_in_whatever_order() -> None:
    far = area((20.0, -50.0, -50.0), (20.0, 50.0, -50.0), (20.0, 0.0, 50.0))
    near = line((5.0, -1.0, 1.0), (5.0, 1.0, 1.0), 0.5)
    for parts in ([far, near], [near, far]):
        assert tuple(draw(SPEC, EYE, joined(parts))[50, 100, :3]) == (0, 0, 255)
    behind = line((40.0, -1.0, 1.0), (40.0, 1.0, 1.0), 2.0)
    assert tuple(draw(SPEC, EYE, joined([far, behind]))[50, 100, :3]) == (0, 255, 0)


def test_a_line_and_an_area_that_begin_behind_the_eye_are_cut_at_the_near_plane() -> None:
    floor = area((-10.0, -3.0, 0.0), (30.0, -3.0, 0.0), (30.0, 3.0, 0.0))
    image = draw(SPEC, EYE, joined([floor, line((-5.0, 1.0, 0.5), (20.0, 1.0, 0.5), 0.2)]))
    assert image[90, :, 1].any()
    assert image[70:, :, 2].any()
    assert not image[:49].any(axis=2)[:, :].sum() - 49 * 200  # above the horizon there is alpha alone


def test_what_lies_wholly_behind_is_not_drawn() -> None:
    behind = joined([line((-5.0, 0.0, 1.0), (NEAR_M / 2, 0.0, 1.0), 1.0), area((-1, 0, 0), (-2, 1, 0), (-2, -1, 0))])
    assert not draw(SPEC, EYE, behind)[:, :, :3].any()


def test_a_turned_camera_looks_there() -> None:
    to_the_south = Transform(Vector3D(0.0, 0.0, 1.0), Rotation(yaw=90.0))
    image = draw(SPEC, to_the_south, line((0.0, 10.0, 0.0), (0.0, 10.0, 2.0), 1.0))
    assert image[50, 100, 2] == 255
