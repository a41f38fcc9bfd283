"""Poses of the parts of actors: wheels that steer and roll, forks, bones of walking pedestrians.

Compiled functions of one actor (``put_...``) write into arrays that the caller makes, so that a GPU can call them too.

Frames are (3, 4) matrices from the part's frame to the actor's, CARLA's axes, m. Vehicles have ``VEHICLE_FRAMES``,
walkers ``WALKER_FRAMES``; everything else has the first alone, which is the actor's own.
"""

import math
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.skeleton import FULL_SWING_MPS, skeleton
from linden.compiled import kernel, part

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

SOURCE = Path(__file__)
"""For the fingerprint of kernels that are built of the functions of this module."""

VEHICLE_FRAMES = ("actor", "wheel 0", "wheel 1", "wheel 2", "wheel 3", "fork")
"""Wheels in the order of the physics control's; the fork steers with wheel 0 and does not roll."""

FORK = VEHICLE_FRAMES.index("fork")

WALKER_BONES = (
    "crl_hips__C",
    "crl_spine01__C",
    "crl_Head__C",
    *(f"crl_{joint}__{side}" for joint in ("arm", "foreArm", "thigh", "leg", "foot") for side in "LR"),
)
"""Bones that carry a part each."""

WALKER_FRAMES = ("actor", *WALKER_BONES)


class BoneChain(NamedTuple):
    """The bones that are shown, those they hang on, and the feet: M rows, parents before children."""

    parents: I32
    offsets: F64  # (M, 3), in statures
    joint: I32  # row of ``angles_deg``; -1: the bone does not bend
    ahead: F64  # of a stride, which the bone's side is ahead of the other
    sign: F64  # -1 for a knee, which bends back
    shown: I32  # rows of WALKER_BONES
    feet: I32
    standing: F64  # (feet,) their heights over the ground upright, in statures
    stride: F64  # (1,) in statures
    share: F64  # (P,) of a stride, ascending, one before 0 and one beyond 1
    angles_deg: F64  # (J, P)


SCRATCH = 6
"""Numbers a bone that `put_bones` needs room for: its pitch, its cosine and sine, and its place."""

MOST_BONES = 32
"""Bones that a kernel on a GPU has room for."""


@lru_cache(maxsize=1)
def bones() -> BoneChain:
    """Return the skeleton that all walkers have, as arrays for compiled functions."""
    all_bones = skeleton()
    feet = [f"crl_{part}__{side}" for part in ("foot", "toe") for side in "LR"]
    wanted: set[int] = set()
    for row in (all_bones.names.index(name) for name in (*WALKER_BONES, *feet)):
        above = row
        while above >= 0:
            wanted.add(above)
            above = all_bones.parents[above]
    rows = sorted(wanted)
    assert len(rows) <= MOST_BONES, "a kernel on a GPU has room for fewer bones"
    names = [all_bones.names[row] for row in rows]
    joint, ahead, sign = np.full(len(rows), -1, np.int32), np.zeros(len(rows)), np.ones(len(rows))
    for number, name in enumerate(all_bones.gait_deg):
        for side, before in (("R", 0.0), ("L", 0.5)):
            row = names.index(f"crl_{name}__{side}")
            joint[row], ahead[row], sign[row] = number, before, -1.0 if name == "leg" else 1.0
    share, angles_deg = all_bones.gait_share, np.array(list(all_bones.gait_deg.values()))
    foot_rows = [names.index(name) for name in feet]
    return BoneChain(
        parents=np.array(
            [rows.index(all_bones.parents[row]) if all_bones.parents[row] >= 0 else -1 for row in rows], np.int32
        ),
        offsets=all_bones.offsets[rows],
        joint=joint,
        ahead=ahead,
        sign=sign,
        shown=np.array([names.index(name) for name in WALKER_BONES], np.int32),
        feet=np.array(foot_rows, np.int32),
        standing=all_bones.standing[rows][foot_rows],
        stride=np.array([all_bones.stride]),
        share=np.concatenate([share[-1:] - 1.0, share, share[:1] + 1.0]),
        angles_deg=np.concatenate([angles_deg[:, -1:], angles_deg, angles_deg[:, :1]], axis=1),
    )


