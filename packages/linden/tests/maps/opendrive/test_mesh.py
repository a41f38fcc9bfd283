"""Claims about the road's surface and the table of its lanes."""

import math
from importlib import resources

import carla
import numpy as np
import pytest

from linden.maps.opendrive.limits import MapError
from linden.maps.opendrive.mesh import RoadMesh, road_mesh
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType, SemanticTag
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

LINDEN = (resources.files("linden") / "data" / "Linden.xodr").read_text()
LIMIT = '<speed sOffset="{}" max="{}" unit="{}"/>'


def one_road(right: str, left: str = "", *, plan: str = "", length: float = 40.0, **more: str) -> RoadMesh:
    plan = plan or line(0, 0, 0, 0, length)
    return road_mesh(parse(opendrive(road(9, length, plan, section(left=left, right=right), **more))))


def twice_areas(mesh: RoadMesh) -> np.ndarray:
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)[:, 2]


@pytest.mark.parametrize("text", [street_through_junction(), LINDEN], ids=["street", "Linden"])
def test_all_triangles_face_up(text: str) -> None:
    assert (twice_areas(road_mesh(parse(text))) > 0.0).all()


def test_the_surface_has_the_area_of_its_lanes() -> None:
    mesh = one_road(lane(-1, width=3.0) + lane(-2, width=1.5), lane(1, width=2.5))
    assert twice_areas(mesh).sum() / 2.0 == pytest.approx(40.0 * 7.0)


def test_right_lanes_lie_to_the_south_of_an_eastward_road() -> None:
    vertices = one_road(lane(-1)).vertices
    assert vertices[:, 1].min() == pytest.approx(0.0)
    assert vertices[:, 1].max() == pytest.approx(3.5)


def test_straight_and_level_roads_take_long_steps_and_bends_short_ones() -> None:
    straight = one_road(lane(-1))
    bend = one_road(lane(-1), plan=line(0, 0, 0, 0, 40, '<arc curvature="0.05"/>'))
    assert len(straight.triangles) == 2 * 4
    assert len(bend.triangles) == 2 * math.ceil(40.0 / math.sqrt(8.0 * 0.02 * 20.0))


