"""Elements without a length that counts are left out, with a line in the log; the rest of the map is read."""

import logging

import carla
import pytest

from fakes.ring_map import ring
from linden.maps.derivation import facts_of
from linden.maps.opendrive.limits import MapError
from linden.maps.opendrive.parse import parse

TINY_ROAD = (
    '<road name="" length="2e-07" id="7" junction="-1"><planView><geometry s="0" x="0" y="0" hdg="0" length="2e-07">'
    '<line/></geometry></planView><lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>'
    '<lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>'
    "</road>"
)


def with_tiny_road() -> str:
    """The ring, with a road of 0.2 micrometres, as a public map of Town03 has it."""
    return ring().replace("</OpenDRIVE>", TINY_ROAD + "</OpenDRIVE>")


def test_a_tiny_road_is_left_out_and_named(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "linden"):
        found = parse(with_tiny_road())
    assert [road.id for road in found.roads] == [1, 2]
    assert "road 7 is 2e-07 m long and is left out" in caplog.text
    assert len(facts_of(with_tiny_road()).lanes) == len(facts_of(ring()).lanes)


def test_the_official_clients_map_reads_such_a_file_too() -> None:
    assert len(carla.Map("Ring", with_tiny_road()).get_topology()) >= len(carla.Map("Ring", ring()).get_topology())


def test_pieces_without_length_are_left_out(caplog: pytest.LogCaptureFixture) -> None:
    empty = '<geometry s="0" x="0" y="0" hdg="0" length="0"><line/></geometry>'
    section = '<laneSection s="0"><center><lane id="0" type="none"/></center></laneSection>'
    text = ring().replace("<planView>", "<planView>" + empty).replace("<lanes>", "<lanes>" + section)
    with caplog.at_level(logging.WARNING, "linden"):
        found = parse(text)
    plain = parse(ring())
    assert [road.geometries for road in found.roads] == [road.geometries for road in plain.roads]
    assert [road.sections for road in found.roads] == [road.sections for road in plain.roads]
    assert caplog.text.count("a <geometry> without length is left out") == 2
    assert caplog.text.count("a <laneSection> without length at s=0 m is left out") == 2


def test_a_road_of_negative_length_is_refused() -> None:
    with pytest.raises(MapError, match="length"):
        parse(with_tiny_road().replace('length="2e-07" id', 'length="-1" id'))
