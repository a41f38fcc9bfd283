"""Linden's yards and streetsides: nothing on a road, nothing in anything else, a shelter at every stop."""

from itertools import pairwise

import numpy as np
import pytest

from home_map import home_map
from linden.maps.library import LoadedMap
from linden.physics.contact.boxes import overlap
from linden.protocol.values.enums import LaneType
from linden.scenery.scene.linden_survey import surveyed
from linden.scenery.scene.neighbourhood import furnish
from linden.scenery.scene.objects import ObjectKind, Scene
from linden.scenery.scene.south_linden import free_lots, home
from linden.scenery.scene.utility_poles import RAILROAD_CLEAR_M

HIGH_M = 1e9
LARGEST_HALF_M = (5.14, 1.97)  # of vehicle.mitsubishi.fusorosa


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    return home_map()


@pytest.fixture(scope="module")
def scene(linden: LoadedMap) -> Scene:
    return home(linden)


def of_kinds(scene: Scene, *kinds: ObjectKind) -> np.ndarray:
    return scene.boxes[np.isin(scene.things["kind"][scene.boxes["thing"]], kinds)]


def corners(boxes: np.ndarray) -> np.ndarray:
    """The corners (N, 4, 2) of boxes seen from above."""
    local = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * boxes["half"][:, None, :2]
    cosine, sine = np.cos(boxes["yaw_rad"])[:, None], np.sin(boxes["yaw_rad"])[:, None]
    x, y = local[..., 0], local[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1) + boxes["centre"][:, None, :2]


def lanes_under(linden: LoadedMap, points: np.ndarray) -> np.ndarray:
    """The row in the table of lanes under each point (..., 2), -1 where no road is."""
    flat = points.reshape(-1, 2)
    _, triangle = linden.ground.surfaces_under(np.column_stack([flat, np.full(len(flat), HIGH_M)]))
    return np.where(triangle >= 0, linden.lane_of_triangle[triangle], -1).reshape(points.shape[:-1])


def as_columns(boxes: np.ndarray) -> np.ndarray:
    low, high = (boxes["centre"][:, 2] + side * boxes["half"][:, 2] for side in (-1.0, 1.0))
    turn = np.cos(boxes["yaw_rad"]), np.sin(boxes["yaw_rad"])
    return np.column_stack([boxes["centre"][:, :2], *turn, boxes["half"][:, :2], low, high])


def test_yards_and_poles_stand_beside_roads_and_pavements(linden: LoadedMap, scene: Scene) -> None:
    boxes = of_kinds(scene, ObjectKind.PORCH, ObjectKind.HEDGE, ObjectKind.FENCE, ObjectKind.UTILITY_POLE)
    assert len(boxes) > 5000
    assert (lanes_under(linden, corners(boxes)) < 0).all()


def test_a_parked_car_stands_on_a_drive_or_in_a_parking_lane(linden: LoadedMap, scene: Scene) -> None:
    lanes = lanes_under(linden, corners(of_kinds(scene, ObjectKind.PARKED_CAR)))
    in_lane = (linden.lanes["type_bits"][lanes] == LaneType.PARKING) & (lanes >= 0)
    assert (in_lane.all(axis=1) | (lanes < 0).all(axis=1)).all()
    assert in_lane.all(axis=1).sum() > 400
    assert (lanes < 0).all(axis=1).sum() > 500


def test_no_car_is_parked_where_a_bus_may_be_spawned(linden: LoadedMap, scene: Scene) -> None:
    cars = as_columns(of_kinds(scene, ObjectKind.PARKED_CAR))
    for point in linden.spawn_points[::7]:
        yaw = np.radians(point.rotation.yaw)
        bus = np.array([*point.location[:2], np.cos(yaw), np.sin(yaw), *LARGEST_HALF_M, -HIGH_M, HIGH_M])
        near = np.hypot(*(cars[:, :2] - bus[:2]).T) < 12.0
        assert not any(overlap(bus, car)[0] > 0.0 for car in cars[near])


def test_cars_are_parked_the_way_the_traffic_beside_them_goes(linden: LoadedMap, scene: Scene) -> None:
    cars = scene.things[scene.things["kind"] == ObjectKind.PARKED_CAR]
    cars = cars[lanes_under(linden, cars["base"][:, :2]) >= 0]
    points = np.array([(*point.location[:2], np.radians(point.rotation.yaw)) for point in linden.spawn_points])
    away = np.hypot(*np.moveaxis(points[None, :, :2] - cars["base"][:, None, :2], 2, 0))
    beside = away.min(axis=1) < 14.0
    along = np.cos(points[away.argmin(axis=1), 2] - cars["yaw_rad"])[beside]
    assert beside.sum() > 200
    assert 0.9 < (along > 0.9).mean() < 1.0  # some park the other way round