def test_no_chord_leaves_an_arc_by_more_than_said() -> None:
    radius = 12.0
    mesh = one_road(lane(-1), plan=line(0, 0, 0, 0, 30, f'<arc curvature="{1 / radius}"/>'), length=30.0)
    inner = mesh.vertices[: len(mesh.vertices) // 2, :2]  # along the reference line
    middles = (inner[1:] + inner[:-1]) / 2.0
    off = radius - np.hypot(middles[:, 0], middles[:, 1] + radius)
    assert 0.0 < off.max() <= 0.02


def test_a_lane_is_lifted_by_its_height() -> None:
    kerb = '<height sOffset="0" inner="0.12" outer="0.16"/>'
    mesh = one_road(
        lane(-1) + lane(-2, "sidewalk", 1.5, more=kerb), elevation='<elevation s="0" a="7" b="0" c="0" d="0"/>'
    )
    heights = {
        int(mesh.lanes["lane_id"][row]): np.unique(mesh.vertices[mesh.triangles[mesh.lane_of_triangle == row], 2])
        for row in range(len(mesh.lanes))
    }
    assert heights[-1].tolist() == [7.0]
    assert heights[-2] == pytest.approx([7.12, 7.16])


def test_a_lane_that_tapers_to_nothing_leaves_no_empty_triangles() -> None:
    taper = '<width sOffset="0" a="3" b="-0.075" c="0" d="0"/>'
    mesh = one_road(lane(-1, widths=taper))
    assert twice_areas(mesh).min() > 1e-6
    assert twice_areas(mesh).sum() / 2.0 == pytest.approx(60.0)


@pytest.mark.parametrize(("unit", "mps"), [("mph", 13.4112), ("km/h", 30.0 / 3.6), ("m/s", 30.0)])
def test_the_roads_limit_is_read_in_its_unit(unit: str, mps: float) -> None:
    mesh = one_road(lane(-1), speed=f'<type s="0" type="town"><speed max="30" unit="{unit}"/></type>')
    assert mesh.lanes["speed_limit_mps"].tolist() == [pytest.approx(mps)]


def test_a_lanes_own_limit_goes_before_the_roads_and_may_change_on_the_way() -> None:
    own = LIMIT.format(0, 10, "m/s") + LIMIT.format(25, 5, "m/s")
    mesh = one_road(lane(-1, more=own) + lane(-2))
    assert mesh.lanes["speed_limit_mps"].tolist() == [10.0, 5.0, pytest.approx(11.176)]
    assert mesh.lanes["lane_id"].tolist() == [-1, -1, -2]
    slow = mesh.vertices[mesh.triangles[mesh.lane_of_triangle == 1]]
    assert slow[:, :, 0].min() == pytest.approx(25.0)


@pytest.mark.parametrize("speed", ["", '<type s="0" type="town"><speed max="no limit"/></type>'])
def test_an_unknown_limit_is_not_a_number(speed: str) -> None:
    assert np.isnan(one_road(lane(-1), speed=speed).lanes["speed_limit_mps"]).all()


def test_lanes_are_tagged_and_named_in_the_table() -> None:
    lanes = road_mesh(parse(street_through_junction())).lanes
    of_road = {int(row["lane_id"]): row for row in lanes[lanes["road_id"] == 1]}
    assert of_road[-1]["tag"] == SemanticTag.ROADS
    assert of_road[2]["tag"] == SemanticTag.SIDEWALKS
    assert of_road[2]["type_bits"] == LaneType.SIDEWALK
    assert set(lanes["junction"][lanes["road_id"] >= 10]) == {100}
    assert set(lanes["junction"][lanes["road_id"] < 10]) == {-1}


def test_a_map_without_roads_has_an_empty_surface() -> None:
    mesh = road_mesh(parse("<OpenDRIVE/>"))
    assert (len(mesh.vertices), len(mesh.triangles), len(mesh.lanes)) == (0, 0, 0)


def test_lindens_lanes_have_their_waypoints_in_the_middle_of_their_surface() -> None:
    theirs = carla.Map("Linden", LINDEN)
    mesh = road_mesh(parse(LINDEN))
    random = np.random.default_rng(3)
    for nth in random.integers(0, len(mesh.triangles), 400):
        lane_row = mesh.lanes[mesh.lane_of_triangle[nth]]
        middle = mesh.vertices[mesh.triangles[nth]].mean(axis=0)
        if lane_row["type_bits"] != LaneType.DRIVING or lane_row["junction"] >= 0:
            continue  # inside junctions several lanes lie on the same ground
        found = theirs.get_waypoint(carla.Location(*map(float, middle)))
        assert (found.road_id, found.lane_id) == (lane_row["road_id"], lane_row["lane_id"])
        assert abs(found.transform.location.z - middle[2]) < 0.05


def test_the_same_text_gives_the_same_bytes() -> None:
    first, second = (road_mesh(parse(LINDEN)) for _ in range(2))
    assert all(one.tobytes() == other.tobytes() for one, other in zip(first, second, strict=True))


WIDE = '<width sOffset="0" a="300" b="0" c="0" d="0"/>'
LONG = line(0, 0, 0, 0, 2e5)
HIGH = '<elevation s="0" a="1e8" b="0" c="0" d="0"/>'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (opendrive(road(1, 100.0, line(0, 0, 0, 0, 100), section(right=lane(-1, widths=WIDE)))), "wider than 250 m"),
        (opendrive(road(1, 2e5, LONG, section(right=lane(-1)))), "further than 25000 m from the map's middle"),
        (
            opendrive(road(1, 9.0, line(0, 0, 0, 0, 9), section(right=lane(-1)), elevation=HIGH)),
            "more than 20000 m high",
        ),
        (
            opendrive(
                *(
                    road(n, 2e5, line(0, 0, 0, 0, 2e5, '<arc curvature="4"/>'), section(right=lane(-1) + lane(-2)))
                    for n in range(4)
                )
            ),
            "places along its lanes",
        ),
        (
            opendrive(*(road(n, 9.0, line(0, 0, 0, 0, 9), section(right=lane(-1, width=240.0))) for n in range(3000))),
            "lanes over one another, on an average; 64 are allowed",
        ),
    ],
    ids=["wide", "long", "high", "places", "overlaps"],
)
def test_a_map_that_asks_for_too_much_is_refused_with_the_limit(text: str, told: str) -> None:
    with pytest.raises(MapError) as caught:
        road_mesh(parse(text))
    assert told in str(caught.value)
