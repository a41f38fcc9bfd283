"""Maps with very many records are read in a time that grows with their size, and what is refused lets go of memory."""

import sys
from pathlib import Path
from threading import Event

import pytest

sys.path.insert(0, str(Path(__file__).parents[4] / "tests"))

from fakes.crafted_maps import opendrive
from linden.background import NotWantedError, in_background
from linden.errors import Refusal
from linden.maps.facts import derive
from linden.maps.library import MapLibrary
from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.limits import MapError
from linden.maps.opendrive.links import ends_of_roads, lane_links
from linden.maps.opendrive.parse import parse


def test_lanes_of_one_road_lead_to_its_last_section() -> None:
    text = opendrive("stop signs and lane sections", 200)
    road = parse(text)
    ends = ends_of_roads(tables_of(road), lane_links(road))
    assert set(ends.tolist()) == {199}


def test_a_link_to_a_lane_that_there_is_nowhere_leads_nowhere() -> None:
    road = parse(opendrive("lane sections, links to nowhere", 50))
    assert not any(lane_links(road).successors)


def test_many_pieces_of_lanes_in_one_place_are_refused_and_fewer_are_read() -> None:
    assert len(derive(opendrive("roads on one place", 1500)).lanes) == 1500
    with pytest.raises(MapError, match="pieces of lanes in one place"):
        derive(opendrive("roads on one place", 3000))


def test_a_map_is_given_up_when_it_is_not_wanted_any_more() -> None:
    unwanted = Event()
    unwanted.set()
    text = opendrive("lane sections", 5000)
    with pytest.raises(NotWantedError):
        in_background(lambda: derive(text), unwanted).result(60)


def test_a_refusal_holds_no_frame_of_the_work() -> None:
    text = opendrive("roads on one place", 3000)
    error = in_background(lambda: MapLibrary().from_opendrive(text)).exception(60)
    assert isinstance(error, Refusal)
    assert error.__traceback__ is None
    assert error.__cause__ is None
