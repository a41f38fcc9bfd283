"""The file as Detour reads it, checked with a second reader."""

import numpy as np
import pytest

from linden.maps.navigation.detour import BORDER, EAST, WEST, Area, Polygon, Tile, WalkingMesh, write
from naive.walking_mesh import read

WINDING = ((0, 0), (0, 1), (1, 1), (1, 0))


def square(column: int, neighbours: tuple[int, ...], area: Area = Area.SIDEWALK) -> Tile:
    corners = np.array([(10.0 * column + 10.0 * x, 10.0 * y, 0.5) for x, y in WINDING])
    return Tile(column, 0, corners, (Polygon(area, (0, 1, 2, 3), neighbours),))


MESH = WalkingMesh(
    (0.0, 0.0),
    10.0,
    (square(0, (BORDER, BORDER, EAST, BORDER)), square(1, (WEST, BORDER, BORDER, BORDER), Area.CROSSWALK)),
)


def test_a_mesh_is_read_back_as_it_was_written() -> None:
    mesh = read(write(MESH))
    assert (mesh.origin, mesh.tile_m, mesh.most_tiles, mesh.most_polygons) == ((0.0, 0.0), 10.0, 2, 2)
    assert [(tile.column, tile.row) for tile in mesh.tiles] == [(0, 0), (1, 0)]
    np.testing.assert_allclose(mesh.tiles[1].vertices, MESH.tiles[1].vertices_m)
    assert mesh.tiles[0].polygons == [(1, [0, 1, 2, 3], [0, 0, 0x8000, 0], 0x02)]
    assert mesh.tiles[1].polygons == [(2, [0, 1, 2, 3], [0x8004, 0, 0, 0], 0x04)]


def test_a_tiles_reference_holds_salt_and_number() -> None:
    assert read(write(MESH)).references == [0b100, 0b110]


def test_the_triangles_of_a_polygon_cover_it_and_tell_its_outer_sides() -> None:
    (triangles,) = read(write(MESH)).tiles[0].triangles_of
    assert [triangle[:3] for triangle in triangles] == [(0, 1, 2), (0, 2, 3)]
    assert [triangle[3] for triangle in triangles] == [0b000101, 0b010100]


def test_links_have_room_for_every_side() -> None:
    data = write(MESH)
    assert int.from_bytes(data[48 + 32 : 48 + 36], "little") >= 4 + 2


def test_too_large_a_mesh_is_refused() -> None:
    many = tuple(square(n, (BORDER,) * 4) for n in range(3))
    crowded = many[0]._replace(polygons=many[0].polygons * (1 << 21))
    with pytest.raises(ValueError, match="too many for one mesh"):
        write(WalkingMesh((0.0, 0.0), 10.0, (*many, crowded)))
