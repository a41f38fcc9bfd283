"""The parts of all bodies of many worlds: which there are, and kernels that put them in their places.

One thread of a GPU, or of the processor, places a body or a sensor by the functions that the server's actors have.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, part, unlocked
from linden.physics.state import SOURCES, VEHICLE, WALKER, Body, Rows, Spec
from linden.scenery.actors import posing
from linden.scenery.actors.posing import (
    SCRATCH,
    WALKER_FRAMES,
    BoneChain,
    bones,
    put_actor,
    put_bones,
    put_matrix,
    put_part,
    put_wheels,
)
from linden.sensors.casting.thread_pool import in_stretches
from linden.sensors.runtime.visible_actors import PartRows
from linden.simulation import snapshot_rows
from linden.simulation.snapshot_rows import follow, put_pose

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

FRAMES = len(WALKER_FRAMES)

_FEWEST = 256
"""Bodies that a thread takes at least; they take some 0.1 ms."""

_KERNEL_SOURCES = fingerprint(*(Path(str(module.__file__)) for module in (posing, snapshot_rows))) ^ SOURCES


class PartsOfBodies(NamedTuple):
    """The parts (P,) of B bodies in K worlds, body after body: what does not change while they move."""

    begins: I32  # (K + 1,) first part of each world
    row: I32  # (B,) of each body among those of all worlds
    first: I32  # (B + 1,) first part of each body
    mesh: I32  # (P,)
    frame: I32
    scale: F64
    paint: NDArray[np.uint8]  # (P, 3)
    actor_id: NDArray[np.uint32]


class PlacedParts(NamedTuple):
    """Where the parts (P,) are, and how they move."""

    pose: F32  # (P, 3, 4) from the part's frame to the world, m
    velocity_mps: F32  # (P, 3)
    turning_radps: F32  # (P, 3)


def parts_of_bodies(
    designs: PartRows, world: NDArray[np.intp], row: I32, design: NDArray[np.intp], slots: int, worlds: int
) -> PartsOfBodies:
    """Return the parts of bodies (B,), each of a design, ascending by their world from 0 to ``worlds``."""
    begins = np.searchsorted(designs.actor, np.arange(design.max(initial=-1) + 2))
    count = begins[design + 1] - begins[design]
    first = np.concatenate([[0], np.cumsum(count)])
    body = np.repeat(np.arange(len(design)), count)
    rows = begins[design][body] + np.arange(len(body)) - first[body]
    return PartsOfBodies(
        np.searchsorted(world[body], np.arange(worlds + 1)).astype(np.int32),
        row,
        first.astype(np.int32),
        designs.mesh[rows],
        designs.frame[rows].astype(np.int32),
        designs.scale[rows],
        designs.paint[rows],
        (row[body] % slots + 1).astype(np.uint32),
    )


@part
def put_body(
    body: Body, spec: Spec, walked_m: float, chain: BoneChain, pose: F64, scratch: F64, place: F64, frames: F64
) -> None:  # pragma: no cover - compiled
    """Write the place (3, 4) of a body in the world, and the frames (14, 3, 4) of its parts in its own.

    ``pose`` (6,) and ``scratch`` (M, SCRATCH) are room to work in.
    """
    put_pose(body.position, body.rotation, pose)
    put_matrix(pose, place)
    if body.kind == VEHICLE:
        put_wheels(spec.wheel_x_m, spec.wheel_y_m, spec.wheel_radius_m, body.wheel_steer, body.wheel_turned, frames)
    elif body.kind == WALKER:
        speed_mps = np.hypot(body.velocity[0], body.velocity[1])
        put_bones(2.0 * body.half_extent[2], walked_m, speed_mps, chain, scratch, frames)
    else:
        put_actor(frames)


@part
def put_eye(body: Body, relative: F64, outer: F64, pose: F64) -> None:  # pragma: no cover - compiled
    """Write the pose (6,) of a sensor at ``relative`` (6,) to a body; ``outer`` (6,) is room to work in."""
    put_pose(body.position, body.rotation, outer)
    follow(outer, relative, pose)


def _build(sources: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel of the processor; ``sources`` is part of the name of its file."""

    def place_bodies(
        start: int, stop: int, flat: Rows, spec_of: I32, specs: Rows, walked_m: F64, parts: PartsOfBodies,
        chain: BoneChain, found: PlacedParts,
    ) -> None:  # fmt: skip # pragma: no cover - compiled
        """Place the parts of bodies from ``start`` to ``stop``."""
        if sources < 0:
            return
        pose, scratch = np.empty(6), np.empty((len(chain.parents), SCRATCH))
        place, frames = np.empty((3, 4)), np.empty((FRAMES, 3, 4))
        for index in range(start, stop):
            row = parts.row[index]
            body = flat[row]
            put_body(body, specs[spec_of[row]], walked_m[row], chain, pose, scratch, place, frames)
            velocity, turning = body.velocity, body.angular_velocity
            for own in range(parts.first[index], parts.first[index + 1]):
                x_m, y_m, z_m = put_part(place, frames[parts.frame[own]], parts.scale[own], found.pose[own])
                found.velocity_mps[own, 0] = velocity[0] + (turning[1] * z_m - turning[2] * y_m)
                found.velocity_mps[own, 1] = velocity[1] + (turning[2] * x_m - turning[0] * z_m)
                found.velocity_mps[own, 2] = velocity[2] + (turning[0] * y_m - turning[1] * x_m)
                for axis in range(3):
                    found.turning_radps[own, axis] = turning[axis]

    return unlocked(place_bodies)


_place_bodies = _build(_KERNEL_SOURCES)


def _build_eyes(sources: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel of the processor that places sensors; ``sources`` is part of the name of its file."""

    def place_eyes(flat: Rows, parent: I32, relative: F64, poses: F64) -> None:  # pragma: no cover - compiled
        """Write the poses (K, 6) of sensors at ``relative`` (K, 6) to the bodies in rows ``parent`` (K,)."""
        outer = np.empty(6)
        for index in range(len(parent) if sources >= 0 else 0):
            put_eye(flat[parent[index]], relative[index], outer, poses[index])

    return unlocked(place_eyes)


_place_eyes = _build_eyes(_KERNEL_SOURCES)


def placed_parts(parts: PartsOfBodies, flat: Rows, spec_of: I32, specs: Rows, walked_m: F64) -> PlacedParts:
    """Return where the parts of bodies in ``flat`` rows are; columns are of all rows, ``walked_m`` of walkers in m."""
    count = len(parts.mesh)
    found = PlacedParts(*(np.empty((count, *shape), np.float32) for shape in ((3, 4), (3,), (3,))))
    chain = bones()

    def work(start: int, stop: int) -> None:
        _place_bodies(start, stop, flat, spec_of, specs, walked_m, parts, chain, found)

    in_stretches(len(parts.row), work, multiple=1, fewest=_FEWEST)
    return found


def poses_of_eyes(flat: Rows, parent: I32, relative: F64) -> F64:
    """Return the poses (K, 6) of sensors at ``relative`` (K, 6) to bodies in ``flat`` rows ``parent`` (K,)."""
    poses: F64 = np.empty_like(relative)
    _place_eyes(flat, parent, relative, poses)
    return poses
