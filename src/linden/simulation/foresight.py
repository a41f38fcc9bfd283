"""A frame of physics computed ahead of its tick: kept aside, and used if nothing has changed until the tick.

Beside a Traffic Manager in synchronous mode the server is idle from the answer to its batch of controls to the next
tick: half a millisecond, in which the client's threads wake one another. Nearly always nothing moves a body meanwhile.
The calls in between prove nothing about that. So the bodies are compared, byte for byte, with the bodies that the frame
was computed from, and the frame equals the one of the tick itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.step import Contacts, advance

MOST_IN_VAIN = 2
"""Frames in a row that were computed in vain; then a program steers between the batch and the tick."""
TRIED_AGAIN = 100
"""Frames after which it is tried again."""

Words = NDArray[np.uint64]


class _Frame(NamedTuple):
    """What a frame was computed from, beside the bodies' state, and what touched in it."""

    ground: Ground
    statics: Statics
    dt_s: float
    substeps: int
    bodies: int
    fittings: int
    contacts: Contacts


class Foresight:
    """The next frame of an episode's bodies, where it is known."""

    def __init__(self) -> None:
        self._frame: _Frame | None = None
        self._before: Words = np.empty(0, np.uint64)
        self._after: Words = np.empty(0, np.uint64)
        self._in_vain = 0
        self._left_out = 0

    def look_ahead(self, bodies: Bodies, ground: Ground, statics: Statics, dt_s: float, substeps: int) -> None:
        """Compute the frame that these bodies come to; they stay as they are."""
        if self._in_vain >= MOST_IN_VAIN:
            self._left_out += 1
            if self._left_out < TRIED_AGAIN:
                return
            self._in_vain = self._left_out = 0
        state = _words(bodies)
        if self._frame is not None and self._fits(self._frame, bodies, state, ground, statics, dt_s, substeps):
            return
        self._frame = None
        if len(self._before) != len(state):
            self._before, self._after = np.empty_like(state), np.empty_like(state)
        self._before[:] = state
        try:
            contacts = advance(bodies, ground, statics, dt_s, substeps)
            self._after[:] = state
        except MemoryError:
            return
        finally:
            state[:] = self._before
        self._frame = _Frame(ground, statics, dt_s, substeps, bodies.count, bodies.fittings, contacts)

    def advance(self, bodies: Bodies, ground: Ground, statics: Statics, dt_s: float, substeps: int) -> Contacts:
        """Advance the bodies as :func:`linden.physics.step.advance` does; return what touched."""
        frame, self._frame = self._frame, None
        if frame is None:
            return advance(bodies, ground, statics, dt_s, substeps)
        state = _words(bodies)
        if not self._fits(frame, bodies, state, ground, statics, dt_s, substeps):
            self._in_vain += 1
            return advance(bodies, ground, statics, dt_s, substeps)
        self._in_vain = 0
        state[:] = self._after
        return frame.contacts

    def _fits(
        self,
        frame: _Frame,
        bodies: Bodies,
        state: Words,
        ground: Ground,
        statics: Statics,
        dt_s: float,
        substeps: int,
    ) -> bool:
        """Return whether a frame was computed from just this."""
        return (
            frame.ground is ground
            and frame.statics is statics
            and frame[2:6] == (dt_s, substeps, bodies.count, bodies.fittings)
            and np.array_equal(self._before, state)
        )


def _words(bodies: Bodies) -> Words:
    """Return the state in use as it lies in memory."""
    words: Words = bodies.state[: bodies.count].view(np.ndarray).view(np.uint64)
    return words
