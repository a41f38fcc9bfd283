"""Walkers: poses from clients' AI controllers, distance walked, death after a crash; the navigation mesh file.

An AI controller lives in the client. In every tick it sends the pose of its walker. The walker has no physics and no
collisions then; the server puts it there. The snapshot shows a velocity from the distance that it was moved.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.maps.library import LoadedMap
from linden.maps.navigation.detour import Obstacles
from linden.maps.navigation.library import MeshFile, MeshLibrary
from linden.physics.bodies import Bodies
from linden.physics.state import PROP, VEHICLE, WALKER
from linden.protocol.values.control import WalkerControl
from linden.protocol.values.space import Transform
from linden.simulation.actor_table import ActorRecord, ActorRefusal
from linden.simulation.state import EpisodeState
from linden.simulation.surroundings import scenery_of

F64 = NDArray[np.float64]

LIES_FOR_S = 10.0
"""How long the dead stay: CARLA's AWalkerBase, AfterLifeSpan."""
LETHAL_MPS = 2.0
"""A blow that changes a walker's speed by this much strikes it down, where it is not invincible; a shove does not."""
FALLS_IN_S = 0.5
"""From upright to lying: about what a rigid rod of a body's height takes once it has been knocked over."""
_FASTEST_MPS = 15.0  # further in a frame is no step but a new place
_FOOTING_M = 0.5  # ground this near to where a walker is led is what it is meant to stand on


class Walkers:
    """What an episode knows of its walkers, by their actor ids."""

    def __init__(self) -> None:
        self._before: dict[int, F64] = {}  # of those led since the last frame: x, y, z and yaw, as that one showed them
        self._velocity: dict[int, F64] = {}  # of those led in the last frame
        self._walked_m: dict[int, float] = {}
        self._dead: dict[int, tuple[float, float, F64]] = {}  # since when, which way, half sizes upright

    # -- told by clients -----------------------------------------------------------------------------------------

    def lead(
        self, episode: EpisodeState, actor_ids: Sequence[int], poses: Sequence[Transform], speeds_mps: F64
    ) -> None:
        """Put walkers onto the ground, z of each pose being that of the surface under its feet, going on at a speed.

        The ids must be those of living walkers (:meth:`refuse_dead`).
        """
        bodies = episode.bodies
        slots = np.array([episode.walker(actor_id) for actor_id in actor_ids])
        feet_m = np.array([pose.location for pose in poses])
        under_m, _ = episode.map.ground.surfaces_under(feet_m)
        stands = np.abs(under_m - feet_m[:, 2]) <= _FOOTING_M
        feet_m[stands, 2] = under_m[stands]
        feet_m[:, 2] += bodies.half_extent[slots, 2] - bodies.box_centre[slots, 2]
        before = np.column_stack([bodies.position[slots], bodies.rotation[slots, 1]])
        for actor_id, place in zip(actor_ids, before, strict=True):
            self._before.setdefault(actor_id, place)
        bodies.set_poses(slots, np.hstack([feet_m, np.array([pose.rotation for pose in poses])]))
        bodies.set_walker_courses(slots, [pose.rotation.yaw for pose in poses], speeds_mps)

    def refuse_dead(self, actor_id: int) -> None:
        """Refuse to move a walker that is dead.

        Raises:
            ActorRefusal: it is.
        """
        if actor_id in self._dead:
            raise ActorRefusal("Walker is already dead", actor_id)

    def die(self, episode: EpisodeState, actor_id: int) -> None:
        """Let a walker fall and lie; ``LIES_FOR_S`` later it is gone. The dead do not die again."""
        slot = episode.walker(actor_id)
        if actor_id in self._dead:
            return
        bodies = episode.bodies
        ahead = bodies.velocity[slot, :2] @ (math.cos(bodies.rotation[slot, 1]), math.sin(bodies.rotation[slot, 1]))
        self._dead[actor_id] = (episode.elapsed_s, -1.0 if ahead > 0.0 else 1.0, bodies.half_extent[slot].copy())
        bodies.set_walker_control(slot, WalkerControl())
        bodies.disable_constant_velocity(slot)
        bodies.set_simulate(slot, simulate=True)
        bodies.kind[slot] = PROP  # from now on it slides with friction, and does not walk
        bodies.state["yaw_inertia_kgm2"][slot] = math.inf

    # -- asked ---------------------------------------------------------------------------------------------------

    def is_dead(self, actor_id: int) -> bool:
        """Whether a walker was struck dead and lies."""
        return actor_id in self._dead

    def walked_m(self, actor_id: int) -> float:
        """Return how far a walker has walked since it was spawned."""
        return self._walked_m.get(actor_id, 0.0)

    # -- every frame ---------------------------------------------------------------------------------------------

    def step(self, episode: EpisodeState, dt_s: float) -> list[int]:
        """Update the walkers after the physics of a frame; return the ids of dead walkers that have to be removed."""
        if self._before or self._velocity:
            self._show_motion(episode, dt_s)
        if len(episode.contacts) and episode.walker_ids_and_slots()[0]:
            for actor_id in _struck(episode):
                self.die(episode, actor_id)
        gone = []
        for actor_id, (since_s, way, half_m) in list(self._dead.items()):
            lain_s = episode.elapsed_s - since_s
            record = episode.actors.find(actor_id)
            if record is None:
                del self._dead[actor_id]
            elif lain_s > LIES_FOR_S:
                gone.append(actor_id)
            else:
                _lay_down(episode.bodies, record.slot, way * min(1.0, lain_s / FALLS_IN_S), half_m)
        self._count_steps(episode, dt_s)
        return gone

    def _show_motion(self, episode: EpisodeState, dt_s: float) -> None:
        """Give led walkers the velocity, turn and acceleration that their new places mean."""
        bodies, after = episode.bodies, {}
        for actor_id, before in self._before.items():
            record = episode.actors.find(actor_id)
            if record is None or bodies.simulate[record.slot]:
                continue  # gone, or moved by the physics, which knows how fast
            slot = record.slot
            velocity = (bodies.position[slot] - before[:3]) / dt_s
            if np.abs(velocity).max() > _FASTEST_MPS:
                velocity = np.zeros(3)
            turn_rad = math.remainder(bodies.rotation[slot, 1] - before[3], math.tau)
            bodies.velocity[slot] = velocity
            bodies.angular_velocity[slot, 2] = turn_rad / dt_s
            bodies.acceleration[slot] = (velocity - self._velocity.get(actor_id, np.zeros(3))) / dt_s
            after[actor_id] = velocity
        self._before, self._velocity = {}, after

    def _count_steps(self, episode: EpisodeState, dt_s: float) -> None:
        ids, slots = episode.walker_ids_and_slots()
        if not ids:
            self._walked_m = {}
            return
        stride_m = np.hypot(episode.bodies.velocity[slots, 0], episode.bodies.velocity[slots, 1]) * dt_s
        known = self._walked_m
        self._walked_m = {i: known.get(i, 0.0) + step_m for i, step_m in zip(ids, stride_m.tolist(), strict=True)}


