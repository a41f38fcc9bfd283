"""Claims about counting; where LibCarla counts too, it counts the same."""

from importlib import resources

import carla
import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.statistics import count
from opendrive_texts import signal, street_through_junction


def test_a_small_map_is_counted_by_hand() -> None:
    counts = count(parse(street_through_junction(signals=signal("7", 48.0, -5.8) + signal("8", 47.0, 5.8, "1000001"))))
    assert (counts.roads, counts.connecting_roads, counts.junctions, counts.lanes) == (4, 2, 1, 10)
    assert (counts.signals, counts.stop_signs, counts.traffic_lights) == (2, 1, 1)
    assert counts.street_names == 2
    assert counts.road_km == pytest.approx(0.11)
    assert counts.driving_lane_km == pytest.approx(0.26)
    assert counts.sidewalk_km == pytest.approx(0.22)


@pytest.mark.parametrize(
    "text", [street_through_junction(), (resources.files("linden") / "data" / "Linden.xodr").read_text()]
)
def test_libcarla_counts_the_same(text: str) -> None:
    theirs, ours = carla.Map("test", text), count(parse(text))
    landmarks = list({mark.id: mark.type for mark in theirs.get_all_landmarks()}.values())  # references repeat an id
    assert ours.topology == len(theirs.get_topology())
    assert ours.signals == len(landmarks)
    assert ours.stop_signs == landmarks.count("206")
    assert ours.yield_signs == landmarks.count("205")
    assert ours.driving_lane_km == pytest.approx(len(theirs.generate_waypoints(2.0)) * 2.0 / 1000.0, rel=0.1)
