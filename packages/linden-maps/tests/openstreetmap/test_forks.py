"""Claims about extracts whose streets meet at any angle: each one builds, and readers take what is built."""

import pytest

from fakes import osm_forks
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from linden_maps.checks.check import Severity, check
from linden_maps.openstreetmap.convert import convert
from linden_maps.streets.build import Built, assembled
from linden_maps.streets.geojson import read
from linden_maps.streets.writing import text


def built(extract: bytes) -> Built:
    return assembled(read(convert(extract, "extract.osm").streets))


def parsed(extract: bytes) -> OpenDrive:
    return parse(text(built(extract).document))


@pytest.mark.parametrize("angle_deg", [1.0, 4.0, 8.0, 11.0, 14.0, 17.0, 30.0, 170.0, 179.0])
@pytest.mark.parametrize("width_m", ["8", "25"])
def test_a_street_may_leave_another_at_any_angle(angle_deg: float, width_m: str) -> None:
    assert len(parsed(osm_forks.fork(angle_deg, width=width_m)).roads) > 20


@pytest.mark.parametrize(("apart_m", "over_m"), [(4.0, 5.0), (8.0, 20.0), (15.0, 60.0), (30.0, 120.0)])
def test_carriageways_may_join(apart_m: float, over_m: float) -> None:
    assert parsed(osm_forks.joining_carriageways(apart_m, over_m)).junctions


def test_a_star_of_24_streets_has_no_pavement_in_a_lane() -> None:
    opendrive = parsed(osm_forks.star(range(0, 360, 15)))
    assert len(opendrive.junctions) == 25  # the middle, and a turning circle at each end
    assert not [one for one in check(opendrive) if one.severity is not Severity.NOTE]


def test_a_way_that_is_mapped_twice_is_built_once() -> None:
    imported = convert(osm_forks.mapped_twice(), "extract.osm")
    assert imported.left_out["pieces of street that are mapped twice"] == 2
    assert {one.street.id for one in built(osm_forks.mapped_twice()).network.edges} == {"1.1", "1.2", "3"}


@pytest.mark.parametrize("seed", range(24))
def test_any_tangle_of_streets_builds(seed: int) -> None:
    assert parsed(osm_forks.tangle(seed)).roads
