"""The lamps of a scene: their states, changes by clients, and switching by day and night."""

from collections.abc import Sequence

from linden.protocol.values.enums import LightGroup
from linden.protocol.values.episode import LightState, WeatherParameters
from linden.protocol.values.space import Vector3D
from linden.scenery.scene.objects import ObjectKind, Scene

STREET_LAMP_LM = 5000.0
"""Of a street lamp with light-emitting diodes of about 45 W."""
STREET_LAMP_COLOUR = (255, 209, 163)
"""A black body of 4000 K."""

_FRAMES_THAT_TELL = 3
"""How many snapshots tell of a change; a client needs one."""


class Lamps:
    """The lamps of one episode.

    After a change by any client, a bit of the snapshot asks all clients to read the lamps again. CARLA keeps a list of
    clients by the name that each has for the server, which is the same for all. So the bit stays set for a few frames,
    and no answer depends on the time of a request.

    Attributes:
        pending: whether the last frame tells of a change.
        day_night_cycle: whether the sun switches the lamps.
        changes: how often lamps have changed.
    """

    def __init__(self, scene: Scene) -> None:
        bases = scene.things["base"][scene.things["kind"] == ObjectKind.STREET_LAMP].tolist()
        self._lamps = {
            number: LightState(
                number, Vector3D(*base), STREET_LAMP_LM, LightGroup.STREET, STREET_LAMP_COLOUR, active=False
            )
            for number, base in enumerate(bases, 1)
        }
        self.pending = False
        self.day_night_cycle = True
        self.changes = 0
        self._to_tell = 0

    def states(self) -> tuple[LightState, ...]:
        """Return every lamp in the order of the scene."""
        return tuple(self._lamps.values())

    def update(self, states: Sequence[LightState]) -> list[int]:
        """Give lamps other states, but no other places; returns the ids that no lamp has."""
        known = [state for state in states if state.id in self._lamps]
        for state in known:
            self._lamps[state.id] = state._replace(location=self._lamps[state.id].location)
        if known:
            self.tell()
        return [state.id for state in states if state.id not in self._lamps]

    def follow_sun(self, weather: WeatherParameters) -> None:
        """Switch all lamps on by night and off by day, unless that is left to the clients."""
        night = is_night(weather)
        if not self.day_night_cycle or all(lamp.active == night for lamp in self._lamps.values()):
            return
        self._lamps = {number: lamp._replace(active=night) for number, lamp in self._lamps.items()}
        self.tell()

    def tell(self) -> None:
        """Let the next snapshots say that lamps have changed."""
        self.changes += 1
        self._to_tell = _FRAMES_THAT_TELL

    def turn_page(self) -> None:
        """Begin a frame."""
        self.pending = self._to_tell > 0
        self._to_tell = max(0, self._to_tell - 1)


def is_night(weather: WeatherParameters) -> bool:
    """Return whether the sun is below the horizon; if the map decides the weather (all values negative), it is day."""
    return weather.sun_altitude_angle < 0.0 <= weather.cloudiness
