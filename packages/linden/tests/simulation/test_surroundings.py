"""What stands on a map: made once a map, the same for every episode on it, and begun anew by each."""

from dataclasses import replace

import numpy as np
import pytest

from linden.maps.facts import derive
from linden.maps.library import GENERATED_MAP, LoadedMap
from linden.protocol.values.enums import SemanticTag, TrafficLightState
from linden.scenery.scene.objects import ObjectKind
from linden.scenery.scene.posts import POST_HALF_WIDTH_M, POST_HEIGHT_M
from linden.simulation.surroundings import scenery_of
from linden.world import World
from opendrive_texts import signal, street_through_junction

PAVEMENT_M = 0.15
STREET = street_through_junction(signals=signal("7", 30.0, -5.0, "1000001") + signal("8", 10.0, -5.0, "274"))


@pytest.fixture
def street() -> LoadedMap:
    return LoadedMap(name=GENERATED_MAP, text=STREET, **vars(derive(STREET)))


def test_every_light_and_sign_stands_on_a_post(street: LoadedMap) -> None:
    signals, scene, statics = scenery_of(street)
    posts = statics.tag == SemanticTag.POLES
    assert [actor.sign_id for actor in signals.actors] == ["7", "8"]
    assert [ObjectKind(kind) for kind in scene.things["kind"]] == [ObjectKind.TRAFFIC_LIGHT, ObjectKind.TRAFFIC_SIGN]
    np.testing.assert_allclose(statics.centre[posts, :2], [actor.transform.location[:2] for actor in signals.actors])
    np.testing.assert_allclose(statics.centre[posts, 2], PAVEMENT_M + 0.5 * POST_HEIGHT_M)
    np.testing.assert_allclose(statics.half[posts], [[POST_HALF_WIDTH_M, POST_HALF_WIDTH_M, 0.5 * POST_HEIGHT_M]] * 2)


def test_lights_have_heads_and_signs_plates_out_of_a_walkers_way(street: LoadedMap) -> None:
    statics = scenery_of(street).statics
    hung = statics.tag != SemanticTag.POLES
    assert statics.tag[hung].tolist() == [SemanticTag.TRAFFIC_LIGHT, SemanticTag.TRAFFIC_SIGNS]
    assert (statics.centre[hung, 2] - statics.half[hung, 2] > PAVEMENT_M + 2.1).all()


def test_a_map_loaded_again_has_the_same_scenery_and_lights_that_begin_anew(street: LoadedMap) -> None:
    simulation = World(street)
    first, rows = simulation.episode, simulation.episode.actors.rows.copy()
    first.traffic.set_colour(0, TrafficLightState.OFF)
    first.traffic.set_time(0, TrafficLightState.GREEN, 99.0)
    first.traffic.freeze_all(frozen=True)
    simulation.step(0.05)
    assert first.actors.rows.tobytes() != rows.tobytes()
    simulation.load(street, reset_settings=True)
    assert simulation.episode.traffic.actors is first.traffic.actors
    assert simulation.episode.statics is first.statics
    again, count = simulation.episode.actors.rows.copy(), len(first.actors)
    assert again["id"][:count].tolist() == [count + actor_id for actor_id in rows["id"][:count].tolist()]
    again["id"] = rows["id"]
    assert again.tobytes() == rows.tobytes()


def test_each_map_has_its_own(street: LoadedMap) -> None:
    text = street_through_junction()
    assert scenery_of(LoadedMap(name="bare", text=text, **vars(derive(text)))).signals.actors == ()
    assert len(scenery_of(street).signals.actors) == 2


def test_a_map_of_one_s_own_has_houses_where_there_is_room_but_what_a_client_sent_has_none(street: LoadedMap) -> None:
    own = scenery_of(replace(street, name="own")).scene
    assert len(street.lots) > 0
    assert (own.things["kind"] == ObjectKind.HOUSE).any()
    assert not (scenery_of(street).scene.things["kind"] == ObjectKind.HOUSE).any()
