"""Poses of the parts of many actors at once: wheels that steer and roll, forks, bones of walking pedestrians.

Frames are (3, 4) matrices from the part's frame to the actor's, CARLA's axes, m. Vehicles have ``VEHICLE_FRAMES``,
walkers ``WALKER_FRAMES``; everything else has the first alone, which is the actor's own.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.skeleton import FULL_SWING_MPS, skeleton

F64 = NDArray[np.float64]

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


def vehicle_frames(hubs_m: F64, steer_rad: F64, rolled_rad: F64) -> F64:
    """Return ``VEHICLE_FRAMES`` (N, 6, 3, 4) of vehicles.

    ``hubs_m`` (N, 4, 3) where the wheels' centres are, ``steer_rad`` (N, 4) to the right, ``rolled_rad`` (N, 4)
    forward; what a two-wheeler says of wheels that it lacks is of no account.
    """
    frames = np.zeros((len(hubs_m), len(VEHICLE_FRAMES), 3, 4))
    frames[:, 0, :, :3] = np.eye(3)
    steer = np.concatenate([steer_rad, steer_rad[:, :1]], 1)
    rolled = np.concatenate([rolled_rad, np.zeros_like(rolled_rad[:, :1])], 1)
    frames[:, 1:, :, 3] = np.concatenate([hubs_m, hubs_m[:, :1]], 1)
    cs, ss, cr, sr = np.cos(steer), np.sin(steer), np.cos(rolled), np.sin(rolled)
    # columns: the x, y, z axes of geometry.rotation_matrix at pitch = -rolled, yaw = steer
    frames[:, 1:, 0, 0], frames[:, 1:, 1, 0], frames[:, 1:, 2, 0] = cr * cs, cr * ss, -sr
    frames[:, 1:, 0, 1], frames[:, 1:, 1, 1] = -ss, cs
    frames[:, 1:, 0, 2], frames[:, 1:, 1, 2], frames[:, 1:, 2, 2] = sr * cs, sr * ss, cr
    return frames


class _Chain(NamedTuple):
    """The bones that are shown, those they hang on, and the feet; parents before children."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: F64  # (M, 3), in statures
    shown: list[int]  # rows of WALKER_BONES
    feet: list[int]
    standing: F64  # of the feet, in statures


@lru_cache(maxsize=1)
def _chain() -> _Chain:
    bones = skeleton()
    feet = [f"crl_{part}__{side}" for part in ("foot", "toe") for side in "LR"]
    wanted: set[int] = set()
    for row in (bones.names.index(name) for name in (*WALKER_BONES, *feet)):
        above = row
        while above >= 0:
            wanted.add(above)
            above = bones.parents[above]
    rows = sorted(wanted)
    names = tuple(bones.names[row] for row in rows)
    parents = tuple(rows.index(bones.parents[row]) if bones.parents[row] >= 0 else -1 for row in rows)
    foot_rows = [names.index(name) for name in feet]
    shown = [names.index(name) for name in WALKER_BONES]
    return _Chain(names, parents, bones.offsets[rows], shown, foot_rows, bones.standing[rows][foot_rows])


def walker_frames(stature_m: F64, walked_m: F64, speed_mps: F64) -> F64:
    """Return ``WALKER_FRAMES`` (N, 14, 3, 4) of walkers, all columns (N,): what ``world.skeleton`` says, many at once.

    The actor's origin lies in the middle of its height.
    """
    chain = _chain()
    pitch_rad = _bent_rad(chain, walked_m / (skeleton().stride * stature_m), speed_mps)
    turn = np.zeros_like(pitch_rad)  # all turns are about the y axis, so they add up along a limb
    place = np.zeros((*pitch_rad.shape, 3))
    for row, parent in enumerate(chain.parents):
        offset_m = chain.offsets[row] * stature_m[:, None]
        if parent < 0:
            turn[row], place[row] = pitch_rad[row], offset_m
            continue
        cosine, sine = np.cos(turn[parent]), np.sin(turn[parent])
        place[row] = place[parent]
        place[row, :, 0] += cosine * offset_m[:, 0] - sine * offset_m[:, 2]
        place[row, :, 1] += offset_m[:, 1]
        place[row, :, 2] += sine * offset_m[:, 0] + cosine * offset_m[:, 2]
        turn[row] = turn[parent] + pitch_rad[row]
    sinks_m = (place[chain.feet, :, 2] - chain.standing[:, None] * stature_m).min(0)
    frames = np.zeros((len(stature_m), len(WALKER_FRAMES), 3, 4))
    frames[:, 0, :, :3] = np.eye(3)
    cosine, sine = np.cos(turn[chain.shown]).T, np.sin(turn[chain.shown]).T
    frames[:, 1:, 0, 0], frames[:, 1:, 2, 0], frames[:, 1:, 1, 1] = cosine, sine, 1.0
    frames[:, 1:, 0, 2], frames[:, 1:, 2, 2] = -sine, cosine
    frames[:, 1:, :, 3] = place[chain.shown].transpose(1, 0, 2)
    frames[:, 1:, 2, 3] -= (sinks_m + 0.5 * stature_m)[:, None]
    return frames


def _bent_rad(chain: _Chain, share: F64, speed_mps: F64) -> F64:
    """Return the pitch (M, N) of each bone in its parent's, at a share (N,) of a stride."""
    bones = skeleton()
    pitch_rad = np.zeros((len(chain.names), len(share)))
    swing = np.minimum(1.0, speed_mps / FULL_SWING_MPS)
    for joint, angles_deg in bones.gait_deg.items():
        for side, ahead in (("R", 0.0), ("L", 0.5)):
            bend_deg = np.interp((share + ahead) % 1.0, bones.gait_share, angles_deg, period=1.0)
            row = chain.names.index(f"crl_{joint}__{side}")
            pitch_rad[row] = np.radians(swing * (-bend_deg if joint == "leg" else bend_deg))
    return pitch_rad


def posed_frames(in_actor: F64) -> F64:
    """Return ``WALKER_FRAMES`` (14, 3, 4) of one walker from all its bones' frames in the actor's (B, 4, 4).

    Walkers with a pose from a client use this: ``in_actor`` is that of ``simulation.bones.bones_of``.
    """
    names = skeleton().names
    return np.concatenate([np.eye(4)[None, :3], in_actor[[names.index(bone) for bone in WALKER_BONES], :3]])
