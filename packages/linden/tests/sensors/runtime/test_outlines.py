"""Claims about what the camera of lines draws of Linden: lanes, kerbs, crosswalks, boxes of actors by their kind."""

from pathlib import Path

import numpy as np
import pytest

import linden
from linden.maps.facts import derive
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import BoundingBox, Rotation, Vector3D
from linden.sensors.camera.strokes import Strokes
from linden.sensors.runtime import outlines


@pytest.fixture(scope="module")
def town() -> Strokes:
    text = (Path(linden.__file__).parent / "data" / "Linden.xodr").read_text(encoding="utf-8")
    return outlines.map_strokes(text, derive(text).ground)


def length_m(strokes: Strokes, colour: tuple[int, int, int]) -> float:
    rows = (strokes.line_colour == colour).all(axis=1)
    return float(np.linalg.norm((strokes.end_m - strokes.start_m)[rows], axis=1).sum())


def test_a_town_has_lane_lines_kerbs_and_crosswalks(town: Strokes) -> None:
    assert 10_000 < length_m(town, outlines.LANE_LINE) < length_m(town, outlines.BOUNDARY)
    assert (town.area_colour == outlines.CROSSWALK).all(axis=1).any()
    assert set(map(tuple, town.line_colour.tolist())) == {outlines.LANE_LINE, outlines.BOUNDARY}
    assert np.isfinite(town.corners_m).all()
    assert np.linalg.norm(town.end_m - town.start_m, axis=1).max() < 30.0  # no line leaps from lane to lane


@pytest.mark.parametrize(
    ("tag", "colour", "lines", "triangles"),
    [
        (SemanticTag.CAR, outlines.CAR, 12, 0),
        (SemanticTag.BICYCLE, outlines.CAR, 12, 0),
        (SemanticTag.PEDESTRIANS, outlines.PEDESTRIAN, 12, 0),
        (SemanticTag.TRAFFIC_SIGNS, outlines.SIGN, 0, 12),
        (SemanticTag.TRAFFIC_LIGHT, outlines.LIGHT, 0, 12),
        (SemanticTag.BUILDINGS, None, 0, 0),
    ],
)
def test_boxes_are_drawn_by_their_tag(
    tag: SemanticTag, colour: tuple[int, int, int] | None, lines: int, triangles: int
) -> None:
    box = BoundingBox(Vector3D(1.0, 2.0, 3.0), Vector3D(2.0, 1.0, 0.5), Rotation(yaw=90.0))
    strokes = outlines._of_box(tag, box)
    assert (len(strokes.start_m), len(strokes.corners_m)) == (lines, triangles)
    if lines:
        spread = np.ptp(np.concatenate([strokes.start_m, strokes.end_m]), axis=0)
        assert spread == pytest.approx([2.0, 4.0, 1.0])
        assert (strokes.line_colour == colour).all()
    if triangles:
        sides = strokes.corners_m
        areas = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1) / 2.0
        assert areas.sum() == pytest.approx(2.0 * (4.0 * 2.0 + 4.0 * 1.0 + 2.0 * 1.0))


def test_an_upright_pole_is_a_line_and_an_arm_is_not() -> None:
    upright = BoundingBox(Vector3D(0.0, 0.0, 2.0), Vector3D(0.1, 0.1, 2.0))
    strokes = outlines._of_box(SemanticTag.POLES, upright)
    assert strokes.end_m[0] - strokes.start_m[0] == pytest.approx([0.0, 0.0, 4.0])
    arm = BoundingBox(Vector3D(0.0, 0.0, 5.0), Vector3D(2.0, 0.1, 0.1))
    assert len(outlines._of_box(SemanticTag.POLES, arm).start_m) == 0
