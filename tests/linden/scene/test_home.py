"""Linden's yards and streetsides: nothing on a road, nothing in anything else, a shelter at every stop."""

from itertools import pairwise

import numpy as np
import pytest

from linden.physics.contact.boxes import overlap
from linden.scene.home import home
from linden.scene.objects import Kind, Scene
from linden.scene.streetside import RAILROAD_CLEAR_M
from linden.scene.surveyed import surveyed
from linden.world.maps import HOME_MAP, LoadedMap, MapLibrary

HIGH_M = 1e9


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    return MapLibrary().load(HOME_MAP)


@pytest.fixture(scope="module")
def scene(linden: LoadedMap) -> Scene:
    return home(linden.lots, linden.ground, linden.geo_origin_deg)


def of_kinds(scene: Scene, *kinds: Kind) -> np.ndarray:
    return scene.boxes[np.isin(scene.things["kind"][scene.boxes["thing"]], kinds)]


def corners(boxes: np.ndarray) -> np.ndarray:
    """The corners (N, 4, 2) of boxes seen from above."""
    local = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * boxes["half"][:, None, :2]
    cosine, sine = np.cos(boxes["yaw_rad"])[:, None], np.sin(boxes["yaw_rad"])[:, None]
    x, y = local[..., 0], local[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1) + boxes["centre"][:, None, :2]


def as_columns(boxes: np.ndarray) -> np.ndarray:
    low, high = (boxes["centre"][:, 2] + side * boxes["half"][:, 2] for side in (-1.0, 1.0))
    turn = np.cos(boxes["yaw_rad"]), np.sin(boxes["yaw_rad"])
    return np.column_stack([boxes["centre"][:, :2], *turn, boxes["half"][:, :2], low, high])


def test_yards_and_poles_stand_beside_roads_and_pavements(linden: LoadedMap, scene: Scene) -> None:
    boxes = of_kinds(scene, Kind.PORCH, Kind.HEDGE, Kind.FENCE, Kind.PARKED_CAR, Kind.UTILITY_POLE)
    points = corners(boxes).reshape(-1, 2)
    _, triangle = linden.ground.surfaces_under(np.column_stack([points, np.full(len(points), HIGH_M)]))
    assert len(boxes) > 5000
    assert (triangle < 0).all()


def test_a_parked_car_stands_in_nothing_else(scene: Scene) -> None:
    cars = as_columns(of_kinds(scene, Kind.PARKED_CAR))
    others = as_columns(scene.boxes)
    assert len(cars) > 500
    for car in cars[::5]:
        near = np.hypot(*(others[:, :2] - car[:2]).T) < 15.0
        met = [other for other in others[near] if overlap(car, other)[0] > 0.0]
        assert len(met) == 1  # itself


def test_every_stop_has_a_shelter_on_its_side_of_the_street(linden: LoadedMap, scene: Scene) -> None:
    known = surveyed(linden.geo_origin_deg)
    shelters = scene.things[scene.things["kind"] == Kind.SHELTER]
    assert len(shelters) == len(known.stops_m) == 6
    for shelter, stop, kerb in zip(shelters, known.stops_m, known.kerbs, strict=True):
        assert np.hypot(*(shelter["base"][:2] - stop)) < 20.0
        assert [np.cos(shelter["yaw_rad"]), np.sin(shelter["yaw_rad"])] @ kerb > 0.5


def test_no_house_stands_on_the_railroad(linden: LoadedMap, scene: Scene) -> None:
    line = surveyed(linden.geo_origin_deg).railroad_m
    pieces = [begin + np.linspace(0, 1, 200)[:, None] * (end - begin) for begin, end in pairwise(line)]
    dense = np.concatenate(pieces)
    houses = of_kinds(scene, Kind.HOUSE)["centre"][:, :2]
    nearest = min(float(np.hypot(*(dense - house).T).min()) for house in houses)
    assert nearest > RAILROAD_CLEAR_M


def test_the_origin_of_the_map_is_where_its_first_streets_cross(linden: LoadedMap) -> None:
    stop = surveyed(linden.geo_origin_deg).stops_m[0]  # 32 m east of the transit center, which is 50 m from the origin
    assert 60.0 < np.hypot(*stop) < 130.0
