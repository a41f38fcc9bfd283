"""What stands is seen where it is met: every box of the scene has its triangles, and they lie in it."""

import os
from dataclasses import replace

import numpy as np
import pytest

from home_map import home_map
from linden.maps.cache import MapCache
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import SemanticTag
from linden.scenery.map_mesh import standing, things
from linden.scenery.map_mesh_cache import keep_standing, standing_of
from linden.scenery.mesh import NO_OBJECT, LampOf, Material, Mesh, join
from linden.scenery.scene.objects import ObjectKind, Scene
from linden.scenery.scene.south_linden import home
from linden.scenery.streets.junction_floors import floors
from linden.scenery.streets.road import kerbs, surface
from linden.scenery.streets.simplified_lanes import simplified_lanes
from linden.scenery.streets.terrain import land
from linden.sensors.casting.caster import Rays
from linden.sensors.casting.choose import caster_of
from linden.simulation.surroundings import scenery_of
from opendrive_texts import signal, street_through_junction

STREET = street_through_junction(signals=signal("7", 30.0, -5.0, "1000001") + signal("8", 10.0, -5.0, "206"))
HIGH_M = 1e6
OVERHANG_M = {
    ObjectKind.HOUSE: 1.6,
    ObjectKind.TREE: 12.0,
    ObjectKind.STREET_LAMP: 0.5,
    ObjectKind.UTILITY_POLE: 1.2,
    ObjectKind.SHELTER: 0.6,
}
"""How far a thing may be seen beyond its boxes, where that is much: eaves and chimneys, crowns, cross-arms, benches."""
SLIGHT_M = 0.3


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    return home_map()


