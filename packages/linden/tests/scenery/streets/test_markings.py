"""Painted lines lie where the map's road marks say, to the millimetre."""

import numpy as np
import pytest

from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh
from linden.scenery.streets.markings import COLOURS, PAINT_HEIGHT_M, WHITE, lines
from linden.scenery.streets.simplified_lanes import simplified_lanes
from opendrive_texts import lane, line, opendrive, road, street_through_junction

STRIPE_M, GAP_M = 3.05, 9.14


def of_marks(marks: str, shape: str = "<line/>", length: float = 30.0, elevation: str = "") -> Mesh:
    """Return the paint of a road whose middle has these marks and whose lanes have none."""
    bare = lane(-1).replace('type="broken"', 'type="none"')
    centre = f'<center><lane id="0" type="none">{marks}</lane></center>'
    section = f'<laneSection s="0">{centre}<right>{bare}</right></laneSection>'
    return lines(
        simplified_lanes(
            parse(opendrive(road(1, length, line(0, 0, 0, 0, length, shape), section, elevation=elevation)))
        )
    )


def mark(kind: str, width: float = 0.1, colour: str = "white", offset: float = 0.0) -> str:
    return f'<roadMark sOffset="{offset}" type="{kind}" weight="standard" color="{colour}" width="{width}"/>'


def areas_m2(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.vertices_m[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return 0.5 * np.cross(b - a, c - a)[:, 2]


def test_every_stripe_of_a_broken_line_begins_and_ends_where_the_manual_says() -> None:
    mesh = lines(simplified_lanes(parse(street_through_junction())))
    outer = mesh.vertices_m[np.abs(mesh.vertices_m[:, 1] - 3.5) < 0.1]  # right edge of lane -1, south
    on_first = outer[outer[:, 0] < 50.0]
    starts = np.arange(0.0, 50.0, STRIPE_M + GAP_M)
    ends = np.minimum(starts + STRIPE_M, 50.0)
    assert np.unique(np.round(on_first[:, 1], 4)).tolist() == pytest.approx([3.44, 3.56])
    places = np.unique(np.round(on_first[:, 0].astype(np.float64), 4))
    assert places[places < 50.0 - 1e-3] == pytest.approx(np.union1d(starts, ends)[:-1], abs=1e-3)


def test_paint_lies_on_the_road_and_looks_up() -> None:
    mesh = of_marks(mark("solid"), elevation='<elevation s="0" a="5" b="0.1" c="0" d="0"/>')
    np.testing.assert_allclose(mesh.vertices_m[:, 2], 5.0 + 0.1 * mesh.vertices_m[:, 0] + PAINT_HEIGHT_M, atol=1e-5)
    assert (areas_m2(mesh) > 0.0).all()
    assert set(mesh.faces["tag"].tolist()) == {SemanticTag.ROAD_LINES}
    assert set(mesh.faces["material"].tolist()) == {Material.PAINT}


def test_a_double_line_is_two_lines_as_far_apart_as_they_are_wide() -> None:
    mesh = of_marks(mark("solid solid", 0.1, "yellow"))
    assert np.unique(np.round(mesh.vertices_m[:, 1], 4)).tolist() == pytest.approx([-0.15, -0.05, 0.05, 0.15])
    assert areas_m2(mesh).sum() == pytest.approx(2 * 30.0 * 0.1, rel=1e-5)
    assert mesh.faces["colour"][0].tolist() == list(COLOURS["yellow"])


def test_the_first_of_two_unlike_lines_of_the_middle_lies_on_the_left() -> None:
    mesh = of_marks(mark("solid broken", 0.1))
    left, right = (mesh.vertices_m[np.sign(mesh.vertices_m[:, 1]) == side] for side in (-1.0, 1.0))  # y points south
    a = areas_m2(mesh)[np.sign(mesh.vertices_m[mesh.triangles[:, 0], 1]) == -1.0].sum()
    assert a == pytest.approx(30.0 * 0.1, rel=1e-5)
    assert np.ptp(left[:, 0]) == pytest.approx(30.0)
    assert len(np.unique(right[:, 0])) > 4


def test_a_mark_holds_until_the_next_one_begins() -> None:
    mesh = of_marks(mark("solid") + mark("none", offset=12.0) + mark("solid", colour="red", offset=20.0))
    red = (mesh.faces["colour"] == COLOURS["red"]).all(axis=1)
    white = (mesh.faces["colour"] == WHITE).all(axis=1)
    assert mesh.vertices_m[mesh.triangles[white]][..., 0].max() == pytest.approx(12.0)
    assert mesh.vertices_m[mesh.triangles[red]][..., 0].min() == pytest.approx(20.0)


def test_round_a_bend_paint_keeps_to_the_arc_within_the_chords_of_the_surface() -> None:
    mesh = of_marks(mark("solid"), '<arc curvature="0.05"/>')
    radius = np.hypot(mesh.vertices_m[:, 0], mesh.vertices_m[:, 1] + 20.0)  # its centre lies 20 m to the left, north
    np.testing.assert_allclose(np.abs(radius - 20.0), 0.05, atol=1e-4)


@pytest.mark.parametrize("kind", ["none", "curb", "grass"])
def test_what_is_no_paint_is_not_painted(kind: str) -> None:
    assert len(of_marks(mark(kind)).triangles) == 0