def _struck(episode: EpisodeState) -> list[int]:
    """Return the ids of the walkers that a vehicle struck down in this frame."""
    bodies, contacts = episode.bodies, episode.contacts
    found = []
    pairs = contacts[(contacts["a"] >= 0) & (contacts["b"] >= 0)]
    for own, other in (("a", "b"), ("b", "a")):
        hits = pairs[(bodies.kind[pairs[own]] == WALKER) & (bodies.kind[pairs[other]] == VEHICLE)]
        blow_mps = np.linalg.norm(hits["impulse"], axis=1) / bodies.mass_kg[hits[own]]
        for slot in hits[own][blow_mps >= LETHAL_MPS].tolist():
            record = episode.actors.of_slot(slot)
            if _can_die(record):
                found.append(record.id)
    return found


def _can_die(record: ActorRecord) -> bool:
    return any(name == "is_invincible" and value == "false" for name, _, value in record.description.attributes)


def _lay_down(bodies: Bodies, slot: int, share: float, upright_half_m: F64) -> None:
    """Tip a body: share 0 is upright, 1 on its back, -1 on its face. Its lowest point stays where it is.

    What is longer than wide, as animals are, tips onto its side.
    """
    lean_rad = 0.5 * math.pi * share
    cosine, sine = abs(math.cos(lean_rad)), abs(math.sin(lean_rad))
    half_m = upright_half_m.tolist()
    across, angle = (1, 2) if half_m[0] > half_m[1] else (0, 0)  # the horizontal axis that rises; pitch or roll
    lies = [*half_m[:2], sine * half_m[across] + cosine * half_m[2]]
    lies[across] = cosine * half_m[across] + sine * half_m[2]
    bodies.position[slot, 2] += lies[2] - bodies.half_extent[slot, 2]
    bodies.half_extent[slot] = lies
    bodies.rotation[slot, angle] = lean_rad


def mesh_file(episode: EpisodeState, meshes: MeshLibrary) -> MeshFile | None:
    """Return the mesh as clients fetch it; None where the map has no pavements."""
    return meshes.file_of(episode.map, obstacles_of(episode.map))


def obstacles_of(world_map: LoadedMap) -> Obstacles:
    """Return what the walking mesh of a map leaves out: all scenery, whatever clients have made disappear."""
    statics = scenery_of(world_map).statics
    return Obstacles(statics.centre, statics.half, statics.yaw_rad)
