"""`Scene`: a recorded run, replayed frame by frame with its cameras and lidars and their twins."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.agents.sensor_streams import SensorSilentError, SensorStreams, SpawnedSensor
from basu.episode.world import ticked_by_us
from basu.errors import SimulatorError, UserError
from basu.records.placed_motion import PlacedMotion
from basu.routing.weather import changed
from basu_carla_log.server_replay import begin_replay, simulator_for
from basu_truth.categories import OF_LABEL, category_of
from basu_truth.geometry import matrix_of
from basu_truth.rig import Declared, blueprint_of, declared_sensors

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu_carla_log.server_replay import Where
    from basu_truth.geometry import F64
    from basu_truth.recorded_run import RecordedRun


class Kind(NamedTuple):
    """What stays the same about an actor, or all that there is to say about a thing of the map."""

    category: str
    model: str
    attributes: Mapping[str, str]
    box: F64  # (4, 4) from the box's frame to the actor's, or to the world for a thing of the map
    size_m: tuple[float, float, float]
    environment_id: int | None = None  # of a thing of the map


class Placed(NamedTuple):
    """An actor in one frame."""

    kind: Kind
    actor: F64  # (4, 4) from the actor's frame to the world
    transform: carla.Transform
    velocity_mps: tuple[float, float, float]


class Shot(NamedTuple):
    """One exported frame: where everything is, and what was measured.

    ``measured`` has by the id of a declared sensor the measurements of itself and of its twins by their blueprints.
    """

    number: int
    t_s: float
    ego: F64
    weather: Mapping[str, float]
    actors: Mapping[int, Placed]
    sensors: Mapping[str, F64]  # (4, 4) from the sensor's frame to the world
    measured: Mapping[str, Mapping[str, Any]]


class Scene:
    """The replay of one run. ``declared`` and ``things`` are there once it has begun."""

    def __init__(self, run: RecordedRun, client: carla.Client, *, every: int, timeout_s: float, pictures: bool) -> None:
        self._run, self._client, self._every, self._timeout_s = run, client, every, timeout_s
        self._pictures = pictures
        self._streams = SensorStreams(timeout_s)
        self._kinds: dict[int, Kind | None] = {}
        self._motion = PlacedMotion()
        self._actors: dict[str, dict[str, carla.Sensor]] = {}
        self.world = begin_replay(client, run.log, run.conditions.vehicle_id)
        self.declared: tuple[Declared, ...] = declared_sensors(
            run.sensors, self.world.get_blueprint_library(), run.step_s
        )
        self.things: tuple[Kind, ...] = tuple(_things(self.world))

    def shots(self) -> Iterator[Shot]:
        """Yield the exported frames, the first frame of the recording first.

        Raises:
            UserError: the vehicle under test is not in the recording.
            SimulatorError: the simulator went away.
        """
        hero = self._hero()
        try:
            self._spawn(hero)
            for number in range(1, self._run.log.frames + 1):
                self._set_weather(number)
                found = self._tick(number, hero)
                if found is not None:
                    yield found
        finally:
            self._streams.stop()
            with contextlib.suppress(RuntimeError):  # the simulator is gone, and the replay with it
                self._client.stop_replayer(False)

    def bones(self, actor_id: int) -> list[tuple[str, carla.Transform]] | None:
        """Return the bones of a walker relative to their parents; None where the simulator gives none."""
        walker = self.world.get_actor(actor_id)
        try:
            return [(bone.name, bone.relative) for bone in walker.get_bones().bone_transforms]
        except RuntimeError:
            return None

    def _hero(self) -> carla.Actor:
        """Return the vehicle under test."""
        wanted = self._run.conditions.vehicle_id
        hero = self.world.get_actor(wanted)
        if hero is None or not hero.type_id.startswith("vehicle."):
            raise UserError(
                f"{self._run.log.path} has no vehicle {wanted}, which {self._run.name} says was under test; "
                "record the run again"
            )
        self._kinds[hero.id] = None
        return hero

    def _spawn(self, hero: carla.Actor) -> None:
        """Attach the declared sensors and their twins."""
        library = self.world.get_blueprint_library()
        for each in self.declared:
            of_camera = each.sensor.is_camera
            tick_s = self._every * self._run.step_s if of_camera and self._every > 1 else None
            itself = (each.spec.type_id,) if self._pictures or not of_camera else ()
            self._actors[each.sensor.id] = {}
            for type_id in dict.fromkeys((*itself, *each.twins)):
                blueprint = blueprint_of(each, type_id, library, tick_s)
                try:
                    actor = self.world.spawn_actor(blueprint, each.transform, attach_to=hero)
                except RuntimeError as error:
                    raise UserError(f"sensor '{each.sensor.id}' cannot be served by this simulator: {error}") from error
                name = f"{each.sensor.id}/{type_id}"
                period = self._every if of_camera else 1
                self._actors[each.sensor.id][type_id] = actor
                self._streams.listen(SpawnedSensor(name, actor.id, period, as_numpy=False), actor)

    def _set_weather(self, number: int) -> None:
        """Set the weather that begins with a frame of the recording."""
        for mark in self._run.conditions.weather:
            if mark.frame == number:
                self.world.set_weather(changed(self.world.get_weather(), mark.values))

    def _tick(self, number: int, hero: carla.Actor) -> Shot | None:
        """Go on by one frame; None where it is not exported."""
        try:
            self.world.tick(self._timeout_s)
            snapshot = self.world.get_snapshot()
        except RuntimeError as error:
            raise SimulatorError(
                f"the simulator went away after {number - 1} of {self._run.log.frames} frames: {error}"
            ) from error
        placed = self._placed(snapshot)
        if (number - 1) % self._every:
            return None
        try:
            latest = self._streams.wait(snapshot.frame)
        except SensorSilentError as error:
            raise SimulatorError(str(error)) from error
        if late := [name for name, (frame, _) in latest.items() if frame != snapshot.frame]:
            raise SimulatorError(
                f"sensor {late[0].partition('/')[0]} did not measure in frame {number} of the recording; this "
                "simulator keeps other times for sensor_tick: export with --every 1"
            )
        ego = snapshot.find(hero.id)
        return Shot(
            number,
            (number - 1) * self._run.step_s,
            matrix_of(ego.get_transform()),
            self._run.weather_at(number),
            placed,
            {name: self._pose(snapshot, actors) for name, actors in self._actors.items()},
            {
                name: {type_id: latest[f"{name}/{type_id}"][1] for type_id in actors}
                for name, actors in self._actors.items()
            },
        )

    def _pose(self, snapshot: carla.WorldSnapshot, actors: Mapping[str, carla.Sensor]) -> F64:
        return matrix_of(snapshot.find(next(iter(actors.values())).id).get_transform())

    def _placed(self, snapshot: carla.WorldSnapshot) -> dict[int, Placed]:
        """Return the actors that are objects of the truth, in the snapshot's order."""
        ids = [actor.id for actor in snapshot]
        self._learn([actor_id for actor_id in ids if actor_id not in self._kinds])
        t_s, found = snapshot.timestamp.elapsed_seconds, {}
        for actor_id in ids:
            kind = self._kinds[actor_id]
            if kind is not None:
                actor = snapshot.find(actor_id)
                pose = actor.get_transform()
                planar = self._motion.of(actor, pose, t_s)
                velocity = (planar.velocity_x_mps, planar.velocity_y_mps, actor.get_velocity().z)
                found[actor_id] = Placed(kind, matrix_of(pose), pose, velocity)
        return found

    def _learn(self, ids: Sequence[int]) -> None:
        """Ask the simulator what new actors are."""
        if not ids:
            return
        self._kinds.update(dict.fromkeys(ids))
        for actor in self.world.get_actors(list(ids)):
            category = category_of(actor.type_id, actor.attributes)
            if category is not None:
                self._kinds[actor.id] = _kind(category, actor.type_id, dict(actor.attributes), actor.bounding_box)


