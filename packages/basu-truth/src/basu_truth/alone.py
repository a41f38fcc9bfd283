"""`AloneWorld`: a second simulator in which each object is seen with nothing in front of it.

The map is the same one without houses, trees and all other things. Objects with outlines that overlap in no sensor
are seen together, because none of them can hide another. Actors are seen high above the ground, so that a crest does
not hide them either. Parked cars are things of the map and stay where they stand.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

from basu.agents.sensor_streams import SensorSilentError, SensorStreams, SpawnedSensor
from basu.episode.world import asking, ticked_by_us
from basu.errors import SimulatorError, UserError
from basu.simulator import OwnServer, connect
from basu_truth.rig import INSTANCES, SEMANTIC_LIDAR, blueprint_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu_truth.rig import Declared
    from basu_truth.scene import Kind, Placed

LIFT_M = 400.0  # above the map, for actors: higher than any crest, and a float32 still resolves 0.1 mm there
AWAY = carla.Transform(carla.Location(0.0, 0.0, -3000.0))
"""Where actors wait until they are seen: beyond the range of each sensor."""
APART_M = 10.0  # between waiting actors

Bones = list[tuple[str, carla.Transform]]


class Single(NamedTuple):
    """An object to be seen alone: an actor with its number in the scene, or a thing of the map."""

    number: int
    kind: Kind
    placed: Placed | None = None  # None for a thing of the map
    bones: Bones | None = None  # of a walker


class AloneView(NamedTuple):
    """What the sensors saw of a group; ``number_of`` has the number in these measurements of each object."""

    measured: Mapping[str, Any]  # by the id of the declared sensor
    number_of: Mapping[int, int]


class AloneWorld:
    """The simulator with the bare map."""

    def __init__(self, client: carla.Client, town: str, sensors: Sequence[Declared], *, timeout_s: float) -> None:
        """Load the map, take its things away and spawn the twins of the sensors.

        Raises:
            UserError: the simulator does not have the map.
        """
        self._client, self._timeout_s = client, timeout_s
        world = client.get_world()
        if world.get_map().name.rsplit("/", maxsplit=1)[-1] != town:
            try:
                world = client.load_world(town)
            except RuntimeError as error:
                raise UserError(f"the simulator has no map {town}, in which the recording lies: {error}") from error
        self.world = world
        self._actors: dict[int, carla.Actor] = {}
        self._shown: set[int] = set()  # actors that are not away
        self._things: set[int] = set()  # ids of things that are there
        self._streams = SensorStreams(timeout_s)
        everything = {each.id for each in world.get_environment_objects()}
        world.enable_environment_objects(everything, False)
        library = world.get_blueprint_library()
        self._sensors: dict[str, carla.Sensor] = {}
        for each in sensors:
            blueprint = blueprint_of(each, INSTANCES if each.sensor.is_camera else SEMANTIC_LIDAR, library, None)
            actor = world.spawn_actor(blueprint, carla.Transform(carla.Location(z=LIFT_M)))
            self._sensors[each.sensor.id] = actor
            self._streams.listen(SpawnedSensor(each.sensor.id, actor.id, 1, as_numpy=False), actor)

    def close(self) -> None:
        """Stop listening."""
        self._streams.stop()

    def look(self, poses: Mapping[str, carla.Transform], group: Sequence[Single]) -> Iterator[AloneView]:
        """Yield what the sensors see of a group of objects that do not hide each other.

        Actors and things of the map are seen one after the other.

        Raises:
            SimulatorError: the simulator went away.
        """
        actors = [single for single in group if single.placed is not None]
        things = [single for single in group if single.placed is None]
        if actors:
            self._enable(set())
            self._put(poses, LIFT_M, {single.number: single for single in actors})
            yield AloneView(self._measured(), {each.number: self._actors[each.number].id for each in actors})
        if things:
            self._enable({each.kind.environment_id for each in things if each.kind.environment_id is not None})
            self._put(poses, 0.0, {})
            yield AloneView(self._measured(), {each.number: each.number for each in things})

    def _enable(self, things: set[int]) -> None:
        """Let these things of the map be there and no others."""
        if gone := self._things - things:
            self.world.enable_environment_objects(gone, False)
        if new := things - self._things:
            self.world.enable_environment_objects(new, True)
        self._things = set(things)

    def _put(self, poses: Mapping[str, carla.Transform], lift_m: float, shown: Mapping[int, Single]) -> None:
        """Put sensors and actors to their places, all other actors away."""
        place = carla.command.ApplyTransform
        commands = [place(self._sensors[name].id, _lifted(pose, lift_m)) for name, pose in poses.items()]
        commands += [place(self._actors[number].id, _away(number)) for number in sorted(self._shown - set(shown))]
        for number, single in shown.items():
            assert single.placed is not None, "it is an actor"
            actor = self._actor(number, single.kind)
            commands.append(place(actor.id, _lifted(single.placed.transform, lift_m)))
            if single.bones is not None:
                actor.set_bones(carla.WalkerBoneControlIn(single.bones))
                actor.blend_pose(1.0)
        self._shown = set(shown)
        self._client.apply_batch_sync(commands, False)

    def _actor(self, number: int, kind: Kind) -> carla.Actor:
        """Return the actor that stands for an object, spawned where it is new.

        Raises:
            SimulatorError: it cannot be spawned.
        """
        if number not in self._actors:
            blueprint = self.world.get_blueprint_library().find(kind.model)
            for name, value in kind.attributes.items():
                if blueprint.has_attribute(name) and blueprint.get_attribute(name).is_modifiable:
                    blueprint.set_attribute(name, value)
            try:
                actor = self.world.spawn_actor(blueprint, _away(number))
            except RuntimeError as error:
                raise SimulatorError(f"{kind.model} cannot be put into the bare map: {error}") from error
            actor.set_simulate_physics(False)
            self._actors[number] = actor
        return self._actors[number]

    def _measured(self) -> Mapping[str, Any]:
        """Go on by a frame and return what the sensors measured in it."""
        try:
            frame = self.world.tick(self._timeout_s)
            return {name: measured for name, (_, measured) in self._streams.wait(frame).items()}
        except (RuntimeError, SensorSilentError) as error:
            raise SimulatorError(f"the simulator with the bare map went away: {error}") from error


@contextlib.contextmanager
def alone_world(town: str, sensors: Sequence[Declared], step_s: float, timeout_s: float) -> Iterator[AloneWorld]:
    """Yield a bare map on a simulator of its own.

    Raises:
        UserError: the simulator does not have the map.
        SimulatorError: it did not answer in time.
    """
    with contextlib.ExitStack() as stack:
        server = OwnServer()
        stack.callback(server.end)
        client = connect("127.0.0.1", server.port, timeout_s)
        with asking("the preparation of the bare map"):
            bare = AloneWorld(client, town, sensors, timeout_s=timeout_s)
            stack.callback(bare.close)
            stack.enter_context(ticked_by_us(bare.world, step_s))
        yield bare


def _lifted(pose: carla.Transform, lift_m: float) -> carla.Transform:
    at = pose.location
    return carla.Transform(carla.Location(at.x, at.y, at.z + lift_m), pose.rotation)


def _away(number: int) -> carla.Transform:
    """Return a place of its own for each actor that waits."""
    at = AWAY.location
    return carla.Transform(carla.Location(at.x + APART_M * number, at.y, at.z), AWAY.rotation)


def groups(outlines: Mapping[int, Sequence[tuple[float, float, float, float] | None]]) -> list[list[int]]:
    """Return objects in groups within which no two outlines overlap in any sensor.

    Args:
        outlines: by number, the outline (left, top, right, bottom) in each sensor; None where it is not in view.

    The larger outlines come first, so that few groups are needed. The result depends on nothing but the outlines.
    """
    found: list[list[int]] = []
    order = sorted(outlines, key=lambda number: (-sum(_area(each) for each in outlines[number]), number))
    for number in order:
        for group in found:
            if not any(_overlap(outlines[number], outlines[other]) for other in group):
                group.append(number)
                break
        else:
            found.append([number])
    return found


def _area(outline: tuple[float, float, float, float] | None) -> float:
    return 0.0 if outline is None else (outline[2] - outline[0]) * (outline[3] - outline[1])


def _overlap(
    first: Sequence[tuple[float, float, float, float] | None],
    second: Sequence[tuple[float, float, float, float] | None],
) -> bool:
    """Return whether two objects overlap in any sensor."""
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if a is not None and b is not None]
    if not pairs:
        return False
    a, b = (np.array(each) for each in zip(*pairs, strict=True))
    return bool(np.any((a[:, 0] < b[:, 2]) & (b[:, 0] < a[:, 2]) & (a[:, 1] < b[:, 3]) & (b[:, 1] < a[:, 3])))
