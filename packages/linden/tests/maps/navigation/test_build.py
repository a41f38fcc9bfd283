"""The mesh of a street: pavements, the crosswalk between them, and what stands in the way."""

from collections import defaultdict

import numpy as np
import pytest

from linden.maps.facts import derive
from linden.maps.navigation import map_mesh
from linden.maps.navigation.detour import BORDER, EAST, NORTH, SOUTH, WEST, Area, Obstacles, WalkingMesh, write
from naive.walking_mesh import CROSSWALK, ROAD, SIDEWALK, Locator, read
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

NOTHING = Obstacles(np.empty((0, 3)), np.empty((0, 3)), np.empty(0))
OPPOSITE = {EAST: WEST, WEST: EAST, NORTH: SOUTH, SOUTH: NORTH}


def crosswalk(s_m: float, half_width_m: float = 3.5, heading: float = 0.0) -> str:
    corners = [(-1.5, -half_width_m), (1.5, -half_width_m), (1.5, half_width_m), (-1.5, half_width_m)]
    outline = "".join(f'<cornerLocal u="{u}" v="{v}" z="0" height="0"/>' for u, v in corners)
    pose = f's="{s_m}" t="0" zOffset="0" hdg="{heading}" orientation="none"'
    return f'<object id="c{s_m}" type="crosswalk" name="c" {pose}><outline>{outline}</outline></object>'


def mesh_of(text: str, obstacles: Obstacles = NOTHING) -> WalkingMesh:
    facts = derive(text)
    return map_mesh.mesh_of(facts, text, obstacles)


def areas_at(mesh: WalkingMesh, x: float, y: float) -> set[int]:
    return {area for area, _ in Locator(read(write(mesh))).at(x, y)}


Place = tuple[int, int]


def links_between_tiles(mesh: WalkingMesh) -> dict[Place, set[Place]]:
    """Return which polygons (tile, polygon) touch over the sides of tiles."""
    at_border = defaultdict(list)
    for t, tile in enumerate(mesh.tiles):
        for p, polygon in enumerate(tile.polygons):
            for n, side in enumerate(polygon.neighbours):
                if side < BORDER:
                    ends = tile.vertices_m[[polygon.corners[n], polygon.corners[(n + 1) % len(polygon.corners)]]]
                    axis = 1 if side in (EAST, WEST) else 0
                    at_border[axis, round(float(ends[0, 1 - axis]), 3)].append((side, sorted(ends[:, axis]), (t, p)))
    links = defaultdict(set)
    for items in at_border.values():
        for side, (low, high), own in items:
            for other_side, (other_low, other_high), other in items:
                if other_side == OPPOSITE[side] and max(low, other_low) < min(high, other_high) - 1e-6:
                    links[own].add(other)
    return links


def reachable(mesh: WalkingMesh, areas: set[Area]) -> list[set[Place]]:
    """Return the islands of polygons that hang together over sides, within those areas."""
    links = links_between_tiles(mesh)
    unseen = {(t, p) for t, tile in enumerate(mesh.tiles) for p, q in enumerate(tile.polygons) if q.area in areas}
    islands = []
    while unseen:
        stack, island = [min(unseen)], set()
        while stack:
            t, p = stack.pop()
            if (t, p) in unseen:
                unseen.discard((t, p))
                island.add((t, p))
                stack += [(t, n) for n in mesh.tiles[t].polygons[p].neighbours if n >= 0]
                stack += links[t, p]
        islands.append(island)
    return islands


@pytest.fixture(scope="module")
def street() -> WalkingMesh:
    return mesh_of(street_through_junction(objects=crosswalk(30.0)))


def test_pavement_carriageway_and_crosswalk_have_their_areas(street: WalkingMesh) -> None:
    assert areas_at(street, 10.0, 4.25) == {SIDEWALK}
    assert areas_at(street, 10.0, 1.0) == {ROAD}
    assert areas_at(street, 30.0, 1.0) == {CROSSWALK}
    assert areas_at(street, 10.0, 7.0) == set()


