"""Claims about right_of_way elements: complete where they stand, for each lanelet that lights let turn."""

from collections import Counter, defaultdict
from itertools import permutations

import numpy as np
import pytest

from linden_maps.lanelet2.claims import MET_SHARE, complete_claims
from linden_maps.lanelet2.model import bounds_of
from linden_maps.lanelet2.movements import Movement
from linden_maps.lanelet2.overlap import overlap_share

WEST_EAST, SOUTH_NORTH = ((-10.0, 0.0), (10.0, 0.0)), ((0.0, -10.0), (0.0, 10.0))


def _way(stretch: int, ends: tuple, origin: int, turn_rad: float = 0.0, z_m: float = 0.0) -> Movement:
    line = np.array([(*ends[0], z_m), (*ends[1], z_m)])
    ahead = line[1] - line[0]
    return Movement(
        stretch, stretch, line, 3.0, float(np.arctan2(ahead[1], ahead[0])), turn_rad, frozenset({origin}), True
    )


def _ring(way: Movement) -> np.ndarray:
    ahead = way.line[1, :2] - way.line[0, :2]
    left = 1.5 * np.array([-ahead[1], ahead[0]]) / np.linalg.norm(ahead)
    return np.array([way.line[0, :2] + left, way.line[1, :2] + left, way.line[1, :2] - left, way.line[0, :2] - left])


def _claims(ways: list[Movement], waiting: dict[int, list[int]], lit: frozenset[int] = frozenset()) -> dict:
    return complete_claims(ways, {way.stretch: _ring(way) for way in ways}, waiting, lit)


def test_the_way_that_all_others_let_go_first_has_the_element() -> None:
    ways = [_way(0, WEST_EAST, 10), _way(1, SOUTH_NORTH, 11)]
    assert _claims(ways, {0: [1]}) == {0: [1]}


def test_a_way_that_has_to_wait_for_one_of_two_has_none() -> None:
    ways = [_way(0, WEST_EAST, 10), _way(1, SOUTH_NORTH, 11), _way(2, SOUTH_NORTH[::-1], 12)]
    assert _claims(ways, {0: [1], 2: [0]}) == {}


def test_ways_of_one_origin_do_not_meet() -> None:
    ways = [_way(0, WEST_EAST, 10), _way(1, SOUTH_NORTH, 10)]
    assert _claims(ways, {}) == {}


def test_a_bridge_does_not_meet_what_lies_below() -> None:
    below, above = _way(0, WEST_EAST, 10), _way(1, SOUTH_NORTH, 11, z_m=6.0)
    assert _claims([below, above], {1: [0]}) == {0: [1]}  # one element stands for the junction, and changes nothing


def test_lights_of_one_axis_hold_nothing() -> None:
    ways = [_way(0, WEST_EAST, 10, turn_rad=-1.5), _way(1, WEST_EAST[::-1], 11)]
    assert _claims(ways, {0: [1]}, frozenset({0, 1})) == {}


def test_lights_across_hold_what_crosses() -> None:
    ways = [_way(0, WEST_EAST, 10, turn_rad=1.5), _way(1, SOUTH_NORTH, 11)]
    assert _claims(ways, {0: [1], 1: [0]}, frozenset({0, 1})) == {0: [1], 1: [0]}


@pytest.mark.unmeasured
def test_linden_s_elements_without_lights_name_every_way_that_is_met(linden_lanelets) -> None:
    lanelet_map = linden_lanelets.lanelet_map
    stretches = dict(zip(linden_lanelets.lanelet_of, linden_lanelets.network.stretches, strict=True))
    number_of = {lanelet: nth for nth, lanelet in enumerate(linden_lanelets.lanelet_of)}
    before = {}
    for nth, after in enumerate(linden_lanelets.network.successors):
        for following in after:
            before.setdefault(following, set()).add(nth)
    rings = {}
    for lanelet, stretch in stretches.items():
        if stretch.subtype == "road" and stretch.junction_id >= 0:
            sides = bounds_of(lanelet_map, lanelet_map.relations[lanelet])
            rings[lanelet] = np.array([lanelet_map.nodes[n][:2] for n in (*sides.left, *sides.right[::-1])])
    lights = {number for number, _ in lanelet_map.elements("traffic_light")}
    yielding = {
        element.refs("right_of_way")[0]: set(element.refs("yield"))
        for _, element in lanelet_map.elements("right_of_way")
    }
    by_junction: dict[int, list[int]] = defaultdict(list)
    for lanelet in rings:
        by_junction[stretches[lanelet].junction_id].append(lanelet)
    wrong = []
    for one, other in (pair for inside in by_junction.values() for pair in permutations(inside, 2)):
        lit = not lights.isdisjoint(lanelet_map.relations[one].refs("regulatory_element"))
        if one not in yielding or lit or before[number_of[one]] & before[number_of[other]]:
            continue
        share = overlap_share(rings[one], rings[other])
        if abs(share - MET_SHARE) > 1e-3 and (share > MET_SHARE) != (other in yielding[one]):
            wrong.append((one, other, share))
    assert wrong == []
    assert len(yielding) > 200


def test_linden_s_intersections_all_have_an_element(linden_lanelets) -> None:
    lanelet_map = linden_lanelets.lanelet_map
    areas = Counter()
    for _, lanelet in lanelet_map.lanelets("road"):
        if "intersection_area" in lanelet.tags:
            elements = [lanelet_map.relations[ref].tags["subtype"] for ref in lanelet.refs("regulatory_element")]
            areas[lanelet.tags["intersection_area"]] += "right_of_way" in elements
    assert len(areas) == 120
    assert min(areas.values()) > 0
    assert all(element.refs("yield") for _, element in lanelet_map.elements("right_of_way"))


def test_pairwise_priority_says_more(linden_everything, linden_lanelets) -> None:
    everything = linden_everything.lanelet_map
    pairs = {
        (element.refs("right_of_way")[0], other)
        for _, element in everything.elements("right_of_way")
        for other in element.refs("yield")
    }
    kept = {
        (element.refs("right_of_way")[0], other)
        for _, element in linden_lanelets.lanelet_map.elements("right_of_way")
        for other in element.refs("yield")
    }
    assert kept < pairs
