"""Lanes are drawn in fewer places than they were sampled in, and are still where they were."""

import numpy as np
import pytest

from linden.geometry import points_from_opendrive
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.parse import parse
from linden.scenery.streets.simplified_lanes import ABOVE_M, ASIDE_M, LONGEST_M, SimplifiedLanes, simplified_lanes
from opendrive_texts import lane, line, opendrive, road

LENGTH_M = 90.0
HILL = '<elevation s="0" a="2" b="0" c="0.0008" d="-0.000004"/>'


def street(shape: str = "<line/>", elevation: str = "") -> str:
    lanes = "".join(lane(number) for number in (-1, -2))
    section = f'<laneSection s="0"><center><lane id="0" type="none"/></center><right>{lanes}</right></laneSection>'
    return opendrive(road(1, LENGTH_M, line(0, 0, 0, 0, LENGTH_M, shape), section, elevation=elevation))


def away_m(text: str) -> tuple[float, float, SimplifiedLanes]:
    """How far, aside and upwards, the sampled edges lie from the pieces that are drawn, at most."""
    drawn, strips = simplified_lanes(parse(text)), strips_of(simplified_lanes(parse(text)).tables)
    aside, above = 0.0, 0.0
    for kept, sampled in zip((drawn.inner, drawn.outer), edges_of(drawn.tables, strips), strict=True):
        for row in range(len(drawn.tables.lanes)):
            line_m = kept[drawn.lane == row]
            for point in points_from_opendrive(sampled)[strips.lane == row]:
                begin, ahead = line_m[:-1], np.diff(line_m, axis=0)
                share = np.einsum("ij,ij->i", (point - begin)[:, :2], ahead[:, :2]) / (ahead[:, :2] ** 2).sum(axis=1)
                off = point - begin - np.clip(share, 0.0, 1.0)[:, None] * ahead
                nearest = np.hypot(off[:, 0], off[:, 1]).argmin()
                aside = max(aside, float(np.hypot(*off[nearest, :2])))
                above = max(above, float(abs(off[nearest, 2])))
    return aside, above, drawn


@pytest.mark.parametrize("shape", ["<line/>", '<arc curvature="0.01"/>', '<spiral curvStart="0" curvEnd="0.05"/>'])
@pytest.mark.parametrize("elevation", ["", HILL])
def test_every_sampled_place_lies_on_what_is_drawn(shape: str, elevation: str) -> None:
    aside, above, _ = away_m(street(shape, elevation))
    assert aside <= ASIDE_M + 1e-9
    assert above <= ABOVE_M + 1e-9


def test_a_straight_street_is_drawn_in_few_pieces_of_bounded_length() -> None:
    _, _, drawn = away_m(street())
    places_m = drawn.s_m[drawn.lane == 0]
    assert len(places_m) <= 5  # of ten samples
    assert 0.3 * LONGEST_M < np.diff(places_m).max() <= LONGEST_M


def test_lanes_side_by_side_share_their_places_so_that_no_crack_opens() -> None:
    drawn = simplified_lanes(parse(street('<spiral curvStart="0" curvEnd="0.05"/>', HILL)))
    first, second = (drawn.lane == row for row in (0, 1))
    np.testing.assert_array_equal(drawn.outer[first], drawn.inner[second])


def test_a_lane_ends_where_its_road_does() -> None:
    drawn = simplified_lanes(parse(street('<arc curvature="0.02"/>')))
    for row in (0, 1):
        places = drawn.s_m[drawn.lane == row]
        assert (places[0], places[-1]) == (0.0, LENGTH_M)
        assert (np.diff(places) > 0.0).all()
    assert drawn.continues.tolist() == [*(np.diff(drawn.lane) == 0).tolist(), False]


def test_a_map_without_roads_has_nothing_to_draw() -> None:
    drawn = simplified_lanes(parse(opendrive("")))
    assert len(drawn.lane) == len(drawn.inner) == len(drawn.samples.s_m) == 0
