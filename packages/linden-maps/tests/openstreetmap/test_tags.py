"""Claims about what tags of ways say, each against the wording of OpenStreetMap's own documentation."""

import pytest

from linden_maps.openstreetmap.tags import (
    TAGGED,
    carriageway,
    cycle_lanes,
    direction,
    is_street,
    metres,
    speed_limit,
    unbuilt_cycleways,
)


def told(**tags: str) -> dict[str, str]:
    return {"highway": "residential", **{key.replace("__", ":"): value for key, value in tags.items()}}


@pytest.mark.parametrize(
    ("tags", "lanes", "is_tagged"),
    [
        (told(), (1, 1), False),
        (told(lanes="4"), (2, 2), True),
        (told(lanes="3", lanes__forward="1", lanes__backward="2"), (1, 2), True),
        (told(lanes="3", lanes__backward="1"), (2, 1), True),
        (told(lanes="3"), (2, 1), False),  # which direction has the odd lane is guessed
        (told(lanes="1"), (1, 1), False),
        (told(lanes="2", oneway="yes"), (2, 0), True),
        (told(lanes="2", oneway="-1"), (0, 2), True),
        (told(lanes="many"), (1, 1), False),
        (told(junction="roundabout"), (1, 0), False),
    ],
)
def test_lanes(tags: dict[str, str], lanes: tuple[int, int], *, is_tagged: bool) -> None:
    found = carriageway(tags, metric=False)
    assert (found.forward, found.backward) == lanes
    assert (dict(found.sources)["lanes_confidence"] == TAGGED) == is_tagged


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        ("25 mph", (25.0, "mph")),
        ("50", (50.0, "km/h")),
        ("50 km/h", (50.0, "km/h")),
        ("walk", None),
        ("none", None),
        ("0", None),
        ("", None),
    ],
)
def test_a_limit_keeps_the_unit_of_its_tag(text: str, limit: tuple[float, str] | None) -> None:
    assert speed_limit(text) == limit


@pytest.mark.parametrize(
    ("text", "m"), [("7.5", 7.5), ("7.5 m", 7.5), ("24 ft", 7.315), ("24'6\"", 7.468), ("wide", None), ("-3", None)]
)
def test_lengths(text: str, m: float | None) -> None:
    found = metres(text)
    assert found is None if m is None else found == pytest.approx(m, abs=0.001)


@pytest.mark.parametrize(
    ("tags", "is_one"),
    [
        (told(), True),
        ({"highway": "footway"}, False),
        ({"highway": "service", "service": "driveway"}, False),
        (told(access="private"), False),
        (told(access="private", motor_vehicle="yes"), True),
        ({"highway": "primary_link"}, True),
        (told(area="yes"), False),
        ({"highway": "construction"}, False),
    ],
)
def test_streets_are_what_the_public_drives_on(tags: dict[str, str], *, is_one: bool) -> None:
    assert is_street(tags) == is_one


def test_a_motorway_has_one_direction_unless_a_tag_denies_it() -> None:
    assert direction({"highway": "motorway"}) == 1
    assert direction({"highway": "motorway", "oneway": "no"}) == 0


def test_sides_are_read_in_the_newer_and_the_older_keys() -> None:
    assert carriageway(told(parking__left="lane"), metric=False).parking == (True, False)
    assert carriageway(told(parking__lane__both="parallel"), metric=False).parking == (True, True)
    assert carriageway(told(sidewalk__right="yes"), metric=False).sidewalk == (False, True)
    assert carriageway(told(sidewalk="no"), metric=False).sidewalk == (False, False)


def test_separate_sidewalks_are_a_guess() -> None:
    found = carriageway(told(sidewalk="separate"), metric=False)
    assert found.sidewalk == (True, True)
    assert dict(found.sources)["sidewalk_confidence"] == "guessed from sidewalk=separate"


def test_a_width_that_has_no_room_for_the_lanes_is_not_taken() -> None:
    found = carriageway(told(width="3", lanes="4"), metric=False)
    assert found.width_m == pytest.approx(4 * 3.05)
    assert dict(found.sources)["width_confidence"].startswith("guessed")


def test_guessed_limits_have_the_unit_of_the_extract() -> None:
    assert carriageway(told(), metric=False).speed == (25.0, "mph")
    assert carriageway(told(), metric=True).speed == (50.0, "km/h")


@pytest.mark.parametrize(
    ("tags", "sides", "unbuilt"),
    [
        (told(), (False, False), 0),
        (told(cycleway="lane"), (True, True), 0),
        (told(cycleway__right="lane"), (False, True), 0),
        (told(cycleway__both="track"), (False, False), 2),
        (told(cycleway="lane", oneway="yes"), (False, True), 0),
        (told(cycleway="opposite_lane", oneway="yes"), (False, False), 1),
        (told(cycleway__left="lane", oneway="yes"), (False, False), 1),
    ],
)
def test_cycle_lanes(tags: dict[str, str], sides: tuple[bool, bool], unbuilt: int) -> None:
    assert cycle_lanes(tags) == sides
    assert unbuilt_cycleways(tags) == unbuilt


def test_a_width_that_cannot_be_is_guessed_instead() -> None:
    found = carriageway(told(width="1000000000"), metric=True)
    assert found.width_m == pytest.approx(6.1)
    assert dict(found.sources)["width_confidence"] == "guessed: lanes of 3.05 m, width=1000000000 cannot be"
