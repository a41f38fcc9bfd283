"""`EpisodeState`, abstract base of `Episode`: map, actors, bodies, weather; look-up of actors and setting of poses."""

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.maps.library import LoadedMap
from linden.physics.bodies import Bodies
from linden.physics.step import CONTACT
from linden.protocol.values.episode import CLEAR_NOON, WeatherParameters
from linden.protocol.values.space import Transform
from linden.simulation.actor_table import NO_BODY, ActorRecord, ActorRefusal, ActorTable
from linden.simulation.below_ground import BelowGround
from linden.structured import StructuredArray


class WalkerFacts(Protocol):
    """The facts about walkers that their poses depend on."""

    def is_dead(self, actor_id: int) -> bool:
        """Return whether a walker is dead."""
        ...

    def walked_m(self, actor_id: int) -> float:
        """Return how far a walker has walked."""
        ...


class PoseFacts(Protocol):
    """The poses of walkers."""

    def shown(self, episode: "EpisodeState", actor_id: int) -> NDArray[np.float64]:
        """Return the frames of a walker's bones."""
        ...


class EpisodeState(ABC):
    """The state that the parts of an episode share.

    Attributes:
        map: the map of the episode.
        first_frame: number of the frame before the episode's first.
        elapsed_s: simulated time since the episode began.
        actors: all actors, with the packed rows of the snapshot.
        bodies: everything that occupies space and moves.
        below_ground: bodies far below the ground; their physics is off.
        contacts: contacts of the last step, as ``physics`` reports them.
        weather: the weather parameters that clients set.
        walkers: facts about walkers.
        poses: poses of walkers.
    """

    walkers: WalkerFacts
    poses: PoseFacts

    def __init__(self, world_map: LoadedMap, first_frame: int, first_actor_id: int) -> None:
        self.map = world_map
        self.first_frame = first_frame
        self.elapsed_s = 0.0
        self.actors = ActorTable(first_actor_id)
        self.bodies = Bodies()
        self.below_ground = BelowGround(world_map.ground, self.bodies)
        self.weather: WeatherParameters = CLEAR_NOON
        self.contacts: StructuredArray = np.zeros(0, CONTACT)

    @abstractmethod
    def walker_ids_and_slots(self) -> tuple[list[int], NDArray[np.int32]]:
        """Return ids and slots of all walkers, oldest first."""

    def body(self, actor_id: int) -> int:
        """Return the slot of an actor's body.

        Raises:
            ActorRefusal: no such actor, or it occupies no space.
        """
        record = self.actors.get(actor_id)
        if record.slot == NO_BODY:
            raise ActorRefusal("Actor does not match the expected type", actor_id)
        return record.slot

    def vehicle(self, actor_id: int) -> int:
        """Return the slot of a vehicle.

        Raises:
            ActorRefusal: no such actor, or no vehicle.
        """
        return self._slot_of_kind(actor_id, BlueprintKind.VEHICLE, "Actor is not a Vehicle")

    def walker(self, actor_id: int) -> int:
        """Return the slot of a walker.

        Raises:
            ActorRefusal: no such actor, or no walker.
        """
        return self._slot_of_kind(actor_id, BlueprintKind.WALKER, "Actor is not a Walker")

    def _slot_of_kind(self, actor_id: int, kind: BlueprintKind, otherwise: str) -> int:
        record = self.actors.get(actor_id)
        if record.kind is not kind or record.slot == NO_BODY:
            raise ActorRefusal(otherwise, actor_id)
        return record.slot

    def carrier(self, record: ActorRecord) -> ActorRecord | None:
        """Return what moves an attached actor: the nearest that has a body of those it hangs on, None without one."""
        carrier = self.actors.find(record.parent_id)
        while carrier is not None and carrier.slot == NO_BODY:
            carrier = self.actors.find(carrier.parent_id)
        return carrier

    def forget_contacts(self, slot: int) -> None:
        """Drop the contacts of a body that leaves the world."""
        if len(self.contacts):
            self.contacts = self.contacts[(self.contacts["a"] != slot) & (self.contacts["b"] != slot)]

    def transform(self, actor_id: int) -> Transform:
        """Return where an actor is in the world."""
        slot = self.actors.get(actor_id).slot
        return self.actors.transform(actor_id) if slot == NO_BODY else self.bodies.pose(slot)

    def own_transform(self, actor_id: int) -> Transform:
        """Return where an actor is as :meth:`place` takes it: relative to its parent where it has one."""
        if self.actors.get(actor_id).parent_id:
            return self.actors.relative_transform(actor_id)
        return self.transform(actor_id)

    def place(self, actor_id: int, pose: Transform) -> None:
        """Put an actor somewhere in the world, or relative to its parent where it has one.

        Raises:
            ActorRefusal: there is none of that id.
        """
        record = self.actors.get(actor_id)
        if record.slot == NO_BODY:
            self.actors.place(actor_id, pose)
        else:
            self.bodies.set_pose(record.slot, pose)
            self.below_ground.settle(record.slot)

    def place_bodies(self, slots: NDArray[np.integer], poses: NDArray[np.float64]) -> None:
        """Put many bodies somewhere in the world: (K,) slots, each once, and (K, 6) x, y, z in m, pitch, yaw, roll."""
        self.bodies.set_poses(slots, poses)
        self.below_ground.settle_all(slots)
