"""Walls stand on the edges of roads, never on another road, and no higher than asked for."""

import numpy as np
import pytest

from linden.maps.library import MapLibrary
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.posts import HALF_THICKNESS_M, walls
from linden.simulation.surroundings import scenery_of
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

PLAIN = opendrive(road(1, 100.0, line(0, 0, 0, 0, 100), section(left=lane(1), right=lane(-1))))
HILL = '<elevation s="0" a="0" b="0.1" c="0" d="0"/>'
STEEP = opendrive(road(1, 100.0, line(0, 0, 0, 0, 100), section(right=lane(-1)), elevation=HILL))


def feet(text: str, beyond_m: float = 0.6) -> np.ndarray:
    return MapLibrary().from_opendrive(text, wall_height_m=1.0, beyond_m=beyond_m).walls.feet_m


@pytest.mark.parametrize("beyond_m", [0.0, 0.6])
def test_a_road_has_a_wall_on_either_hand_so_far_beyond_its_lanes(beyond_m: float) -> None:
    found = feet(PLAIN, beyond_m)
    assert sorted({round(abs(float(y)), 6) for y in found[:, :, 1].ravel()}) == [3.5 + beyond_m]
    for side in (-1.0, 1.0):
        wall = found[np.sign(found[:, 0, 1]) == side]
        length_m = np.hypot(*(wall[:, 1] - wall[:, 0])[:, :2].T).sum()
        assert length_m == pytest.approx(100.0, abs=0.1)


def test_a_pavement_is_not_made_wider() -> None:
    found = feet(street_through_junction())
    np.testing.assert_allclose(np.abs(found[:, :, 1]), 5.0, atol=1e-6)


def test_no_wall_stands_in_a_junction() -> None:
    inside = (feet(street_through_junction())[:, :, 0] > 50.1) & (feet(street_through_junction())[:, :, 0] < 69.9)
    assert not inside.any()


def test_between_the_two_directions_of_a_street_stands_no_wall() -> None:
    one_way = [
        road(number, 100.0, line(0, x, 0, heading, 100), section(right=lane(-1)))
        for number, x, heading in ((1, 0, 0), (2, 100, 3.141592653589793))
    ]
    found = feet(opendrive(*one_way), beyond_m=0.0)
    assert len(found) > 0
    np.testing.assert_allclose(np.abs(found[:, :, 1]), 3.5, atol=1e-6)


def test_a_wall_on_a_slope_climbs_with_it() -> None:
    scene = walls(feet(STEEP), 1.0)
    low, high = (scene.boxes["centre"][:, 2] + sign * scene.boxes["half"][:, 2] for sign in (-1.0, 1.0))
    road_m = 0.1 * scene.boxes["centre"][:, 0]
    assert (np.abs(low - road_m) < 0.3).all()
    assert (np.abs(high - road_m - 1.0) < 0.3).all()
    assert (scene.boxes["half"][:, 1] == HALF_THICKNESS_M).all()


def test_walls_are_part_of_the_scenery_where_they_were_asked_for() -> None:
    library = MapLibrary()
    with_walls = scenery_of(library.from_opendrive(PLAIN, wall_height_m=1.0))
    assert set(with_walls.statics.tag.tolist()) == {SemanticTag.WALLS}
    assert len(scenery_of(library.from_opendrive(PLAIN)).statics.id) == 0
