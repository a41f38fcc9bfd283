"""What shines is found anew when a lamp, a light or the sun changes, and only then."""

from home_map import home_map
from linden.protocol.values.episode import CLEAR_NOON, EpisodeSettings
from linden.scenery.mesh import LampOf
from linden.sensors.runtime.light_state import LightStateCache
from linden.world import World

LIGHTS = 1 << LampOf.TRAFFIC_RED | 1 << LampOf.TRAFFIC_YELLOW | 1 << LampOf.TRAFFIC_GREEN


def test_what_shines_is_found_anew_when_something_changes() -> None:
    episode, shining = World(home_map(), EpisodeSettings()).episode, LightStateCache()
    day = shining.of(episode)
    assert shining.of(episode) is day
    assert not (day.lights | LIGHTS != LIGHTS).any()

    lamps = episode.surroundings.lamps
    first = lamps.states()[0]
    lamps.update([first._replace(active=True, color=(1, 2, 3))])
    lit = shining.of(episode)
    (boxes,) = (lit.lights >> LampOf.STREET & 1).nonzero()
    assert len(boxes) >= 1
    assert {tuple(colour) for colour in lit.colour[boxes].tolist()} == {(1, 2, 3)}

    episode.weather = CLEAR_NOON._replace(sun_altitude_angle=-30.0)
    assert (shining.of(episode).lights >> LampOf.WINDOW & 1).any()

    colour = episode.traffic.state.colour
    before = shining.of(episode).lights.copy()
    colour[:] = (colour + 1) % 3
    assert (shining.of(episode).lights != before).any()
