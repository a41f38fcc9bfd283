"""Worlds on a GPU that is none: numba's simulator runs the kernels as Python.

``python worlds_gpu_in_python.py`` steps worlds on both sides and prints what differs, a line each. With ``--in-place``
the bodies stay where they lie, as those of worlds with many bodies do. It runs in a process of its own, with
NUMBA_ENABLE_CUDASIM=1 and NUMBA_DISABLE_JIT=1: both count for a whole process.
"""

import sys

import numpy as np
from numba.cuda.simulator import kernelapi

from linden import worlds_gpu
from linden.blueprints.library import packaged
from linden.maps.ground import Ground
from linden.physics.bodies import FARTHEST_M, Bodies
from linden.physics.columns import BodyTable
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.physics.step import advance_worlds, contacts_of
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D

WORLDS, STEPS, DT_S, SUBSTEPS = 3, 6, 0.05, 2
WALL = (-1.0, 0.0, 0.5)
kernelapi.FakeCUDALocal.array = lambda _, shape, dtype: np.empty(shape, dtype).view(np.recarray)
"""Local memory: a view of it as records has their fields as attributes, as it has on a GPU."""

CAR = packaged().find("vehicle.tesla.model3")


def say(line: str) -> None:
    sys.stdout.write(f"{line}\n")


def made() -> BodyTable:
    """Worlds with a fast car before a box, one with a car on its side as well; the last has a body far out."""
    table = BodyTable(WORLDS, slots=1)
    for world in range(WORLDS):
        bodies = Bodies(table, world)
        for place, roll in ((Vector3D(-4.0, 0.3 * world, 0.0), 0.0), (Vector3D(0.0, 9.0, 1.2), 100.0))[: 1 + world % 2]:
            design = CAR.vehicle
            bodies.add_vehicle(
                design.physics, Transform(place, Rotation(0.0, 0.0, roll)), CAR.box, design.wheel_offsets_m
            )
        bodies.set_target_velocity(0, (12.0, 0.0, 0.0))
        bodies.add_prop(Transform(Vector3D(8.0, 0.0, 0.0)), BoundingBox(Vector3D(), Vector3D(1.0, 1.0, 1.0)), 80.0)
    far = Bodies(table, WORLDS - 1)
    far.set_pose(1, Transform(Vector3D(FARTHEST_M, 0.0, 0.0)))
    return table


def main() -> None:
    """Print what differs between the worlds on the CPU and those on the device."""
    standing = np.zeros(1, STATIC_BOX)
    standing["centre"], standing["half"] = (1.5, 0.0, 1.0), (0.5, 4.0, 1.0)
    ground, statics = Ground.flat(), Statics.of(standing)
    here, there, first = made(), made(), made()
    valid, frames = np.ones(WORLDS, bool), np.zeros(WORLDS, np.int64)
    gpu = worlds_gpu.GpuWorlds(ground, statics)
    gpu.upload(there, first, valid, frames)
    rows = np.arange(WORLDS, dtype=np.int32) * here.state.shape[1]
    controls = np.zeros((WORLDS, 7))
    controls[:, 0], controls[:, 1] = 1.0, 0.2
    gpu.set_controls(rows, controls)
    Bodies(here, 0).set_controls(np.zeros(1, np.int32), controls[:1])
    for world in range(WORLDS):
        Bodies(here, world).set_controls(np.zeros(1, np.int32), controls[:1])
    met = 0
    for step in range(STEPS):
        running = np.flatnonzero(valid).astype(np.int32)
        contacts = advance_worlds(here, running, ground, statics, DT_S, SUBSTEPS)
        gpu.step(DT_S, SUBSTEPS)
        own = contacts_of(gpu.touched(), statics)
        met += len(contacts)
        if own[own["world"] < WORLDS - 1].tobytes() != contacts[contacts["world"] < WORLDS - 1].tobytes():
            say(f"step {step}: other contacts")
        gpu.download(there, valid, frames)
        for name in here.state.dtype.names:
            if not np.array_equal(here.state[name][:-1], there.state[name][:-1]):
                say(f"step {step}: other {name}")
    say(f"contacts {met}, tumbling {int(here.state['tumbling'].sum())}")
    say(f"valid {valid.tolist()}, frames {frames.tolist()}")
    gpu.reset(np.array([1], np.int32))
    gpu.download(there, valid, frames)
    if there.state[1].tobytes() != first.state[1].tobytes() or there.state[0].tobytes() != here.state[0].tobytes():
        say("reset: other rows")
    kept = there.state[0, 1].tobytes()
    say(f"frames {frames.tolist()}")
    gpu.set_state(np.array([0], np.int32), first.state[0, :1])
    gpu.download(there, valid, frames)
    if there.state[0, 0].tobytes() != first.state[0, 0].tobytes() or there.state[0, 1].tobytes() != kept:
        say("set_state: other rows")


if __name__ == "__main__":
    if "--in-place" in sys.argv:
        worlds_gpu._MOST_LOCAL = 0
    main()
