from importlib import resources

import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.lanelet2.bus_stops import shuttle_stops
from linden_maps.lanelet2.convert import Wanted, convert
from linden_maps.lanelet2.second_reader import routes_of
from tracing import untraced_here


@pytest.fixture(scope="session")
def linden():
    return parse((resources.files("linden") / "data" / "Linden.xodr").read_bytes())


@pytest.fixture(scope="session")
def linden_lanelets(linden):
    with untraced_here():  # ``linden_everything`` takes the same lines
        return convert(linden)


@pytest.fixture(scope="session")
def linden_routes(linden_lanelets):
    """What the second reader finds in it."""
    with untraced_here():
        return routes_of(linden_lanelets.lanelet_map)


@pytest.fixture(scope="session")
def linden_everything(linden):
    """Linden with every choice of a Lanelet2 map."""
    return convert(linden, Wanted(pairwise_priority=True, roundabouts=True, stops=shuttle_stops(linden.geo_origin)))
