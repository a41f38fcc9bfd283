"""Parts of bodies placed on a GPU that is none: numba's simulator runs the kernels as Python.

``python world_parts_in_python.py`` places the parts of cars, walkers and props, and sensors, by the kernels of both
sides and prints what differs, a line each. It runs in a process of its own, with NUMBA_ENABLE_CUDASIM=1 and
NUMBA_DISABLE_JIT=1: both count for a whole process.
"""

import sys

import numpy as np

from linden.blueprints.library import packaged
from linden.physics.bodies import Bodies, place_rows
from linden.physics.columns import BodyTable
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.actors.actor_meshes import actor_meshes
from linden.scenery.actors.posing import matrices
from linden.sensors.runtime.visible_actors import PartRows
from linden.sensors.runtime.world_parts import parts_of_bodies, placed_parts, poses_of_eyes
from linden.simulation.spawning import embody
from linden.worlds_parts_gpu import BodiesOnDevice, PartsOnGpu, cuda

WORLDS = 3
ACTORS = (
    "vehicle.tesla.model3",
    "walker.pedestrian.0003",
    "static.prop.trafficcone01",
    "vehicle.bh.crossbike",
    "vehicle.easymile.ez10",
)


def made(dice: np.random.Generator) -> BodyTable:
    """Return worlds of which each has all actors, in any pose and with any speed."""
    table = BodyTable(WORLDS, slots=8)
    for world in range(WORLDS):
        for name in ACTORS:
            blueprint = packaged().find(name)
            description = packaged().validate(ActorDescription(0, name))
            embody(Bodies(table, world), blueprint, description, Transform(Vector3D(), Rotation()))
    flat = table.state.reshape(-1)
    rows = np.flatnonzero(flat["alive"]).astype(np.int32)
    place_rows(
        flat, rows, dice.uniform([-9.0] * 3 + [-80.0, -170.0, -170.0], [9.0] * 3 + [80.0, 170.0, 170.0], (len(rows), 6))
    )
    for name in ("velocity", "angular_velocity", "wheel_steer", "wheel_turned"):
        flat[name][rows] = dice.uniform(-2.0, 2.0, flat[name][rows].shape)
    return table


def main() -> None:
    """Print what differs between both sides."""
    dice = np.random.default_rng(5)
    table = made(dice)
    slots = table.state.shape[1]
    there = table.state["alive"]
    world, slot = np.nonzero(there)
    row = (world * slots + slot).astype(np.int32)
    designs = PartRows.of([packaged().validate(ActorDescription(0, name)) for name in ACTORS], actor_meshes())
    parts = parts_of_bodies(designs, world, row, slot, slots, WORLDS)
    walked_m = dice.uniform(0.0, 5.0, table.state.shape)
    flat = table.state.reshape(-1)
    here = placed_parts(parts, flat, table.spec_of.reshape(-1), table.specs, walked_m.reshape(-1))
    bodies = BodiesOnDevice(*(cuda.to_device(each) for each in (table.state, table.spec_of, table.specs)))
    placing = PartsOnGpu()
    poses = placing.poses(bodies, parts, walked_m).copy_to_host()
    if poses.tobytes() != here.pose.tobytes():
        sys.stdout.write(f"other poses of parts: {int((poses != here.pose).sum())}\n")
    transform = dice.uniform([-2.0] * 3 + [-180.0] * 3, [2.0] * 3 + [180.0] * 3, (2, 6))
    chosen = np.array([2, 0], np.int32)
    for carrier in (0, 1, None):
        eyes = placing.eyes(bodies, chosen, carrier, transform)
        own = transform if carrier is None else poses_of_eyes(flat, chosen * slots + carrier, transform)
        expected = matrices(own).astype(np.float32)
        if not np.array_equal(eyes.place.copy_to_host(), expected[:, :, 3]):
            sys.stdout.write(f"other places of sensors on slot {carrier}\n")
        if not np.array_equal(eyes.turn.copy_to_host(), expected[:, :, :3]):
            sys.stdout.write(f"other turns of sensors on slot {carrier}\n")
    sys.stdout.write(f"parts {len(poses)}\n")


if __name__ == "__main__":
    main()
