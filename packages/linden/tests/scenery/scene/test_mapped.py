"""Claims about the scene of a map with buildings of its own."""

from dataclasses import replace

import numpy as np
import pytest

from linden.maps.facts import MapFacts, derive
from linden.maps.library import LoadedMap
from linden.maps.records import Standing, StandingBox
from linden.protocol.values.enums import SemanticTag
from linden.scenery.map_mesh import things
from linden.scenery.scene.mapped import mapped, plain
from linden.scenery.scene.neighbourhood import furnish
from linden.scenery.scene.objects import ObjectKind, join
from linden.simulation.surroundings import scenery_of
from opendrive_texts import street_through_junction


def building(x_m: float, y_m: float, *halves: tuple[float, float, float], name: str = "") -> Standing:
    """A building of boxes in a row, 20 m apart."""
    boxes = tuple(
        StandingBox(x_m + 20.0 * n, y_m, half[2], half[0], half[1], half[2], 0.0) for n, half in enumerate(halves)
    )
    return Standing("building", name, x_m, y_m, 0.0, 0.0, boxes)


BENCH = Standing("bench", "", 4.0, 8.0, 0.0, 0.0, (StandingBox(4.0, 8.0, 0.4, 0.9, 0.3, 0.4, 0.0),))
HOUSE = building(30.0, 40.0, (5.0, 4.0, 3.0), name="Corner Shop")
SCHOOL = building(80.0, 40.0, (9.0, 9.0, 6.0), (9.0, 4.0, 6.0), name="Windsor STEM Academy")


@pytest.fixture(scope="module")
def facts() -> MapFacts:
    return derive(street_through_junction())


def test_things_have_their_kind_their_boxes_and_their_names() -> None:
    scene = mapped([HOUSE, SCHOOL, BENCH])
    assert [ObjectKind(kind) for kind in scene.things["kind"]] == [
        ObjectKind.HOUSE,
        ObjectKind.BUILDING,
        ObjectKind.BENCH,
    ]
    assert scene.thing_names == ("House_0_CornerShop", "Building_0_WindsorSTEMAcademy", "Bench_0")
    assert scene.boxes["thing"].tolist() == [0, 1, 1, 2]
    assert scene.boxes["tag"].tolist() == [3, 3, 3, int(SemanticTag.STATIC)]
    assert [item.name for item in scene.objects][1:3] == [
        "Building_0_WindsorSTEMAcademy_SM_0",
        "Building_0_WindsorSTEMAcademy_SM_1",
    ]


def test_names_stay_with_their_things_where_scenes_are_joined() -> None:
    scene = join([mapped([BENCH]), mapped([SCHOOL])])
    assert scene.thing_names == ("Bench_0", "Building_0_WindsorSTEMAcademy")


def test_a_map_without_buildings_is_furnished_as_ever(facts: MapFacts) -> None:
    np.testing.assert_array_equal(plain(facts).boxes, furnish(facts.lots, facts.ground).boxes)


def test_a_map_with_buildings_gets_no_drawn_houses_and_nothing_inside_of_them(facts: MapFacts) -> None:
    drawn = furnish(facts.lots, facts.ground)
    tree = drawn.things["base"][np.flatnonzero(drawn.things["kind"] == ObjectKind.TREE)[0]]
    scene = plain(replace(facts, standing=(building(tree[0], tree[1], (4.0, 4.0, 3.0)),)))
    assert not (scene.things["kind"] == ObjectKind.HOUSE).any()
    assert np.hypot(*(scene.things["base"][:, :2] - tree[:2]).T).min() > 4.0
    assert len(scene.things) > 0


def test_what_stands_is_seen_within_its_boxes(facts: MapFacts) -> None:
    scene = mapped([SCHOOL, BENCH])
    mesh = things(facts, scene)
    for row, box in enumerate(scene.boxes):
        corners = mesh.vertices_m[mesh.triangles[mesh.faces["object"] == row]].reshape(-1, 3)
        assert len(corners) > 0
        assert (np.abs(corners - box["centre"]) <= box["half"] + 0.06).all()
    assert set(mesh.faces["tag"].tolist()) == {int(SemanticTag.BUILDINGS), int(SemanticTag.STATIC)}


def test_a_server_s_scene_holds_what_the_map_has(facts: MapFacts) -> None:
    text = street_through_junction()
    loaded = LoadedMap(name="town", text=text, **vars(replace(facts, standing=(SCHOOL,))))
    assert "Building_0_WindsorSTEMAcademy" in scenery_of(loaded).scene.thing_names
