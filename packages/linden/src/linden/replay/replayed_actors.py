"""Replayed actors: recorded ids to actors of the world, which are reused, spawned, or left out.

Source of the rules: ``CarlaReplayerHelper.cpp``; the releases up to 0.9.15 reuse an actor of the same id and type, and
so does this one.
"""

import logging
from typing import NamedTuple, Protocol

import numpy as np

from linden.blueprints.library import BlueprintKind, BlueprintLibrary
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.replay.file.packets import ActorAdded
from linden.replay.interpolation import FARTHEST_M, within
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.episode import Episode
from linden.simulation.spawning import destroy

log = logging.getLogger("linden")

CM_TO_M = 0.01
_ALOFT = Transform(Vector3D(0.0, 0.0, 1000.0))
"""Where CARLA's replayer lets actors into the world before it puts them in their places: nothing stands there."""
_SAME_PLACE_M = 1.0
"""How far a light or sign of the recording may be from the one that plays it; another is never as near."""


class ReplayedWorld(Protocol):
    """The world in which a recording is replayed."""

    library: BlueprintLibrary
    episode: Episode

    def spawn(self, description: ActorDescription, pose: Transform, *, parent_id: int = 0) -> ActorRecord:
        """Put an actor into the world; ``pose`` is relative where there is a parent.

        Raises:
            Refusal: it cannot be spawned.
        """
        ...


class Rules(NamedTuple):
    """The actors that a replay leaves out."""

    ignore_hero: bool
    ignore_spectator: bool
    replay_sensors: bool


class ReplayedActors:
    """The actors of the world that stand for recorded actors.

    Attributes:
        of: id in the recording -> id in the world.
        version: grows whenever an actor is added or removed.
    """

    def __init__(self, simulation: ReplayedWorld, rules: Rules) -> None:
        self._simulation, self._rules = simulation, rules
        self.of: dict[int, int] = {}
        self.version = 0
        self._told: set[str] = set()

    def enter(self, actor: ActorAdded, parent_id: int) -> None:
        """Let an actor of the recording into the world.

        ``parent_id`` is its parent in the recording, 0 for none; its place is relative to the parent.
        """
        if self._is_ignored(actor):
            return
        pose = pose_of(actor)
        found = self._existing(actor, pose)
        if found is None:
            found = self._spawned(actor, pose, parent_id)
        if found is None:
            return
        self.of[actor.id] = found.id
        self.version += 1
        if found.kind in (BlueprintKind.VEHICLE, BlueprintKind.WALKER) and found.slot != NO_BODY:
            bodies = self._simulation.episode.bodies
            bodies.set_simulate(found.slot, simulate=False)
            bodies.collides[found.slot] = False

    def _is_ignored(self, actor: ActorAdded) -> bool:
        type_id, rules = actor.description.id, self._rules
        if type_id == "spectator":
            return rules.ignore_spectator
        if type_id.startswith("sensor."):
            return not rules.replay_sensors
        return rules.ignore_hero and actor.description.attribute("role_name") == "hero"

    def _existing(self, actor: ActorAdded, pose: Transform) -> ActorRecord | None:
        """Return the existing actor that stands for a recorded one, moved to its place; None where there is none."""
        episode, type_id = self._simulation.episode, actor.description.id
        if type_id == "spectator":
            return episode.actors.get(episode.spectator_id)
        if type_id.startswith("traffic."):
            return self._of_map(type_id, pose.location)
        found = episode.actors.find(actor.id)
        if found is None or found.description.id != type_id:
            return None
        if not found.parent_id:
            episode.place(found.id, pose)
        return found

    def _of_map(self, type_id: str, location: Vector3D) -> ActorRecord | None:
        """Return the light or sign of the map that stands at a place."""
        episode = self._simulation.episode
        for record in episode.actors:
            if (
                record.kind in (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN)
                and record.description.id == type_id
            ):
                at = episode.transform(record.id).location
                if max(abs(a - b) for a, b in zip(at, location, strict=True)) <= _SAME_PLACE_M:
                    return record
        self._tell(f"replay: the map has no {type_id} at {_place(location)}; that of the recording is left out")
        return None

    def _spawned(self, actor: ActorAdded, pose: Transform, parent_id: int) -> ActorRecord | None:
        """Return the actor, spawned under its own id where that is free; None where it cannot be."""
        type_id, episode = actor.description.id, self._simulation.episode
        if type_id.startswith("traffic."):
            return None
        carrier = self.of.get(parent_id, 0)
        if parent_id and not carrier:
            self._tell(f"replay: {type_id} (actor {actor.id}) is left out: so is actor {parent_id}, which carries it")
            return None
        try:
            description = self._description(actor.description)
            with episode.actors.preferring(actor.id):
                if carrier:
                    return self._simulation.spawn(description, pose, parent_id=carrier)
                record = self._simulation.spawn(description, _ALOFT)
        except Refusal as refusal:
            self._tell(f"replay: {type_id} is left out: {refusal}")
            return None
        episode.place(record.id, pose)
        return record

    def _description(self, recorded: ActorDescription) -> ActorDescription:
        """Return what to spawn: attributes that this library knows and takes, with its own types for them.

        Raises:
            Refusal: no such blueprint.
        """
        library = self._simulation.library
        known = {attribute.id: attribute.type for attribute in library.find(recorded.id).definition.attributes}
        fitting: list[AttributeValue] = []
        for attribute in recorded.attributes:
            if attribute.id not in known:
                continue
            value = attribute._replace(type=known[attribute.id])
            try:
                library.validate(ActorDescription(0, recorded.id, (value,)))
            except Refusal as refusal:
                self._tell(f"replay: {recorded.id} is spawned with its own {attribute.id}: {refusal}")
            else:
                fitting.append(value)
        return ActorDescription(0, recorded.id, tuple(fitting))

    def leave(self, recorded_id: int) -> None:
        """Take an actor of the recording out of the world."""
        actor_id = self.of.pop(recorded_id, None)
        if actor_id is None or actor_id not in self._simulation.episode.actors:
            return
        self.version += 1
        destroy(self._simulation.episode, actor_id, announce=True)

    def dismiss(self) -> None:
        """Give all actors back to the physics, standing still, as CARLA does at the end of a replay."""
        episode = self._simulation.episode
        bodies = episode.bodies
        for actor_id in self.of.values():
            record = episode.actors.find(actor_id)
            if (
                record is None
                or record.slot == NO_BODY
                or record.kind not in (BlueprintKind.VEHICLE, BlueprintKind.WALKER)
            ):
                continue
            bodies.collides[record.slot] = True
            bodies.set_simulate(record.slot, simulate=True)
            bodies.set_target_angular_velocity(record.slot, Vector3D())
            bodies.set_target_velocity(record.slot, Vector3D())
            if record.kind is BlueprintKind.VEHICLE:
                bodies.set_control(record.slot, VehicleControl(gear=1))
            else:
                bodies.set_walker_control(record.slot, WalkerControl())

    def _tell(self, sentence: str) -> None:
        if sentence not in self._told:
            self._told.add(sentence)
            log.warning("%s", sentence)


def pose_of(actor: ActorAdded) -> Transform:
    """Return where an actor came into the recording: in the world, or relative to its parent."""
    roll, pitch, yaw = within(np.array(actor.rotation_deg), 360.0).tolist()
    x, y, z = within(np.array(actor.location_cm) * CM_TO_M, FARTHEST_M).tolist()
    return Transform(Vector3D(x, y, z), Rotation(pitch, yaw, roll))


def _place(location: Vector3D) -> str:
    return f"({location.x:.2f}, {location.y:.2f}, {location.z:.2f})"
