"""A GeoJSON file of streets is checked once. Each error is a sentence that names the feature."""

import copy
from typing import Any

import pytest

from linden.errors import UserError
from linden_maps.streets.cross_section import of_street
from linden_maps.streets.geojson import read
from linden_maps.streets.street_facts import Control


def test_points_lie_in_metres_about_the_origin(facts_of: Any, sketch: Any) -> None:
    east = facts_of(sketch.crossing()).streets[0]
    assert east.points[1] == (0.0, 0.0)
    assert east.points[2] == pytest.approx((100.0, 0.0), abs=0.1)


def test_controls_and_stop_streets_are_read(facts_of: Any, sketch: Any) -> None:
    found = facts_of(sketch.crossing("two_way_stop", stop_controlled_streets=["north Street"])).intersections[0]
    assert found.control is Control.TWO_WAY_STOP
    assert found.stops == {"north Street"}


def test_confidence_of_each_fact_is_kept(facts_of: Any, sketch: Any) -> None:
    features = [sketch.street("a", (0.0, 0.0), (50.0, 0.0), width_confidence="one source")]
    assert facts_of(features).streets[0].confidences == (
        ("confidence", "estimated"),
        ("width_confidence", "one source"),
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"name": None}, "street a: the property `name` is missing"),
        ({"street_class": "motorway"}, "street a: `street_class` is 'motorway'; it can be 'arterial', "),
        ({"width_m": "wide"}, "street a: `width_m` is 'wide'; it must be a number above 0"),
        ({"width_m": float("nan")}, "street a: `width_m` is nan; it must be a number above 0"),
        ({"speed_limit_mph": -3}, "street a: `speed_limit_mph` is -3; it must be a number above 0"),
        ({"lanes": True}, "street a: `lanes` is True; it must be a number above 0"),
        ({"lanes": 1.5}, "street a: 1.5 lanes do not fit"),
        ({"width_m": 3.0}, "street a: 2 lanes do not fit between kerbs 3.0 m apart"),
        ({"oneway": "backward"}, "street a: `oneway` is 'backward'; it can be 'no', 'forward'"),
    ],
)
def test_a_wrong_street_is_refused(sketch: Any, change: dict[str, object], sentence: str) -> None:
    with pytest.raises(UserError) as refused:
        read(sketch.collection([sketch.street("a", (0.0, 0.0), (50.0, 0.0), **change)]))
    assert str(refused.value).startswith(sentence)


@pytest.mark.parametrize(
    ("geometry", "sentence"),
    [
        (None, "street a: its geometry is None; it must be a LineString"),
        ({"type": "Point", "coordinates": [0, 0]}, "street a: its geometry is 'Point'; it must be a LineString"),
        ({"type": "LineString", "coordinates": [[0, 0]]}, "street a: it needs two points at least"),
        ({"type": "LineString", "coordinates": [[0, 0], [0, 0]]}, "street a: it needs two points at least"),
        ({"type": "LineString", "coordinates": "here"}, "street a: its coordinates are not pairs"),
        ({"type": "LineString"}, "street a: its coordinates are not pairs"),
        ({"type": "LineString", "coordinates": [[500, 0], [0, 0]]}, "street a: its coordinates are not degrees"),
    ],
)
def test_a_wrong_geometry_is_refused(sketch: Any, geometry: object, sentence: str) -> None:
    feature = sketch.street("a", (0.0, 0.0), (50.0, 0.0))
    feature["geometry"] = geometry
    with pytest.raises(UserError) as refused:
        read(sketch.collection([feature]))
    assert str(refused.value).startswith(sentence)


@pytest.mark.parametrize(
    ("document", "sentence"),
    [
        ([], "this is not a GeoJSON FeatureCollection"),
        ({"type": "Feature"}, "this is not a GeoJSON FeatureCollection"),
        ({"type": "FeatureCollection", "features": []}, "the file holds no feature of the kind `street`"),
        ({"type": "FeatureCollection", "features": [3]}, "feature 1 has no properties"),
    ],
)
def test_a_file_without_streets_is_refused(document: object, sentence: str) -> None:
    with pytest.raises(UserError) as refused:
        read(document)
    assert str(refused.value).startswith(sentence)


def test_an_unknown_control_is_refused(sketch: Any) -> None:
    with pytest.raises(UserError, match="intersection middle: `control` is 'magic'; it can be 'signal', "):
        read(sketch.collection(sketch.crossing("magic")))


def test_a_stop_for_a_street_that_is_not_there_is_refused(sketch: Any) -> None:
    with pytest.raises(UserError, match="names 'Elm Street', which is no street"):
        read(sketch.collection(sketch.crossing("two_way_stop", stop_controlled_streets=["Elm Street"])))


def test_two_streets_with_one_id_are_refused(sketch: Any) -> None:
    one = sketch.street("a", (0.0, 0.0), (50.0, 0.0))
    with pytest.raises(UserError, match="two streets share an id"):
        read(sketch.collection([one, copy.deepcopy(one)]))


def test_a_shuttle_stop_on_an_unknown_street_is_refused(sketch: Any) -> None:
    stop = sketch.point("shuttle_stop", "S9", (0.0, 0.0), street_id="nowhere")
    with pytest.raises(UserError, match="shuttle_stop S9: no street has the id 'nowhere'"):
        read(sketch.collection([*sketch.crossing(), stop]))


def test_a_limit_is_given_in_one_unit(sketch: Any) -> None:
    one = sketch.street("a", (0.0, 0.0), (100.0, 0.0), speed_limit_mph=None, speed_limit_kmh=30)
    assert read(sketch.collection([one])).streets[0].speed_limit == (30.0, "km/h")
    with pytest.raises(UserError, match="street a: it has speed_limit_mph and speed_limit_kmh; keep the one"):
        read(sketch.collection([sketch.street("a", (0.0, 0.0), (100.0, 0.0), speed_limit_kmh=30)]))


def test_a_width_beyond_all_streets_is_named(sketch: Any) -> None:
    with pytest.raises(UserError, match="street a: `width_m` is 1e\\+09; a street has at most 100 m between kerbs"):
        read(sketch.collection([sketch.street("a", (0.0, 0.0), (100.0, 0.0), width_m=1e9)]))


def test_streets_of_two_continents_are_refused(sketch: Any) -> None:
    far = sketch.street("b", (0.0, 0.0), (100.0, 0.0))
    far["geometry"]["coordinates"] = [[13.4, 52.5], [13.41, 52.5]]
    with pytest.raises(UserError, match=r"the streets a and b lie .* apart; a map has at most 50 km"):
        read(sketch.collection([sketch.street("a", (0.0, 0.0), (100.0, 0.0)), far]))


def test_cycle_lanes_run_between_traffic_and_what_is_parked(sketch: Any) -> None:
    one = sketch.street("a", (0.0, 0.0), (100.0, 0.0), width_m=14.0, cycle_lanes="both")
    section = of_street(read(sketch.collection([one])).streets[0])
    assert [lane.kind for lane in section.right[:3]] == ["driving", "biking", "parking"]
    assert [lane.kind for lane in section.left[:3]] == ["driving", "biking", "parking"]
    assert section.paved_m(section.left) + section.paved_m(section.right) == pytest.approx(14.0)
    narrow = sketch.street("a", (0.0, 0.0), (100.0, 0.0), width_m=6.0, cycle_lanes="both")
    with pytest.raises(UserError, match=r"2 lanes and cycle lanes of 1\.5 m do not fit between kerbs 6\.0 m apart"):
        read(sketch.collection([narrow]))
