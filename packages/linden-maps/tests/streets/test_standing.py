"""Claims about features beside streets: crossings, buildings, furniture, and streets that give way."""

from typing import Any

import pytest

from linden.errors import UserError
from linden_maps.streets.standing import CLEAR_M


def house(
    sketch: Any, identity: str, left_m: float, low_m: float, right_m: float, high_m: float, **changes: Any
) -> Any:
    """A building's feature: a rectangle of the sketch."""
    corners = [(left_m, low_m), (right_m, low_m), (right_m, high_m), (left_m, high_m), (left_m, low_m)]
    feature = sketch.point("building", identity, (0.0, 0.0), **{"height_m": 6.0, **changes})
    places = [sketch.point("x", "x", corner)["geometry"]["coordinates"] for corner in corners]
    feature["geometry"] = {"type": "Polygon", "coordinates": [places]}
    return feature


def named(built: Any, kind: str) -> list[Any]:
    return [thing for road in built.document.roads for thing in road.objects if thing.kind == kind]


def test_a_footprint_that_reaches_onto_a_street_is_cut_back(built_of: Any, sketch: Any) -> None:
    built = built_of([*sketch.crossing(), house(sketch, "near", 40.0, 0.0, 50.0, 12.0)])
    (thing,) = named(built, "building")
    across = [v for _, v in thing.outline]
    kerb_m = 7.9 / 2
    assert max(across) - min(across) == pytest.approx(12.0 - kerb_m - CLEAR_M, abs=0.1)
    assert built.left_out == ()


def test_a_footprint_on_a_street_is_left_out(built_of: Any, sketch: Any) -> None:
    built = built_of([*sketch.crossing(), house(sketch, "on", 40.0, -4.0, 50.0, 5.0)])
    assert (named(built, "building"), built.left_out) == ([], ("on",))


def test_furniture_stands_along_its_street(built_of: Any, sketch: Any) -> None:
    bench = sketch.point("furniture", "1", (30.0, 6.0))
    bench["properties"]["kind"] = "bench"
    (thing,) = named(built_of([*sketch.crossing(), bench]), "obstacle")
    assert thing.name == "bench"
    us, vs = zip(*thing.outline, strict=True)
    assert (max(us) - min(us), max(vs) - min(vs)) == pytest.approx((1.8, 0.6), abs=0.01)


def test_a_crossing_near_a_junction_crosses_the_leg_before_the_stop_line(built_of: Any, sketch: Any) -> None:
    crossing = sketch.point("crossing", "1", (15.0, 0.0), street_id="east")
    features = [*sketch.crossing("two_way_stop", stop_controlled_streets=["east"]), crossing]
    built = built_of(features)
    (walk,) = named(built, "crosswalk")
    road = next(road for road in built.document.roads if walk in road.objects)
    line = next(thing for thing in road.objects if thing.name == "StopLine")
    assert line.s_m > walk.s_m  # the road begins at the junction, so its traffic comes from farther along


def test_streets_named_by_their_id_give_way(built_of: Any, sketch: Any) -> None:
    built = built_of(sketch.crossing("give_way", stop_controlled_streets=["north"]))
    signs = [(road.name, sign.kind) for road in built.document.roads for sign in road.signals]
    assert signs == [("north Street", "205")] * 2


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"height_m": 0}, "building b: `height_m` is 0; it must be a number above 0"),
        ({"height_m": None}, "building b: the property `height_m` is missing"),
    ],
)
def test_a_building_without_height_is_refused(change: Any, sentence: str, built_of: Any, sketch: Any) -> None:
    with pytest.raises(UserError, match=sentence):
        built_of([*sketch.crossing(), house(sketch, "b", 40.0, 10.0, 50.0, 20.0, **change)])


def test_an_outline_that_is_open_is_refused(built_of: Any, sketch: Any) -> None:
    feature = house(sketch, "b", 40.0, 10.0, 50.0, 20.0)
    feature["geometry"]["coordinates"][0].pop()
    with pytest.raises(UserError, match="building b: its outline needs three corners, and the first one again"):
        built_of([*sketch.crossing(), feature])


@pytest.mark.parametrize("forward", [0, 3, "two"])
def test_lanes_of_a_direction_are_no_more_than_all(forward: Any, built_of: Any, sketch: Any) -> None:
    with pytest.raises(UserError, match=r"`lanes_forward` is .*; it is a whole number from 1 to 2"):
        built_of([sketch.street("a", (0.0, 0.0), (90.0, 0.0), lanes_forward=forward)])
