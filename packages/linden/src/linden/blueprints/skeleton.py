"""A walker's skeleton: CARLA's bones in human proportions, standing or in the middle of a step.

A pose is each bone's frame in its parent's. Frames are (N, 4, 4) matrices in CARLA's axes, m; that of the root lies
between the feet on the ground.
"""

import json
import math
from functools import lru_cache
from importlib import resources
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import rotation_matrix, rotation_of
from linden.protocol.values.space import Rotation, Transform, Vector3D

F64 = NDArray[np.float64]

FULL_SWING_MPS = 0.8
"""From this speed on legs swing as far as they do at a natural walk; standing, they do not."""


class Skeleton(NamedTuple):
    """The facts, in statures: bones in an order in which parents come before their children."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: F64  # (N, 3), from the parent's beginning
    stride: float
    gait_share: F64  # of a stride, ascending
    gait_deg: dict[str, F64]  # by the joint's name without its side
    standing: F64  # (N,) height of each bone's beginning over the ground, upright

    def row(self, name: str) -> int | None:
        """Return the row of a bone, None where there is none of that name."""
        return self.names.index(name) if name in self.names else None


@lru_cache(maxsize=1)
def skeleton() -> Skeleton:
    """Return the skeleton of all walkers."""
    facts = json.loads(resources.files("linden").joinpath("data/skeleton.json").read_text("utf-8"))
    names = tuple(name for name, _, _ in facts["bones"])
    parents = tuple(names.index(parent) if parent else -1 for _, parent, _ in facts["bones"])
    offsets = np.array([offset for _, _, offset in facts["bones"]])
    return Skeleton(
        names=names,
        parents=parents,
        offsets=offsets,
        stride=facts["stride"],
        gait_share=np.array(facts["gait"].pop("percent")) / 100.0,
        gait_deg={joint: np.array(angles) for joint, angles in facts["gait"].items()},
        standing=_heights_standing(parents, offsets),
    )


def walking_pose(stature_m: float, walked_m: float, speed_mps: float) -> F64:
    """Return the pose after ``walked_m`` of walking: legs half a stride apart, arms against them, one foot down."""
    bones = skeleton()
    pose = np.zeros((len(bones.names), 4, 4))
    pose[:] = np.eye(4)
    pose[:, :3, 3] = bones.offsets * stature_m
    swing = min(1.0, speed_mps / FULL_SWING_MPS)
    share = walked_m / (bones.stride * stature_m)
    for joint, angles_deg in bones.gait_deg.items():
        for side, ahead in (("R", 0.0), ("L", 0.5)):
            bend_deg = np.interp((share + ahead) % 1.0, bones.gait_share, angles_deg, period=1.0)
            row = bones.names.index(f"crl_{joint}__{side}")
            # a knee bends back, all else bends forward; a limb hangs down, and nose up swings it forward
            pitch_deg = swing * float(-bend_deg if joint == "leg" else bend_deg)
            pose[row, :3, :3] = rotation_matrix(Rotation(pitch_deg, 0.0, 0.0))
    feet = [bones.names.index(f"crl_{part}__{side}") for part in ("foot", "toe") for side in "LR"]
    standing_m = bones.standing[feet] * stature_m
    sinks_m = float((in_component(pose)[feet, 2, 3] - standing_m).min())
    pose[bones.names.index("crl_hips__C"), 2, 3] -= sinks_m
    return pose


def _heights_standing(parents: tuple[int, ...], offsets: F64) -> F64:
    """Return the height (N,) of each bone's beginning over the ground, in statures, upright."""
    heights = np.zeros(len(parents))
    for row, parent in enumerate(parents):
        heights[row] = offsets[row, 2] + (heights[parent] if parent >= 0 else 0.0)
    return heights


def in_component(pose: F64) -> F64:
    """Return each bone's frame in that of the whole skeleton."""
    frames = np.empty_like(pose)
    for row, parent in enumerate(skeleton().parents):
        frames[row] = pose[row] if parent < 0 else frames[parent] @ pose[row]
    return frames


def blended(first: F64, second: F64, share: float) -> F64:
    """Return what lies between two poses: places in proportion, turns about one axis (0 is the first)."""
    between = first.copy()
    between[:, :3, 3] += share * (second[:, :3, 3] - first[:, :3, 3])
    for row in range(len(first)):
        turn = first[row, :3, :3].T @ second[row, :3, :3]
        angle = math.acos(min(1.0, max(-1.0, 0.5 * (float(np.trace(turn)) - 1.0))))
        if angle < 1e-9:
            continue
        axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        length = float(np.linalg.norm(axis))
        if length < 1e-9:  # half a turn: the axis is undefined
            between[row, :3, :3] = (first if share < 0.5 else second)[row, :3, :3]
            continue
        x, y, z = axis / length
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        part = share * angle
        rotation = np.eye(3) + math.sin(part) * cross + (1.0 - math.cos(part)) * cross @ cross  # Rodrigues
        between[row, :3, :3] = first[row, :3, :3] @ rotation
    return between


def frame_of(transform: Transform) -> F64:
    """Return a transform as a matrix (4, 4)."""
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation_matrix(transform.rotation), transform.location
    return frame


def transform_of(frame: F64) -> Transform:
    """Return a matrix (4, 4) as a transform."""
    return Transform(Vector3D(*map(float, frame[:3, 3])), rotation_of(frame[:3, :3]))
