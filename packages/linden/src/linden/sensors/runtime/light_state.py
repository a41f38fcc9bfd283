"""Lit traffic lights, street lamps and windows of a scene, cached until one of them changes."""

from collections.abc import Hashable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import TrafficLightState
from linden.scenery.mesh import LampOf
from linden.scenery.scene.lamp_states import is_night
from linden.scenery.scene.objects import ObjectKind

if TYPE_CHECKING:
    from linden.simulation.episode import Episode

_LENS = {
    TrafficLightState.RED: LampOf.TRAFFIC_RED,
    TrafficLightState.YELLOW: LampOf.TRAFFIC_YELLOW,
    TrafficLightState.GREEN: LampOf.TRAFFIC_GREEN,
}


class LightStates(NamedTuple):
    """For each of the scene's boxes (O,): LampOf bits that are on, and the sRGB colour (O, 3) of a street lamp."""

    lights: NDArray[np.uint32]
    colour: NDArray[np.uint8]


class LightStateCache:
    """Remembers the last answer: most frames are like the one before."""

    def __init__(self) -> None:
        self._last: tuple[Episode, Hashable, LightStates] | None = None

    def of(self, episode: "Episode") -> LightStates:
        """Return what shines now."""
        lamps, colours = episode.surroundings.lamps, episode.traffic.state.colour.tobytes()
        now = colours, lamps.changes, is_night(episode.weather)
        if self._last is None or self._last[0] is not episode or self._last[1] != now:
            self._last = episode, now, light_states(episode)
        return self._last[2]


def light_states(episode: "Episode") -> LightStates:
    """Return what shines of each box."""
    scene = episode.surroundings.scene
    shining, colour = np.zeros(len(scene.things), np.uint32), np.zeros((len(scene.things), 3), np.uint8)
    kinds = scene.things["kind"]
    lights = np.flatnonzero(kinds == ObjectKind.TRAFFIC_LIGHT)
    bits = np.zeros(max(TrafficLightState) + 1, np.uint32)
    for state, lens in _LENS.items():
        bits[state] = 1 << lens
    shining[lights] = bits[episode.traffic.state.colour[: len(lights)]]
    lamps, states = kinds == ObjectKind.STREET_LAMP, episode.surroundings.lamps.states()
    shining[lamps] = [int(lamp.active) << LampOf.STREET for lamp in states]
    colour[lamps] = np.array([lamp.color for lamp in states], np.uint8).reshape(-1, 3)
    if is_night(episode.weather):
        shining[kinds == ObjectKind.HOUSE] = 1 << LampOf.WINDOW
    things = scene.boxes["thing"]
    return LightStates(shining[things], colour[things])
