"""A route along streets becomes lanes; one that cannot be driven is refused with a sentence."""

import math
from itertools import pairwise
from typing import Any

import pytest
from lxml import etree

from linden.errors import UserError
from linden_maps.streets.build import Built
from linden_maps.streets.routes import SPACING_M, drive, positions, xml
from linden_maps.streets.street_facts import Route

WEST, MIDDLE, EAST, NORTH = (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0), (0.0, 100.0)


@pytest.fixture
def cross(built_of: Any, sketch: Any) -> Built:
    stop = sketch.point("shuttle_stop", "S1", (0.0, 60.0), street_id="north", forward=True)
    found: Built = built_of([*sketch.crossing(), stop])
    return found


def route_through(built: Built, *streets: tuple[str, bool], stops: tuple[str, ...] = ()) -> Route:
    """A route over half streets: id of the street, and whether its second half is meant, always driven outward last."""
    edges = [edge for edge in built.network.edges if edge.points]
    points: list[tuple[float, float]] = []
    for street, second in streets:
        part = [edge.points for edge in edges if edge.street.id == street][second]
        part = part if not points or part[0] == points[-1] else part[::-1]
        points += part if not points else part[1:]
    return Route("way", tuple(points), closed=False, stops=stops)


def test_a_left_turn_is_driven_in_lane_middles(cross: Built) -> None:
    driven = drive(cross, route_through(cross, ("east", False), ("north", True)))
    steps = [math.dist(a.pose[:2], b.pose[:2]) for a, b in pairwise(driven.samples)]
    assert max(steps) < 1.1
    first, last = driven.samples[0], driven.samples[-1]
    # right of the axis, which parked cars push 1.05 m to the left of the street's middle
    assert first.pose.y_m == pytest.approx(1.05 - 1.45, abs=0.01)
    assert last.pose.x_m == pytest.approx(-1.05 + 1.45, abs=0.01)
    assert driven.length_m == pytest.approx(200.0 - 20.0, abs=8.0)


def test_positions_lie_outside_junctions_and_not_far_apart(cross: Built) -> None:
    driven = drive(cross, route_through(cross, ("east", False), ("north", True)))
    found = positions(driven)
    assert not any(sample.in_junction for sample in found)
    gaps = [b.driven_m - a.driven_m for a, b in pairwise(found)]
    assert max(gaps) <= SPACING_M + 1.0
    assert (found[0], found[-1]) == (driven.samples[0], driven.samples[-1])


def test_the_file_is_one_that_scenariorunner_reads(cross: Built) -> None:
    text = xml(cross, route_through(cross, ("east", False), ("north", True), stops=("S1",)), 3)
    route = etree.fromstring(text).find("route")
    assert route is not None
    assert (route.get("id"), route.get("town")) == ("3", "Town")
    assert route.find("scenarios") is not None
    last = route.findall("waypoints/position")[-1]
    assert float(last.get("y", "")) == pytest.approx(-89.0, abs=1.5)  # CARLA's y points south
    (stop,) = route.findall("stops/stop")
    assert (stop.get("id"), float(stop.get("yaw", ""))) == ("S1", pytest.approx(-90.0, abs=0.1))


def test_a_route_off_the_streets_is_refused(cross: Built) -> None:
    ends = cross.network.edges[0].points[0], cross.network.edges[3].points[-1]
    with pytest.raises(UserError, match="route way: no street runs through its points 1 to 2"):
        drive(cross, Route("way", ends, closed=False, stops=()))


def test_a_route_that_begins_between_junctions_is_refused(cross: Built) -> None:
    with pytest.raises(UserError, match="it must begin and end where streets meet"):
        drive(cross, Route("way", ((3.0, 3.0), (5.0, 5.0)), closed=False, stops=()))


def test_a_route_against_a_one_way_street_is_refused(built_of: Any, sketch: Any) -> None:
    features = sketch.crossing()
    features[1]["properties"].update(oneway="forward", lanes=1)
    built = built_of(features)
    with pytest.raises(UserError, match="turning from east Street into north Street is not allowed"):
        drive(built, route_through(built, ("east", False), ("north", False)))


def test_a_stop_on_the_other_side_of_the_street_is_refused(built_of: Any, sketch: Any) -> None:
    stop = sketch.point("shuttle_stop", "S1", (0.0, 60.0), street_id="north", forward=False)
    built = built_of([*sketch.crossing(), stop])
    with pytest.raises(UserError, match="stop S1: the route does not pass it in its direction"):
        drive(built, route_through(built, ("east", False), ("north", True), stops=("S1",)))


def test_an_unknown_stop_is_refused(cross: Built) -> None:
    with pytest.raises(UserError, match="route way: no shuttle stop has the id 'S7'"):
        drive(cross, route_through(cross, ("east", False), ("north", True), stops=("S7",)))
