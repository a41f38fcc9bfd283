"""Stop lines, crosswalks and yield lines keep within the outlines that the map gives."""

import numpy as np
import pytest

from linden.maps.facts import derive
from linden.maps.opendrive.limits import MOST_BARS
from linden.maps.opendrive.parse import parse
from linden.scenery.mesh import Material, Mesh
from linden.scenery.streets.markings import PAINT_HEIGHT_M
from linden.scenery.streets.road_paint import across_lanes
from opendrive_texts import street_through_junction


def painted(name: str, kind: str, corners: list[tuple[float, float]], t: float = 0.0) -> Mesh:
    outline = "".join(f'<cornerLocal u="{u}" v="{v}" z="0" height="0"/>' for u, v in corners)
    text = street_through_junction(
        objects=f'<object id="1" name="{name}" type="{kind}" s="30" t="{t}" zOffset="0" hdg="0" orientation="none">'
        f"<outline>{outline}</outline></object>"
    )
    return across_lanes(parse(text), derive(text))


def area_m2(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices_m[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return float(0.5 * np.cross(b - a, c - a)[:, 2].sum())


def test_a_stop_line_is_its_outline() -> None:
    mesh = painted("StopLine", "roadMark", [(-0.2, -1.5), (0.2, -1.5), (0.2, 1.5), (-0.2, 1.5), (-0.2, -1.5)], t=-1.75)
    assert area_m2(mesh) == pytest.approx(0.4 * 3.0, rel=1e-4)
    np.testing.assert_allclose(mesh.vertices_m.min(axis=0), [29.8, 0.25, PAINT_HEIGHT_M], atol=1e-4)
    np.testing.assert_allclose(mesh.vertices_m.max(axis=0), [30.2, 3.25, PAINT_HEIGHT_M], atol=1e-4)


def test_a_crosswalk_is_bars_that_lie_the_way_the_cars_go() -> None:
    mesh = painted("Crosswalk", "crosswalk", [(-1.5, -3.5), (1.5, -3.5), (1.5, 3.5), (-1.5, 3.5)])
    bars = mesh.vertices_m.reshape(-1, 4, 3)
    np.testing.assert_allclose(np.ptp(bars[..., 0], axis=1), 3.0, atol=1e-4)
    np.testing.assert_allclose(np.ptp(bars[..., 1], axis=1), 0.6, atol=1e-4)
    assert len(bars) == 6
    assert np.abs(bars[..., 1]).max() <= 3.5


def test_the_teeth_of_a_yield_line_point_at_oncoming_traffic() -> None:
    mesh = painted("YieldLine", "roadMark", [(-0.2, -1.5), (0.2, -1.5), (0.2, 1.5), (-0.2, 1.5)], t=-1.75)
    teeth = mesh.vertices_m.reshape(-1, 3, 3)
    eastward = teeth[..., 0]  # traffic of lane -1 comes from the west
    np.testing.assert_allclose(np.sort(eastward, axis=1), [[29.8, 30.2, 30.2]] * len(teeth), atol=1e-3)
    assert len(teeth) >= 4


def test_an_island_is_grass_within_a_kerb() -> None:
    mesh = painted("Island", "trafficIsland", [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    assert {Material.GRASS, Material.CONCRETE} == {Material(kind) for kind in mesh.faces["material"]}
    assert mesh.vertices_m[:, 2].max() == pytest.approx(0.15, abs=1e-3)


def test_a_crosswalk_that_reaches_over_the_kerb_does_not_climb_it() -> None:
    mesh = painted("Crosswalk", "crosswalk", [(-1.5, -3.9), (1.5, -3.9), (1.5, 3.9), (-1.5, 3.9)])
    assert np.abs(mesh.vertices_m[:, 1]).max() > 3.6  # the pavement, 0.15 m high, begins at 3.5
    np.testing.assert_allclose(mesh.vertices_m[:, 2], PAINT_HEIGHT_M, atol=1e-4)


def test_no_paint_lies_on_a_pavement() -> None:
    outline = [(-1.5, 3.7), (1.5, 3.7), (1.5, 4.9), (-1.5, 4.9)]
    assert len(painted("Crosswalk", "crosswalk", outline).triangles) == 0


@pytest.mark.parametrize(("name", "kind"), [("Crosswalk", "crosswalk"), ("YieldLine", "roadMark")])
def test_paint_of_any_length_has_a_number_of_pieces_that_fits_into_memory(name: str, kind: str) -> None:
    far = [(-1.5, -9e3), (1.5, -9e3), (1.5, 9e3), (-1.5, 9e3)]
    assert len(painted(name, kind, far).triangles) <= 2 * MOST_BARS
