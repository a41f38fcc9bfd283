"""Poses of the actors of a recording, in a frame or interpolated between two frames.

A file may say anything. What it says reaches compiled code that looks things up by place, so it is held within limits.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.replay.file.layouts import PacketId, from_file
from linden.replay.file.packets import Frame

F64 = NDArray[np.float64]

FARTHEST_M = 1e7
"""As far as physics lets a body go."""

_PITCH_YAW_ROLL = [1, 2, 0]


class ActorPlaces(NamedTuple):
    """Where everybody is; N actors of the recording."""

    id: NDArray[np.uint32]
    """(N,)"""
    location_m: F64
    """(N, 3)"""
    rotation_deg: F64
    """(N, 3) pitch, yaw, roll"""


def places(frame: Frame) -> ActorPlaces:
    """Return where everybody was in a frame, to the last bit where the recording is one of Linden's."""
    positions = frame.positions
    ulps = frame.packets.get(PacketId.LOCATION_ULPS)
    location_m = from_file(positions["location_cm"], None if ulps is None else ulps["ulps"])
    rotation_deg = positions["rotation_deg"][:, _PITCH_YAW_ROLL]
    return ActorPlaces(positions["id"], within(location_m, FARTHEST_M), within(rotation_deg, 360.0))


def within(values: NDArray[np.floating[Any]], limit: float) -> F64:
    """Return numbers held between ``-limit`` and ``limit``; what is none is 0."""
    held: F64 = np.clip(np.nan_to_num(values.astype(np.float64), posinf=limit, neginf=-limit), -limit, limit)
    return held


def between(before: ActorPlaces, after: ActorPlaces, share: float) -> ActorPlaces:
    """Return where everybody of ``before`` was at ``share`` in [0, 1] of the way to ``after``.

    Locations go straight, angles the shorter way round, each by itself as Unreal's do. Actors without a later place
    stay.
    """
    if share == 0.0:
        return before
    row_of = {actor_id: row for row, actor_id in enumerate(after.id.tolist())}
    target = np.array([row_of.get(actor_id, -1) for actor_id in before.id.tolist()], np.int64)
    there = target >= 0
    location_m, rotation_deg = before.location_m.copy(), before.rotation_deg.copy()
    location_m[there] += share * (after.location_m[target[there]] - location_m[there])
    turn_deg = after.rotation_deg[target[there]] - rotation_deg[there]
    rotation_deg[there] += share * (turn_deg - 360.0 * np.round(turn_deg / 360.0))
    return ActorPlaces(before.id, location_m, rotation_deg)