def test_without_the_carriageway_the_crosswalk_is_the_way_across(street: WalkingMesh) -> None:
    walkable = {Area.SIDEWALK, Area.CROSSWALK}
    islands = reachable(street, walkable)
    crossing = next(i for i in islands if any(street.tiles[t].polygons[p].area == Area.CROSSWALK for t, p in i))
    sides = {
        np.sign(street.tiles[t].vertices_m[list(street.tiles[t].polygons[p].corners), 1].mean())
        for t, p in crossing
        if street.tiles[t].polygons[p].area == Area.SIDEWALK
    }
    assert sides == {-1.0, 1.0}
    assert len(reachable(mesh_of(street_through_junction()), walkable)) == 4  # each piece of pavement by itself


def test_a_crosswalk_from_kerb_to_kerb_leads_over_the_verge_to_the_pavement() -> None:
    lanes = lane(-1) + lane(-2, "border", 0.15) + lane(-3, "none", 1.2) + lane(-4, "sidewalk", 1.5)
    other = lane(4, "sidewalk", 1.5) + lane(3, "none", 1.2) + lane(2, "border", 0.15) + lane(1)
    text = opendrive(
        road(
            1,
            60.0,
            line(0, 0, 0, 0, 60),
            section(left=other, right=lanes),
            more=f"<objects>{crosswalk(30.0)}</objects>",
        )
    )
    mesh = mesh_of(text)
    assert len(reachable(mesh, {Area.SIDEWALK, Area.CROSSWALK})) == 1
    assert areas_at(mesh, 30.0, 4.2) == {CROSSWALK}
    assert areas_at(mesh, 20.0, 4.2) == {ROAD}, "a verge is crossed by those who may cross roads"


def test_a_walkers_middle_keeps_off_the_pavements_edges(street: WalkingMesh) -> None:
    tiles = [(tile, polygon) for tile in street.tiles for polygon in tile.polygons if polygon.area == Area.SIDEWALK]
    aside_m = np.abs(np.concatenate([tile.vertices_m[list(polygon.corners), 1] for tile, polygon in tiles]))
    assert 3.55 < aside_m.min() < 4.0
    assert 4.5 < aside_m.max() < 4.95


def test_the_mesh_lies_on_the_ground(street: WalkingMesh) -> None:
    for tile in street.tiles:
        for polygon in tile.polygons:
            heights_m = tile.vertices_m[list(polygon.corners), 2]
            assert heights_m == pytest.approx(0.15 if polygon.area == Area.SIDEWALK else 0.075, abs=0.076)


def test_no_walker_is_led_through_what_stands_on_the_pavement() -> None:
    box = Obstacles(np.array([[20.0, 4.25, 1.0]]), np.array([[0.5, 0.1, 1.0]]), np.zeros(1))
    mesh = mesh_of(street_through_junction(), box)
    assert areas_at(mesh, 20.0, 4.25) == set()
    assert areas_at(mesh, 20.0 + 0.5 + 0.25, 4.25) == set(), "a shoulder's width beside it either"
    assert areas_at(mesh, 22.0, 4.25) == {SIDEWALK}


def test_neighbours_name_each_other_and_share_a_side(street: WalkingMesh) -> None:
    for tile in street.tiles:
        for number, polygon in enumerate(tile.polygons):
            for n, neighbour in enumerate(polygon.neighbours):
                if neighbour < 0:
                    continue
                a, b = polygon.corners[n], polygon.corners[(n + 1) % len(polygon.corners)]
                other = tile.polygons[neighbour]
                at = other.corners.index(b)
                assert other.corners[(at + 1) % len(other.corners)] == a
                assert other.neighbours[at] == number


def test_a_street_longer_than_a_tile_is_one_way() -> None:
    text = opendrive(road(1, 200.0, line(0, 0, 0, 0.3, 200), section(right=lane(-1) + lane(-2, "sidewalk", 2.0))))
    mesh = mesh_of(text)
    assert len(mesh.tiles) >= 3
    assert len(reachable(mesh, {Area.SIDEWALK})) == 1


def test_a_map_without_pavements_has_no_mesh() -> None:
    text = opendrive(road(1, 60.0, line(0, 0, 0, 0, 60), section(right=lane(-1))))
    assert mesh_of(text).tiles == ()


def test_a_mesh_is_the_same_every_time(street: WalkingMesh) -> None:
    assert write(mesh_of(street_through_junction(objects=crosswalk(30.0)))) == write(street)