def _things(world: carla.World) -> Iterator[Kind]:
    """Yield the things of the map that are objects of the truth, in the simulator's order."""
    for label, category in OF_LABEL.items():
        for each in world.get_environment_objects(label):
            yield _kind(category, each.name, {}, each.bounding_box)._replace(environment_id=each.id)


def _kind(category: str, model: str, attributes: Mapping[str, str], box: carla.BoundingBox) -> Kind:
    half = box.extent
    size_m = (2.0 * half.x, 2.0 * half.y, 2.0 * half.z)
    return Kind(category, model, attributes, matrix_of(carla.Transform(box.location, box.rotation)), size_m)


@contextlib.contextmanager
def replayed(run: RecordedRun, where: Where, *, every: int, pictures: bool) -> Iterator[Scene]:
    """Yield the replay of a run on a simulator of its own, or on one that runs.

    Raises:
        UserError: no simulator answers there, it cannot replay the log, or a sensor cannot be served.
    """
    with simulator_for(run.log.path, where) as (client, _):
        with_map = _load_map(client, run.town)
        with ticked_by_us(with_map, run.step_s):  # before the replay begins: a change of the settings makes a frame
            yield Scene(run, client, every=every, timeout_s=where.timeout_s, pictures=pictures)


def _load_map(client: carla.Client, town: str) -> carla.World:
    """Return the world with the map of the recording in it, as far as the simulator has that map."""
    world = client.get_world()
    offered = {name.rsplit("/", maxsplit=1)[-1] for name in client.get_available_maps()}
    if town in offered and world.get_map().name.rsplit("/", maxsplit=1)[-1] != town:
        return client.load_world(town, reset_settings=False)
    return world