def test_no_car_parks_where_the_shuttle_stops_or_before_a_sign(linden: LoadedMap, scene: Scene) -> None:
    cars = of_kinds(scene, ObjectKind.PARKED_CAR)["centre"][:, :2]
    cars = cars[lanes_under(linden, cars) >= 0]
    signals = np.array([signal.transform.location[:2] for signal in linden.signals])
    for others, reach_m in ((surveyed(linden.geo_origin_deg).stops_m, 25.0), (signals, 9.0)):
        assert min(float(np.hypot(*(cars - other).T).min()) for other in others) > reach_m


def test_a_parked_car_stands_in_nothing_else(scene: Scene) -> None:
    cars = as_columns(of_kinds(scene, ObjectKind.PARKED_CAR))
    others = as_columns(scene.boxes)
    assert len(cars) > 500
    for car in cars[::5]:
        near = np.hypot(*(others[:, :2] - car[:2]).T) < 15.0
        met = [other for other in others[near] if overlap(car, other)[0] > 0.0]
        assert len(met) == 1  # itself


def test_every_stop_has_a_shelter_on_its_side_of_the_street(linden: LoadedMap, scene: Scene) -> None:
    known = surveyed(linden.geo_origin_deg)
    shelters = scene.things[scene.things["kind"] == ObjectKind.SHELTER]
    assert len(shelters) == len(known.stops_m) == 6
    for shelter, stop, kerb in zip(shelters, known.stops_m, known.kerbs, strict=True):
        assert np.hypot(*(shelter["base"][:2] - stop)) < 20.0
        assert [np.cos(shelter["yaw_rad"]), np.sin(shelter["yaw_rad"])] @ kerb > 0.5


def test_no_house_stands_on_the_railroad(linden: LoadedMap, scene: Scene) -> None:
    line = surveyed(linden.geo_origin_deg).railroad_m
    pieces = [begin + np.linspace(0, 1, 200)[:, None] * (end - begin) for begin, end in pairwise(line)]
    dense = np.concatenate(pieces)
    houses = of_kinds(scene, ObjectKind.HOUSE)["centre"][:, :2]
    nearest = min(float(np.hypot(*(dense - house).T).min()) for house in houses)
    assert nearest > RAILROAD_CLEAR_M


def test_the_origin_of_the_map_is_where_its_first_streets_cross(linden: LoadedMap) -> None:
    stop = surveyed(linden.geo_origin_deg).stops_m[0]  # 32 m east of the transit center, which is 50 m from the origin
    assert 60.0 < np.hypot(*stop) < 130.0


def test_named_places_have_bodies_and_stand_in_no_house_tree_or_road(linden: LoadedMap, scene: Scene) -> None:
    buildings = of_kinds(scene, ObjectKind.BUILDING)
    assert len(buildings) == sum(len(thing.boxes) for thing in linden.standing if thing.kind == "building") >= 22
    assert (lanes_under(linden, corners(buildings)) < 0).all()
    others = as_columns(of_kinds(scene, ObjectKind.HOUSE, ObjectKind.TREE, ObjectKind.PORCH, ObjectKind.PARKED_CAR))
    for building in as_columns(buildings):
        near = np.hypot(*(others[:, :2] - building[:2]).T) < 75.0
        assert not [other for other in others[near] if overlap(building, other)[0] > 0.0]
    names = [name for name in scene.thing_names if name.startswith("Building")]
    assert any("LindenTransitCenter" in name for name in names)
    assert any("StStephensCommunityHouse" in name for name in names)


def test_benches_bins_and_mailboxes_are_objects_of_their_own(linden: LoadedMap, scene: Scene) -> None:
    kinds = (ObjectKind.BENCH, ObjectKind.BIN, ObjectKind.MAILBOX)
    assert [int((scene.things["kind"] == kind).sum()) for kind in kinds] == [6, 6, 6]
    lanes = lanes_under(linden, scene.things["base"][np.isin(scene.things["kind"], kinds)][:, :2])
    assert (linden.lanes["type_bits"][lanes[lanes >= 0]] != LaneType.DRIVING).all()


def test_the_lots_beside_a_named_place_look_as_they_did(linden: LoadedMap) -> None:
    lots = free_lots(linden)
    assert 10 < lots["taken"].sum() < 100
    houses = of_kinds(furnish(lots, linden.ground), ObjectKind.HOUSE)["centre"]
    plain = lots.copy()
    plain["taken"] = False
    before = of_kinds(furnish(plain, linden.ground), ObjectKind.HOUSE)["centre"]
    assert {tuple(place) for place in houses.tolist()} < {tuple(place) for place in before.tolist()}
