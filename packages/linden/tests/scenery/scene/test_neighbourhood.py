"""Linden's houses, trees and lamps: beside the streets, never on them, and the same every time."""

import math

import numpy as np
import pytest

from home_map import home_map
from linden.maps.library import LoadedMap
from linden.maps.records import LOT_DEPTH_M, LOT_WIDTH_M
from linden.physics.contact.boxes import overlap
from linden.scenery.scene.neighbourhood import SETBACK_M, VACANT, furnish
from linden.scenery.scene.objects import ObjectKind, Scene

HIGH_M = 1e9


@pytest.fixture(scope="module")
def linden() -> LoadedMap:
    return home_map()


@pytest.fixture(scope="module")
def scene(linden: LoadedMap) -> Scene:
    return furnish(linden.lots, linden.ground)


def is_hung(scene: Scene) -> np.ndarray:
    """Whether each box ends above the ground that its thing stands on."""
    return scene.boxes["centre"][:, 2] - scene.boxes["half"][:, 2] > scene.things["base"][scene.boxes["thing"], 2] + 0.1


def footprints(boxes: np.ndarray, spacing_m: float = 1.0) -> np.ndarray:
    """Points (N, 2) on every box seen from above, no further apart than ``spacing_m``, its corners among them."""
    points = []
    for box in boxes:
        x, y = (np.linspace(-half, half, max(2, math.ceil(2 * half / spacing_m) + 1)) for half in box["half"][:2])
        local = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        c, s = math.cos(box["yaw_rad"]), math.sin(box["yaw_rad"])
        points.append(local @ np.array([[c, s], [-s, c]]) + box["centre"][:2])
    return np.concatenate(points)


def test_nothing_that_stands_on_the_ground_stands_on_a_road_or_pavement(linden: LoadedMap, scene: Scene) -> None:
    standing = scene.boxes[~is_hung(scene)]
    assert len(standing) == len(scene.things)
    points = footprints(standing)
    _, triangle = linden.ground.surfaces_under(np.column_stack([points, np.full(len(points), HIGH_M)]))
    assert (triangle < 0).all()


def test_an_arm_over_the_street_is_higher_than_any_vehicle(linden: LoadedMap, scene: Scene) -> None:
    hung = scene.boxes[is_hung(scene)]
    assert len(hung) == (scene.things["kind"] == ObjectKind.STREET_LAMP).sum()
    ground_m, _ = linden.ground.surfaces_under(np.column_stack([hung["centre"][:, :2], np.full(len(hung), HIGH_M)]))
    assert (hung["centre"][:, 2] - hung["half"][:, 2] - ground_m > 5.0).all()


def test_no_house_stands_in_another(scene: Scene) -> None:
    houses = scene.boxes[scene.things["kind"][scene.boxes["thing"]] == ObjectKind.HOUSE]
    columns = np.column_stack([
        houses["centre"][:, :2], np.cos(houses["yaw_rad"]), np.sin(houses["yaw_rad"]), houses["half"][:, :2],
        houses["centre"][:, 2] - houses["half"][:, 2], houses["centre"][:, 2] + houses["half"][:, 2],
    ])  # fmt: skip
    by_x = np.argsort(columns[:, 0])
    compared = 0
    for place, first in enumerate(by_x):
        for second in by_x[place + 1 :]:
            if columns[second, 0] - columns[first, 0] > 16.0:
                break
            if abs(columns[second, 1] - columns[first, 1]) < 16.0:
                compared += 1
                assert overlap(columns[first], columns[second])[0] == 0.0
    assert compared > len(houses) // 2


def test_as_many_lots_are_built_on_as_the_neighbourhood_has(linden: LoadedMap, scene: Scene) -> None:
    houses = (scene.things["kind"] == ObjectKind.HOUSE).sum()
    assert len(linden.lots) > 3000
    assert houses / len(linden.lots) == pytest.approx(1.0 - VACANT, abs=0.03)


def test_a_house_stands_back_from_the_pavement_within_its_lot(linden: LoadedMap, scene: Scene) -> None:
    houses = scene.boxes[scene.things["kind"][scene.boxes["thing"]] == ObjectKind.HOUSE]
    lots = linden.lots
    for house in houses[::40]:
        lot = lots[np.argmin(np.hypot(*(lots["front_m"] - house["centre"][:2]).T))]
        away = house["centre"][:2] - lot["front_m"]
        into = away @ (math.cos(lot["yaw_rad"]), math.sin(lot["yaw_rad"]))
        assert SETBACK_M[0] <= into - house["half"][0] <= SETBACK_M[1]
        assert into + house["half"][0] <= LOT_DEPTH_M
        assert house["half"][1] < 0.5 * LOT_WIDTH_M


def test_the_same_map_has_the_same_houses_to_the_last_bit(linden: LoadedMap, scene: Scene) -> None:
    again = furnish(linden.lots, linden.ground)
    assert again.boxes.tobytes() == scene.boxes.tobytes()
    assert again.things.tobytes() == scene.things.tobytes()


def test_a_map_without_lots_is_bare(linden: LoadedMap) -> None:
    assert len(furnish(linden.lots[:0], linden.ground).boxes) == 0