@pytest.fixture(scope="module")
def scene(linden: LoadedMap) -> Scene:
    """Every tenth lot of Linden."""
    return home(replace(linden, lots=linden.lots[np.arange(len(linden.lots)) // 40 % 10 == 0]))


@pytest.fixture(scope="module")
def mesh(linden: LoadedMap, scene: Scene) -> Mesh:
    return things(linden, scene)


@pytest.fixture(scope="module")
def street() -> LoadedMap:
    return LoadedMap(name="street", text=STREET, **vars(derive(STREET)))


def normals(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.vertices_m[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return np.cross(b - a, c - a)


def test_every_box_is_seen_and_nothing_else(scene: Scene, mesh: Mesh) -> None:
    seen = np.unique(mesh.faces["object"])
    assert seen[seen != NO_OBJECT].tolist() == list(range(len(scene.boxes)))


def test_what_is_seen_of_a_box_carries_the_box_s_tag(scene: Scene, mesh: Mesh) -> None:
    of_box = mesh.faces["object"] != NO_OBJECT
    assert (mesh.faces["tag"][of_box] == scene.boxes["tag"][mesh.faces["object"][of_box]]).all()


def test_what_is_seen_of_a_box_lies_in_it_but_for_eaves_and_crowns(scene: Scene, mesh: Mesh) -> None:
    rows = np.flatnonzero(mesh.faces["object"] != NO_OBJECT)
    boxes = scene.boxes[mesh.faces["object"][rows]]
    kinds = scene.things["kind"][boxes["thing"]]
    beyond = np.array([OVERHANG_M.get(kind, SLIGHT_M) for kind in ObjectKind])[kinds]
    cosine, sine = np.cos(boxes["yaw_rad"]), np.sin(boxes["yaw_rad"])
    for corner in range(3):
        away = mesh.vertices_m[mesh.triangles[rows, corner]] - boxes["centre"]
        x, y = cosine * away[:, 0] + sine * away[:, 1], cosine * away[:, 1] - sine * away[:, 0]
        outside = np.abs(np.column_stack([x, y])) - boxes["half"][:, :2]
        assert (outside.max(axis=1) < beyond).all()
        assert (away[:, 2] - boxes["half"][:, 2] < beyond).all()


def test_a_house_s_ridge_is_its_box_s_top(scene: Scene, mesh: Mesh) -> None:
    roofs = np.flatnonzero(mesh.faces["material"] == Material.SHINGLES)
    of_house = roofs[scene.things["kind"][scene.boxes["thing"][mesh.faces["object"][roofs]]] == ObjectKind.HOUSE]
    top = np.full(len(scene.boxes), -np.inf)
    np.maximum.at(top, mesh.faces["object"][of_house], mesh.vertices_m[mesh.triangles[of_house], 2].max(axis=1))
    houses = np.flatnonzero(scene.things["kind"][scene.boxes["thing"]] == ObjectKind.HOUSE)
    np.testing.assert_allclose(
        top[houses], scene.boxes["centre"][houses, 2] + scene.boxes["half"][houses, 2], atol=1e-3
    )


def test_traffic_lights_show_three_lamps_to_oncoming_traffic(street: LoadedMap) -> None:
    scene = scenery_of(street).scene
    mesh = things(street, scene)
    for lamp in (LampOf.TRAFFIC_RED, LampOf.TRAFFIC_YELLOW, LampOf.TRAFFIC_GREEN):
        rows = mesh.faces["lamp"] == lamp
        assert rows.any()
        assert set(mesh.faces["object"][rows].tolist()) == {1}  # the housing; the pole is box 0
        toward = normals(mesh)[rows].sum(axis=0)
        yaw = np.radians(street.signals[0].transform.rotation.yaw + 90.0)
        assert toward @ [np.cos(yaw), np.sin(yaw), 0.0] > 0.99 * np.linalg.norm(toward)


def test_a_stop_sign_is_red_with_white_letters(street: LoadedMap) -> None:
    mesh = things(street, scenery_of(street).scene)
    faces = mesh.faces[mesh.faces["material"] == Material.SIGN_FACE]
    colours = {tuple(colour) for colour in faces["colour"].tolist()}
    assert len(faces) > 40
    assert len(colours) == 2
    assert any(red > 2 * green for red, green, _ in colours)


def test_a_stop_sign_reads_from_the_left_to_the_right(street: LoadedMap) -> None:
    scene = scenery_of(street).scene
    mesh = things(street, scene)
    white = (mesh.faces["material"] == Material.SIGN_FACE) & (mesh.faces["colour"][:, 1] > 200)
    plate = scene.boxes[scene.boxes["tag"] == SemanticTag.TRAFFIC_SIGNS][0]
    away = mesh.vertices_m[mesh.triangles[white]].reshape(-1, 3) - plate["centre"]
    # who reads the face looks against its y, and has its x on the right
    right = away[:, :2] @ [np.cos(plate["yaw_rad"]), np.sin(plate["yaw_rad"])]
    written = np.abs(away[:, 2]) < 0.11  # not the white edge
    first, last = (away[written & (side * right > 0.24) & (side * right < 0.33), 2] for side in (-1.0, 1.0))
    assert first.min() < -0.09  # an S has a foot
    assert last.min() > -0.03  # of a P only the bowl is there


def test_the_surface_is_what_wheels_feel(street: LoadedMap) -> None:
    mesh = surface(simplified_lanes(parse(STREET)))
    middle = mesh.vertices_m[mesh.triangles].mean(axis=1).astype(np.float64)
    height, triangle = street.ground.surfaces_under(np.column_stack([middle[:, :2], np.full(len(middle), HIGH_M)]))
    np.testing.assert_allclose(height, middle[:, 2], atol=1e-4)
    assert (triangle >= 0).all()
    assert (normals(mesh)[:, 2] > 0.0).all()


def test_a_kerb_looks_at_the_road_and_is_as_high_as_the_pavement(street: LoadedMap) -> None:
    mesh = kerbs(simplified_lanes(parse(STREET)), street.ground)
    at_road = np.isclose(np.abs(mesh.vertices_m[mesh.triangles, 1]), 3.5, atol=1e-3).all(axis=1)
    assert np.ptp(mesh.vertices_m[mesh.triangles[at_road], 2]) == pytest.approx(0.15, abs=1e-4)
    towards_middle = -np.sign(mesh.vertices_m[mesh.triangles[at_road, 0], 1])
    assert (np.sign(normals(mesh)[at_road, 1]) == towards_middle).all()


def test_no_ray_slips_through_between_the_land_and_the_street(street: LoadedMap) -> None:
    opendrive = parse(STREET)
    lanes, under = simplified_lanes(opendrive), floors(road_mesh(opendrive), street.ground)
    mesh = join([surface(lanes), kerbs(lanes, street.ground), under.mesh, land(lanes, street.ground, under)])
    dice, count = np.random.default_rng(5), 50_000
    side = dice.choice([-1.0, 1.0], count)
    eye = np.column_stack(
        [dice.uniform(0.0, 130.0, count), side * dice.uniform(12.0, 40.0, count), np.full(count, 2.0)]
    )
    x = np.where(dice.random(count) < 0.5, dice.uniform(5.0, 45.0, count), dice.uniform(75.0, 125.0, count))
    seam = np.column_stack([x, side * dice.uniform(4.8, 5.2, count), np.full(count, 0.149)])  # where the pavement ends
    along = (seam - eye) / np.linalg.norm(seam - eye, axis=1)[:, None]
    hits = caster_of(mesh, []).closest(Rays(eye.astype(np.float32), along.astype(np.float32)), 500.0)
    assert np.isfinite(hits.distance_m).all()


def test_land_begins_where_the_pavement_ends_and_is_never_on_a_road(street: LoadedMap) -> None:
    opendrive = parse(STREET)
    mesh = land(simplified_lanes(opendrive), street.ground, floors(road_mesh(opendrive), street.ground))
    corners = mesh.vertices_m[mesh.triangles].astype(np.float64)
    for weights in ((1 / 3, 1 / 3, 1 / 3), (0.6, 0.2, 0.2), (0.2, 0.6, 0.2), (0.2, 0.2, 0.6)):
        points = np.tensordot(corners, weights, axes=(1, 0))
        _, triangle = street.ground.surfaces_under(np.column_stack([points[:, :2], np.full(len(points), HIGH_M)]))
        assert (triangle < 0).all()
    assert (normals(mesh)[:, 2] > 0.0).all()
    beside = mesh.vertices_m[
        (np.abs(mesh.vertices_m[:, 1] - 5.0) < 0.01) & (np.abs(mesh.vertices_m[:, 0] - 25.0) < 20.0)
    ]
    assert len(beside) > 5
    np.testing.assert_allclose(beside[:, 2], 0.15, atol=0.03)


def test_the_mesh_comes_out_of_the_cache_as_it_went_in(street: LoadedMap, tmp_path) -> None:
    scene = scenery_of(street).scene
    cache = MapCache(tmp_path)
    made = standing(parse(STREET), street, scene)
    keep_standing(street, scene, cache)
    (file,) = tmp_path.iterdir()
    os.utime(file, (100.0, 100.0))
    written = file.read_bytes()
    keep_standing(street, scene, cache)
    assert file.read_bytes() == written
    assert file.stat().st_mtime > 100.0  # as used just now
    for _ in range(2):
        kept = standing_of(street, scene, cache)
        assert [part.tobytes() for part in kept] == [part.tobytes() for part in made]
    assert len(list(tmp_path.iterdir())) == 1


def test_streets_are_tagged_as_carla_does(street: LoadedMap) -> None:
    made = standing(parse(STREET), street, scenery_of(street).scene)
    tags = {SemanticTag(tag) for tag in np.unique(made.faces["tag"])}
    assert {SemanticTag.ROADS, SemanticTag.SIDEWALKS, SemanticTag.ROAD_LINES, SemanticTag.TERRAIN} <= tags
    assert np.isfinite(made.vertices_m).all()
