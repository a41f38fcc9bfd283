"""Where actors were, in m: a recording holds cm as 32-bit floats, and Linden's also the bits that this costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.records.carla_log.layouts import Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.carla_log.log import Log

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
