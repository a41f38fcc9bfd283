"""Friction between road and tyres: the factor of the weather, and friction triggers.

CARLA's weather is for the eye alone ("neither affect the actor's physics"). Here a wet road is a wet road: the tyres'
friction is multiplied by :func:`road_friction`, which is 1 where both ``wetness`` and ``precipitation_deposits`` are 0.
What ``get_physics_control`` answers is the tyre's own friction, which the weather leaves as it is.

``static.trigger.friction`` is CARLA's: from the first frame in which a vehicle's box touches the volume, all its wheels
have the trigger's friction (``get_physics_control`` answers that), from the first outside their own again. A physics
control that is applied inside holds until the vehicle leaves. Where volumes overlap the one spawned last decides.
"""

from typing import NamedTuple

import numpy as np

from linden.physics.state import VEHICLE
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.episode import WeatherParameters
from linden.protocol.values.space import BoundingBox, Vector3D
from linden.simulation.overlap import touching, world_centres
from linden.simulation.state import EpisodeState

FRICTION_TRIGGER = "static.trigger.friction"

_M_PER_CM = 0.01
DRY, WET, PUDDLES = 0.85, 0.65, 0.50
"""Friction of a new car tyre at 50 km/h on a dry road, under 0.2 mm of water and in puddles of 2 mm: Bosch Automotive
Handbook, table "Coefficients of friction of pneumatic tyres". Aquaplaning at higher speeds is left out."""


def road_friction(weather: WeatherParameters) -> float:
    """Return what the tyres' friction is multiplied with, from 1 (dry) down to PUDDLES / DRY (under water).

    ``wetness`` of 100 is a film that covers the road, ``precipitation_deposits`` of 100 a road capped with water;
    between 0 and those friction falls in proportion, and the wetter of the two decides. Negative values (the map's
    default) are dry.
    """
    film = min(max(weather.wetness, 0.0), 100.0) / 100.0
    puddles = min(max(weather.precipitation_deposits, 0.0), 100.0) / 100.0
    return 1.0 - max(film * (1.0 - WET / DRY), puddles * (1.0 - PUDDLES / DRY))


class Trigger(NamedTuple):
    """The volume of a trigger in its own frame, and the tyre friction inside."""

    box: BoundingBox
    friction: float


def trigger(description: ActorDescription) -> Trigger:
    """Return what a checked description asks for; its extents are half sizes in **cm**, as in CARLA."""
    half = Vector3D(*(description.number(f"extent_{axis}") * _M_PER_CM for axis in "xyz"))
    return Trigger(BoundingBox(Vector3D(), half), description.number("friction"))


class RoadFriction:
    """The vehicles inside friction triggers; to be updated before each step."""

    def __init__(self) -> None:
        self._triggers: dict[int, Trigger] = {}
        self._inside: dict[int, tuple[int, int]] = {}
        self._weather: WeatherParameters | None = None  # under which the bodies have their friction
        self._version = -1  # of the actors that have it

    def add(self, actor_id: int, made: Trigger) -> None:
        """Take a new trigger into account."""
        self._triggers[actor_id] = made

    def forget(self, actor_id: int) -> None:
        """Leave an actor out from now on, were it a trigger."""
        self._triggers.pop(actor_id, None)

    def update(self, episode: EpisodeState) -> None:
        """Give every vehicle the friction of its place; wakes vehicles with changed friction."""
        if episode.weather is not self._weather or episode.actors.version != self._version:
            self._weather, self._version = episode.weather, episode.actors.version
            self._apply_weather(episode)
        if self._triggers or self._inside:
            self._apply_triggers(episode)

    def _apply_weather(self, episode: EpisodeState) -> None:
        bodies = episode.bodies
        here = road_friction(episode.weather)
        changed = np.flatnonzero(bodies.alive & (bodies.road_friction != here))
        if changed.size:
            bodies.road_friction[changed] = here
            bodies.state["resting"][changed] = False

    def _apply_triggers(self, episode: EpisodeState) -> None:
        bodies = episode.bodies
        slots = np.flatnonzero(bodies.alive & (bodies.kind == VEHICLE))
        centres, yaw_rad = world_centres(bodies.state), bodies.rotation[:, 1]
        inside: dict[int, tuple[int, int]] = {}
        for trigger_id, made in self._triggers.items():
            pose = episode.transform(trigger_id)
            for slot in touching(made.box, pose, centres, bodies.half_extent, yaw_rad, slots).tolist():
                inside[slot] = episode.actors.of_slot(slot).id, trigger_id
        for slot in sorted(self._inside.keys() | inside.keys()):
            if inside.get(slot) == self._inside.get(slot) or not bodies.alive[slot]:
                continue
            bodies.friction_here[slot] = self._triggers[inside[slot][1]].friction if slot in inside else -1.0
            bodies.wake(slot)
        self._inside = inside
