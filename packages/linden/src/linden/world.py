"""The running world: an episode, its sensors, the recorder, the replayer, and the step that makes the next frame.

A step advances the lights, then the bodies, then the snapshot's rows. The replayer and the recorder follow.
"""

import math
from collections.abc import Container

from linden.blueprints.library import packaged
from linden.errors import Refusal
from linden.maps.library import LoadedMap
from linden.physics.step import advance
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Transform
from linden.replay.recorder import Recorder
from linden.replay.replayer import Replayer
from linden.sensors.runtime.looking_sensors import SensorFrame
from linden.sensors.runtime.measure import EpisodeSensors, Measurements, measure, refuse_idle
from linden.sensors.runtime.sensor_scene import SensorScene
from linden.simulation.actor_table import ActorRecord
from linden.simulation.episode import Episode
from linden.simulation.spawning import destroy, spawn
from linden.simulation.surroundings import scenery_of

FIRST_SENSOR_STREAM = 2
"""Stream 1 is the world observer's, as in CARLA."""

_FRAMES_THAT_TELL_OF_A_NEW_MAP = 3
"""How many snapshots tell of a load; the client needs one, and may miss one while it connects."""

_CLOCK_HZ = 2.0**36
"""The simulated time counts in parts of 15 ps, so that its sums and differences are exact for 36 hours.

Sums of 0.05 s are rounded, differently at each time. A Traffic Manager compares differences with 2 s. So the same
traffic drove differently a minute later in the same episode.
"""


class World:
    """A world in which time passes by calls of :meth:`step` only. Knows no clock, no network and no client.

    Attributes:
        settings: how time passes; replaced whole.
        frame: number of the last frame made; grows for the life of the server.
        episode: everything that a load of a map begins anew.
        sensors: the sensors of the episode.
        recorder: writes a recording into a file; a load of a map ends the recording.
        replayer: replays a recording; a load of a map ends the replay.
        sensor_scene: what sensors that look around see; it stays when a map is loaded again.
    """

    def __init__(self, world_map: LoadedMap, settings: EpisodeSettings = EpisodeSettings()) -> None:  # noqa: B008 - frozen
        """Begin the first episode on ``world_map``. Only the noise of sensors is random; clients give its seeds."""
        self.library = packaged()
        self.settings = settings
        self.frame = 0
        self.episode_id = 0
        self._first_actor_id = 1
        self._next_stream = FIRST_SENSOR_STREAM
        self.recorder = Recorder()
        self.replayer = Replayer()
        self.sensor_scene = SensorScene()
        self._begin(world_map)

    def load(self, world_map: LoadedMap, *, reset_settings: bool) -> None:
        """End the episode and begin another: actors, weather and lights start anew; ids of actors are counted on."""
        if reset_settings:
            self.settings = EpisodeSettings()
        self._first_actor_id = self.episode.actors.first_free_id
        self._begin(world_map)

    @staticmethod
    def prepare(world_map: LoadedMap) -> None:
        """Make what an episode on a map begins with, so that a load takes no time; any thread may call it."""
        scenery_of(world_map)

    def _begin(self, world_map: LoadedMap) -> None:
        self.episode_id += 1
        self.recorder.stop()
        self.replayer.forget()
        self.episode = Episode(world_map, first_frame=self.frame, first_actor_id=self._first_actor_id)
        self.sensors = EpisodeSensors()
        self.sensor_scene.leave(self.episode)
        self.delta_s = self.settings.fixed_delta_seconds or 0.0
        self.episode.observe()

    @property
    def map_name(self) -> str:
        """Name of the map as the client knows it."""
        return self.episode.map.full_name

    @property
    def opendrive_text(self) -> str:
        """The map, word for word as it was read."""
        return self.episode.map.text

    @property
    def spawn_points(self) -> tuple[Transform, ...]:
        """Return the map's recommended spawn points."""
        return self.episode.map.spawn_points

    @property
    def elapsed_s(self) -> float:
        """Simulated time since the episode began."""
        return self.episode.elapsed_s

    @property
    def map_changed(self) -> bool:
        """Whether the snapshot of this frame tells that the map is new."""
        return self.frame - self.episode.first_frame < _FRAMES_THAT_TELL_OF_A_NEW_MAP

    @property
    def tells_to_read_lamps(self) -> bool:
        """Whether the snapshot of this frame lets clients read all lamps: they have changed, or the map is new."""
        return self.map_changed or self.episode.surroundings.lamps.pending

    def step(self, dt_s: float) -> None:
        """Make the next frame, ``dt_s`` after the last."""
        self.frame += 1
        self.delta_s = dt_s
        self.recorder.before_step(self.episode)
        step(self.episode, dt_s, substeps_of(self.settings, dt_s))
        self.replayer.after_step(self, dt_s)
        self.recorder.after_step(self.episode, dt_s)

    def spawn(self, description: ActorDescription, pose: Transform, *, parent_id: int = 0) -> ActorRecord:
        """Put an actor into the world; ``pose`` is relative where there is a parent.

        Raises:
            Refusal: unknown blueprint, unfit attribute, no such parent, or something stands there.
        """
        blueprint = self.library.find(description.id)
        refuse_idle(description.id)
        complete = self.library.validate(description)
        record = spawn(self.episode, blueprint, complete, pose, parent_id)
        if blueprint.has_stream:
            record.stream_id = self._next_stream
            self._next_stream += 1
        try:
            self.sensors.add(record)
        except Refusal:
            destroy(self.episode, record.id)
            raise
        if self.sensors.casts_rays(record.id):
            self.sensor_scene.prepare(self.episode)
        return record

    def has_stream(self, stream_id: int) -> bool:
        """Return whether a sensor sends its measurements on a stream."""
        in_use = FIRST_SENSOR_STREAM <= stream_id < self._next_stream
        return in_use and any(record.stream_id == stream_id for record in self.episode.actors)

    def destroy(self, actor_id: int) -> None:
        """Take an actor and all that is attached to it out of the world.

        Raises:
            Refusal: there is none of that id, or it belongs to the map.
        """
        destroy(self.episode, actor_id)
        self.sensors.remove(actor_id)

    def measure(self, listened: Container[int]) -> Measurements:
        """Return what the sensors measured in this frame; to be called once a frame, ``listened`` being stream ids."""
        return measure(self.sensors, self.episode, listened, SensorFrame(self.sensor_scene, self.frame, self.delta_s))


def substeps_of(settings: EpisodeSettings, dt_s: float) -> int:
    """Return into how many parts the physics cuts a step: CARLA's rule for its substepping settings."""
    if not settings.substepping:
        return 1
    wanted = math.ceil(dt_s / settings.max_substep_delta_time - 1e-9)
    return max(1, min(wanted, settings.max_substeps))


def clock_s(time_s: float) -> float:
    """Return a duration in whole ticks of the simulated clock."""
    return round(time_s * _CLOCK_HZ) / _CLOCK_HZ


def step(episode: Episode, dt_s: float, substeps: int) -> None:
    """Advance an episode by ``dt_s``; the physics takes ``substeps`` equal parts."""
    episode.actors.turn_page()
    episode.traffic.step(dt_s)
    episode.friction.update(episode)
    episode.contacts = advance(episode.bodies, episode.map.ground, episode.statics, dt_s, substeps)
    episode.elapsed_s += clock_s(dt_s)
    for actor_id in episode.walkers.step(episode, dt_s):
        destroy(episode, actor_id, announce=True)
    episode.surroundings.step(episode.elapsed_s)
    episode.sockets.follow(episode)
    episode.observe()