@part
def put_matrix(pose: F64, found: F64) -> None:  # pragma: no cover - compiled
    """Write the matrix (3, 4) of a pose (6,), m and degrees, as `linden.geometry.rotation_matrix` has it."""
    sp, cp = math.sin(math.radians(pose[3])), math.cos(math.radians(pose[3]))
    sy, cy = math.sin(math.radians(pose[4])), math.cos(math.radians(pose[4]))
    sr, cr = math.sin(math.radians(pose[5])), math.cos(math.radians(pose[5]))
    found[0, 0], found[0, 1], found[0, 2] = cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr
    found[1, 0], found[1, 1], found[1, 2] = cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr
    found[2, 0], found[2, 1], found[2, 2] = sp, -cp * sr, cp * cr
    for axis in range(3):
        found[axis, 3] = pose[axis]


@part
def put_actor(frames: F64) -> None:  # pragma: no cover - compiled
    """Write the actor's own frame, the first of ``frames`` (14, 3, 4)."""
    for i in range(3):
        for j in range(4):
            frames[0, i, j] = 1.0 if i == j else 0.0


@part
def put_wheels(
    x_m: F64, y_m: F64, radius_m: F64, steer_rad: F64, rolled_rad: F64, frames: F64
) -> None:  # pragma: no cover - compiled
    """Write ``VEHICLE_FRAMES``, the first of ``frames`` (14, 3, 4), of one vehicle.

    The hub of each wheel (4,) stands at x, y and its radius. The wheels steer to the right and roll forward.
    """
    put_actor(frames)
    for wheel in range(5):  # the last is the fork
        own = wheel % 4
        steer, rolled = steer_rad[own], (rolled_rad[own] if wheel < 4 else 0.0)
        cs, ss, cr, sr = math.cos(steer), math.sin(steer), math.cos(rolled), math.sin(rolled)
        frame = frames[1 + wheel]
        # columns: the x, y, z axes of geometry.rotation_matrix at pitch = -rolled, yaw = steer
        frame[0, 0], frame[1, 0], frame[2, 0] = cr * cs, cr * ss, -sr
        frame[0, 1], frame[1, 1], frame[2, 1] = -ss, cs, 0.0
        frame[0, 2], frame[1, 2], frame[2, 2] = sr * cs, sr * ss, cr
        frame[0, 3], frame[1, 3], frame[2, 3] = x_m[own], y_m[own], radius_m[own]


@part
def _bend_deg(share: float, shares: F64, angles_deg: F64) -> float:  # pragma: no cover - compiled
    """Return the angle at a share of a stride, linear between those of ``shares``."""
    at = 0
    while at + 2 < len(shares) and shares[at + 1] <= share:
        at += 1
    if shares[at] == share:
        return float(angles_deg[at])
    slope = (angles_deg[at + 1] - angles_deg[at]) / (shares[at + 1] - shares[at])
    return float(slope * (share - shares[at]) + angles_deg[at])


@part
def put_bones(
    stature_m: float, walked_m: float, speed_mps: float, body: BoneChain, scratch: F64, frames: F64
) -> None:  # pragma: no cover - compiled
    """Write ``WALKER_FRAMES`` (14, 3, 4) of one walker, as `linden.blueprints.skeleton.walking_pose` has it.

    The actor's origin lies in the middle of its height. ``scratch`` is (M, SCRATCH).
    """
    put_actor(frames)
    share, swing = walked_m / (body.stride[0] * stature_m), min(1.0, speed_mps / FULL_SWING_MPS)
    for row in range(len(body.parents)):
        own, parent = scratch[row], body.parents[row]
        pitch_rad = 0.0
        if body.joint[row] >= 0:
            bend_deg = _bend_deg((share + body.ahead[row]) % 1.0, body.share, body.angles_deg[body.joint[row]])
            pitch_rad = math.radians(swing * (body.sign[row] * bend_deg))
        x_m, y_m, z_m = (
            body.offsets[row, 0] * stature_m,
            body.offsets[row, 1] * stature_m,
            body.offsets[row, 2] * stature_m,
        )
        if parent < 0:
            own[0], own[3], own[4], own[5] = pitch_rad, x_m, y_m, z_m
        else:  # all turns are about the y axis, so they add up along a limb
            above = scratch[parent]
            own[3] = above[3] + (above[1] * x_m - above[2] * z_m)
            own[4] = above[4] + y_m
            own[5] = above[5] + (above[2] * x_m + above[1] * z_m)
            own[0] = above[0] + pitch_rad
        own[1], own[2] = math.cos(own[0]), math.sin(own[0])
    sinks_m = math.inf
    for foot in range(len(body.feet)):
        sinks_m = min(sinks_m, scratch[body.feet[foot], 5] - body.standing[foot] * stature_m)
    for bone in range(len(body.shown)):
        own, frame = scratch[body.shown[bone]], frames[1 + bone]
        frame[0, 0], frame[0, 1], frame[0, 2], frame[0, 3] = own[1], 0.0, -own[2], own[3]
        frame[1, 0], frame[1, 1], frame[1, 2], frame[1, 3] = 0.0, 1.0, 0.0, own[4]
        frame[2, 0], frame[2, 1], frame[2, 2], frame[2, 3] = own[2], 0.0, own[1], own[5] - (sinks_m + 0.5 * stature_m)


