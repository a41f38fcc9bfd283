"""Claims about name signs of streets and places: where they stand, what they say, and that only facts ask for them."""

import math
from collections import Counter
from typing import Any

import pytest

from linden_maps.streets.build import Built, assembled
from linden_maps.streets.controls import POST_TO_KERB_M
from linden_maps.streets.cross_section import KERB_M, PAVED
from linden_maps.streets.curves import length, moved, pose_at
from linden_maps.streets.document import Object
from linden_maps.streets.geojson import read
from linden_maps.streets.name_signs import BLADE, NAME, PLACE_NAME


def signs(built: Built, name: str = NAME) -> list[tuple[Any, Object]]:
    return [(road, thing) for road in built.document.roads for thing in road.objects if thing.name == name]


def built(sketch: Any, **changes: object) -> Built:
    features = sketch.crossing()
    for feature in features[:2]:
        feature["properties"] |= changes
    return assembled(read(sketch.collection(features, street_name_signs="estimated")))


def test_a_crossing_of_two_named_streets_has_one_sign_with_both_names(sketch: Any) -> None:
    ((road, sign),) = signs(built(sketch))
    names = {note[1].partition(" ")[2]: float(note[1].partition(" ")[0]) for note in sign.notes}
    assert set(names) == {"east Street", "north Street"}
    assert names[road.name] == 0.0
    (other,) = set(names) - {road.name}
    assert abs(names[other]) == pytest.approx(math.pi / 2, abs=1e-3)
    assert (sign.kind, sign.height_m, sign.confidence) == ("pole", 2.8, "estimated")


def test_facts_that_do_not_want_signs_get_none(sketch: Any) -> None:
    assert signs(assembled(read(sketch.collection(sketch.crossing())))) == []


@pytest.mark.parametrize(
    "changes", [{"name": "Long Street"}, {"name_confidence": "unverified"}], ids=["one street", "no name is known"]
)
def test_a_crossing_without_two_known_names_has_no_sign(sketch: Any, changes: dict[str, object]) -> None:
    assert signs(built(sketch, **changes)) == []


def test_linden_s_signs_stand_behind_the_kerb_and_clear_of_other_posts(linden_built: Built) -> None:
    posts = [
        moved(pose_at(road.path, signal.s_m), left_m=signal.t_m)[:2]
        for road in linden_built.document.roads
        for signal in road.signals
    ]
    found = signs(linden_built)
    assert len(found) == 66
    for road, sign in found:
        side = road.left if sign.t_m > 0.0 else road.right
        axis_m = road.axis[0][1]
        kerb_m = sum(lane.widths[0][1] for lane in side if lane.kind in PAVED)
        beside_m = abs(sign.t_m - axis_m) - kerb_m
        assert beside_m == pytest.approx(KERB_M + POST_TO_KERB_M, abs=1e-6)
        assert 0.0 < sign.s_m < length(road.path)
        place = moved(pose_at(road.path, sign.s_m), left_m=sign.t_m)[:2]
        assert min(math.dist(place, post) for post in posts) > 3.0


def test_linden_s_signs_name_streets_with_known_names(linden_built: Built) -> None:
    known = {
        street.name
        for street in linden_built.facts.streets
        if dict(street.confidences)["name_confidence"] != "unverified"
    }
    named = Counter(note[1].partition(" ")[2] for _, sign in signs(linden_built) for note in sign.notes)
    assert set(named) <= known
    assert named["Cleveland Ave"] == 23
    assert not [name for name in named if "unnamed" in name]


def test_signs_come_last_so_that_the_ids_of_other_objects_stay(linden_built: Built) -> None:
    ids = [thing.id for _, thing in signs(linden_built)]
    others = [
        thing.id
        for road in linden_built.document.roads
        for thing in road.objects
        if thing.name not in {NAME, PLACE_NAME}
    ]
    of_places = [thing.id for _, thing in signs(linden_built, PLACE_NAME)]
    assert max(others) < min(ids) <= max(ids) < min(of_places)


def place(sketch: Any, wall_m: float, **properties: object) -> dict[str, Any]:
    """A building beside the eastward street of the sketch; its wall is so far north of the middle of the street."""
    feature: dict[str, Any] = sketch.point("building", "b", (0.0, 0.0), height_m=6.0, **properties)
    ring = [(40.0, wall_m), (60.0, wall_m), (60.0, wall_m + 9.0), (40.0, wall_m + 9.0), (40.0, wall_m)]
    feature["geometry"] = {"type": "Polygon", "coordinates": [[sketch.lonlat(*corner) for corner in ring]]}
    return feature


def test_a_sign_before_the_wall_bears_the_name_of_a_place_in_lines_across_the_road(sketch: Any) -> None:
    feature = place(sketch, 14.0, name="Museum of Railroads and Canals", name_sign_confidence="estimated")
    ((road, sign),) = signs(assembled(read(sketch.collection([*sketch.crossing(), feature]))), PLACE_NAME)
    x_m, y_m = moved(pose_at(road.path, sign.s_m), left_m=sign.t_m)[:2]
    assert (x_m, y_m) == (pytest.approx(50.0, abs=0.2), pytest.approx(13.0, abs=0.2))
    assert sign.notes == ((BLADE, "1.571 Museum of Railroads and"), (BLADE, "1.571 Canals"))
    assert (sign.kind, sign.height_m, sign.confidence) == ("pole", 2.8, "estimated")


def test_a_building_has_no_sign_unless_its_feature_asks_for_one(sketch: Any) -> None:
    feature = place(sketch, 14.0, name="Museum")
    assert signs(assembled(read(sketch.collection([*sketch.crossing(), feature]))), PLACE_NAME) == []


def test_a_sign_without_room_before_the_wall_is_left_out_and_named(sketch: Any) -> None:
    feature = place(sketch, 4.5, name="Museum", name_sign_confidence="estimated")
    found = assembled(read(sketch.collection([*sketch.crossing(), feature])))
    assert (signs(found, PLACE_NAME), found.left_out) == ([], ("b",))


def test_eight_places_of_linden_have_signs_and_no_invented_shop_has_one(linden_built: Built) -> None:
    found = signs(linden_built, PLACE_NAME)
    names = {" ".join(note[1].partition(" ")[2] for note in sign.notes) for _, sign in found}
    assert len(names) == len(found) == 8
    assert {"Linden Transit Center", "Columbus Metropolitan Housing Authority"} < names
    assert names < {building.name for building in linden_built.facts.buildings}
    assert not [name for name in names if name.startswith("Shop")]
