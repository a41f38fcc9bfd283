"""Claims about the parts of a map: groups, tiles, frame, normals, materials."""

import numpy as np

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, faces
from linden.scenery.patches import PatchLook, polygons
from linden.scenery.scene.objects import BOX, THING, Scene
from linden_maps.unreal.parts import MOST_COLOURS, Part, parts_of


def test_each_group_and_tile_is_one_part(parts: list[Part]) -> None:
    assert [part.name for part in parts] == [
        "Town_Building_0_m1",
        "Town_Road_Curb_0_m1",
        "Town_Road_Marking_0_m1",
        "Town_Road_Road_0_m1",
        "Town_Road_Road_0_1",
        "Town_Road_Sidewalk_0_m1",
    ]


def test_what_carla_places_itself_is_left_out(parts: list[Part]) -> None:
    assert not any("Sign" in part.name or part.group == "Static" for part in parts)


def test_the_frame_is_that_of_the_opendrive_file(parts: list[Part]) -> None:
    road = next(part for part in parts if part.name == "Town_Road_Road_0_1")
    assert road.vertices_m.min(axis=0).tolist() == [0.0, 590.0, 1.0]
    assert road.vertices_m.max(axis=0).tolist() == [10.0, 600.0, 1.0]


def test_normals_point_out_of_the_ground_and_out_of_walls(parts: list[Part]) -> None:
    road = next(part for part in parts if part.group == "Road_Road")
    np.testing.assert_allclose(road.normals, [(0.0, 0.0, 1.0)] * 2, atol=1e-9)
    house = next(part for part in parts if part.group == "Building")
    middles = house.vertices_m[house.triangles].mean(axis=1)
    outwards = middles - (20.0, -30.0, 3.0)
    assert (np.einsum("ij,ij->i", outwards, house.normals) > 0.0).all()


def test_texture_coordinates_are_metres_along_the_surface(parts: list[Part]) -> None:
    for part in parts:
        sides = part.vertices_m[part.triangles] - np.roll(part.vertices_m[part.triangles], 1, axis=1)
        texture = part.uv_m - np.roll(part.uv_m, 1, axis=1)
        np.testing.assert_allclose(np.linalg.norm(texture, axis=2), np.linalg.norm(sides, axis=2), atol=1e-6)


def test_rare_colours_become_the_nearest_frequent_one() -> None:
    corners = np.array([[(i, 0.0, 0.0), (i + 0.5, 0.0, 0.0), (i, 0.5, 0.0)] for i in range(40)])
    shades = np.array([(10 * (i % 20), 0, 0) for i in range(40)])
    mesh = polygons(corners, PatchLook(Material.SIDING, SemanticTag.BUILDINGS, shades))
    (part,) = parts_of(mesh, Scene(np.zeros(0, THING), np.zeros(0, BOX)), "Town")
    assert len(part.surfaces) == MOST_COLOURS
    kept = np.array([surface.colour[0] for surface in part.surfaces])
    reds = part.vertices_m[part.triangles][:, :, 0].min(axis=1).round().astype(int) % 20 * 10
    chosen = kept[part.surface]
    assert (np.abs(chosen - reds) == np.abs(kept[None, :] - reds[:, None]).min(axis=1)).all()


def test_an_empty_mesh_has_no_parts() -> None:
    nothing = polygons(np.zeros((0, 3, 3)), PatchLook(Material.PLAIN, SemanticTag.ROADS, (0, 0, 0)))
    assert (
        parts_of(
            nothing._replace(faces=faces(0, Material.PLAIN, 1, (0, 0, 0))),
            Scene(np.zeros(0, THING), np.zeros(0, BOX)),
            "T",
        )
        == []
    )