@part
def put_part(
    place: F64, inner: F64, scale: float, pose: F32
) -> tuple[float, float, float]:  # pragma: no cover - compiled
    """Write the pose (3, 4) of a part in the world and return how far it is from its actor's origin, m.

    ``place`` (3, 4) is the actor's pose, and ``inner`` (3, 4) the part's frame in the actor's.
    """
    for i in range(3):
        for j in range(3):
            pose[i, j] = (place[i, 0] * inner[0, j] + place[i, 1] * inner[1, j] + place[i, 2] * inner[2, j]) * scale
    x_m = place[0, 0] * inner[0, 3] + place[0, 1] * inner[1, 3] + place[0, 2] * inner[2, 3]
    y_m = place[1, 0] * inner[0, 3] + place[1, 1] * inner[1, 3] + place[1, 2] * inner[2, 3]
    z_m = place[2, 0] * inner[0, 3] + place[2, 1] * inner[1, 3] + place[2, 2] * inner[2, 3]
    pose[0, 3], pose[1, 3], pose[2, 3] = place[0, 3] + x_m, place[1, 3] + y_m, place[2, 3] + z_m
    return x_m, y_m, z_m


@kernel
def _put_all_matrices(poses: F64, found: F64) -> None:  # pragma: no cover - compiled
    for row in range(len(poses)):
        put_matrix(poses[row], found[row])


def matrices(pose: F64) -> F64:
    """Return (N, 3, 4) matrices of poses (N, 6), m and degrees."""
    found: F64 = np.empty((len(pose), 3, 4))
    _put_all_matrices(np.ascontiguousarray(pose), found)
    return found


@kernel
def _put_all_wheels(hubs_m: F64, steer_rad: F64, rolled_rad: F64, frames: F64) -> None:  # pragma: no cover - compiled
    for row in range(len(hubs_m)):
        hubs = hubs_m[row]
        put_wheels(hubs[:, 0], hubs[:, 1], hubs[:, 2], steer_rad[row], rolled_rad[row], frames[row])


def vehicle_frames(hubs_m: F64, steer_rad: F64, rolled_rad: F64) -> F64:
    """Return ``VEHICLE_FRAMES`` (N, 6, 3, 4) of vehicles.

    ``hubs_m`` (N, 4, 3) are the centres of the wheels, ``steer_rad`` (N, 4) their angles to the right and
    ``rolled_rad`` (N, 4) forward. Rows of wheels that a two-wheeler lacks count for nothing.
    """
    frames: F64 = np.empty((len(hubs_m), len(VEHICLE_FRAMES), 3, 4))
    hubs_m, steer_rad, rolled_rad = (np.ascontiguousarray(each, np.float64) for each in (hubs_m, steer_rad, rolled_rad))
    _put_all_wheels(hubs_m, steer_rad, rolled_rad, frames)
    return frames


@kernel
def _put_all_bones(
    stature_m: F64, walked_m: F64, speed_mps: F64, body: BoneChain, frames: F64
) -> None:  # pragma: no cover - compiled
    scratch = np.empty((len(body.parents), SCRATCH))
    for row in range(len(stature_m)):
        put_bones(stature_m[row], walked_m[row], speed_mps[row], body, scratch, frames[row])


def walker_frames(stature_m: F64, walked_m: F64, speed_mps: F64) -> F64:
    """Return ``WALKER_FRAMES`` (N, 14, 3, 4) of walkers, all columns (N,)."""
    frames: F64 = np.empty((len(stature_m), len(WALKER_FRAMES), 3, 4))
    columns = [np.ascontiguousarray(each, np.float64) for each in (stature_m, walked_m, speed_mps)]
    _put_all_bones(columns[0], columns[1], columns[2], bones(), frames)
    return frames


def posed_frames(in_actor: F64) -> F64:
    """Return ``WALKER_FRAMES`` (14, 3, 4) of one walker from all its bones' frames in the actor's (B, 4, 4).

    Walkers with a pose from a client use this: ``in_actor`` is that of ``simulation.bones.bones_of``.
    """
    names = skeleton().names
    return np.concatenate([np.eye(4)[None, :3], in_actor[[names.index(bone) for bone in WALKER_BONES], :3]])
