"""The run of one actor as numpy arrays, with positions in m."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu_carla_log.layouts import Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu_carla_log.log import Log

    F64 = NDArray[np.float64]


CM_PER_M = np.float32(100.0)


def locations_m(log: Log) -> NDArray[np.float32]:
    """(R, 3) a place for each record of positions, CARLA's frame; exact to the last bit in a file of Linden's."""
    positions, bits = log.table(Kind.POSITIONS), log.table(Kind.LAST_BITS)
    plain: NDArray[np.float32] = np.divide(positions.rows["location_cm"], CM_PER_M, dtype=np.float32)
    if not len(bits):
        return plain
    off = np.zeros(plain.shape, dtype=np.int32)
    length = log.frames + 1
    paired = np.bincount(positions.frame, minlength=length) == np.bincount(bits.frame, minlength=length)
    off[paired[positions.frame]] = bits.rows["off"][paired[bits.frame]]
    exact: NDArray[np.float32] = (plain.view(np.int32) + off).view(np.float32)
    return exact


class ActorArrays(NamedTuple):
    """One actor over the frames in which it has a place; nan where the recording has no number. World, CARLA's axes."""

    frame: NDArray[np.int64]  # (N,) from 1
    t_s: F64  # (N,) simulated time since the recording began
    location_m: F64  # (N, 3)
    rotation_deg: F64  # (N, 3) roll, pitch, yaw
    velocity_mps: F64  # (N, 3)
    angular_velocity_degps: F64  # (N, 3)
    acceleration_mps2: F64  # (N, 3) change of velocity since the frame before; 0 in the first
    throttle: F64  # (N,)
    steer: F64  # (N,)
    brake: F64  # (N,)
    gear: F64  # (N,) negative: reverse

    @property
    def speed_mps(self) -> F64:
        """(N,) over ground."""
        speed: F64 = np.linalg.norm(self.velocity_mps, axis=1)
        return speed


def actor_arrays(log: Log, locations_m: NDArray[np.float32], actor_id: int) -> ActorArrays:
    """The arrays of an actor; ``locations_m`` is that of all positions, as :func:`places.locations_m` gives it."""
    chosen = log.table(Kind.POSITIONS).which(actor_id)
    positions = log.table(Kind.POSITIONS)
    frame = positions.frame[chosen]
    t_s = log.elapsed_s[frame - 1]
    velocity = _column(log, Kind.VELOCITIES, "velocity_mps", actor_id, frame)
    return ActorArrays(
        frame=frame,
        t_s=t_s,
        location_m=locations_m[chosen].astype(np.float64),
        rotation_deg=positions.rows["rotation_deg"][chosen].astype(np.float64),
        velocity_mps=velocity,
        angular_velocity_degps=_column(log, Kind.VELOCITIES, "angular_degps", actor_id, frame),
        acceleration_mps2=_change(velocity, t_s),
        **{name: _column(log, Kind.CONTROLS, name, actor_id, frame) for name in ("throttle", "steer", "brake", "gear")},
    )


def _column(log: Log, kind: Kind, name: str, actor_id: int, frame: NDArray[np.int64]) -> F64:
    """Return a column of another table at the requested frames; nan in frames without a record of the actor."""
    found = log.table(kind).of(actor_id)
    values = found.rows[name].astype(np.float64)
    out = np.full((len(frame), *values.shape[1:]), np.nan)
    _, ours, theirs = np.intersect1d(frame, found.frame, return_indices=True)
    out[ours] = values[theirs]
    return out


def _change(velocity_mps: F64, t_s: F64) -> F64:
    """What a velocity changes by in a second."""
    out = np.zeros_like(velocity_mps)
    step_s = np.diff(t_s)[:, None]
    out[1:] = np.divide(np.diff(velocity_mps, axis=0), step_s, out=np.zeros_like(out[1:]), where=step_s > 0.0)
    return out
