"""Claims about bridges and tunnels: streets that cross at different levels lie above each other."""

import pytest

from fakes import osm_forks
from linden.maps.opendrive.parse import parse
from linden_maps.checks.check import Severity, check
from linden_maps.openstreetmap.convert import convert
from linden_maps.streets.build import Built, assembled
from linden_maps.streets.document import value
from linden_maps.streets.geojson import read
from linden_maps.streets.levels import LEVEL_M
from linden_maps.streets.writing import text


def built(**options: str) -> Built:
    return assembled(read(convert(osm_forks.bridge(**options), "extract.osm").streets))


@pytest.mark.parametrize(
    ("options", "level"),
    [({}, 1), ({"layer": "2"}, 2), ({"layer": "-1", "kind": "tunnel"}, -1), ({"layer": "no", "kind": "tunnel"}, -1)],
)
def test_a_bridge_lies_above_the_street_it_crosses_and_a_tunnel_below(options: dict[str, str], level: int) -> None:
    found = built(**options)
    roads = {edge.street.id: road for edge, road in zip(found.network.edges, found.roads, strict=True) if road}
    assert {round(value(roads["2"].elevation, s_m), 3) for s_m in (0.0, 10.0, 40.0)} == {level * LEVEL_M}
    assert value(roads["4"].elevation, 120.0) == 0.0
    assert abs(value(roads["1"].elevation, 30.0)) < LEVEL_M / 2
    assert found.over == (("2", "4"),)


def test_streets_at_one_height_are_named_where_they_cross_without_a_point() -> None:
    assert built().through == (("4", "5"),)


def test_ramps_are_streets_and_nothing_overlaps_under_a_bridge() -> None:
    findings = [one for one in check(parse(text(built().document))) if one.severity is not Severity.NOTE]
    assert {one.kind for one in findings} <= {"overlap"}  # of the two streets at one height
    assert all(abs(one.y_m - 100.0) < 20.0 for one in findings)
