"""A frame of physics computed before it is asked for: kept aside, and used if nothing has changed until then.

Beside a Traffic Manager in synchronous mode the server is idle from the answer to its batch of controls to the next
tick: half a millisecond, in which the client's threads wake one another. Nearly always nothing moves a body meanwhile.
Whether that is so is not concluded from the calls that came: the bodies are compared with those that were computed
from, byte for byte. So the frame is the one that the tick itself would have made.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.state import Rows
from linden.physics.step import Contacts, advance

MOST_IN_VAIN = 2
"""Frames in a row that were computed in vain; then a program steers between the batch and the tick."""
TRIED_AGAIN = 100
"""Frames after which it is tried again."""

Words = NDArray[np.uint64]


class _Frame(NamedTuple):
    """What was computed, and what from."""

    ground: Ground
    statics: Statics
    dt_s: float
    substeps: int
    count: int
    before: Words
    specs: Words
    after: Words
    contacts: Contacts


class Foresight:
    """The next frame of an episode's bodies, where it is known."""

    def __init__(self) -> None:
        self._frame: _Frame | None = None
        self._in_vain = 0
        self._left_out = 0

    def look_ahead(self, bodies: Bodies, ground: Ground, statics: Statics, dt_s: float, substeps: int) -> None:
        """Compute the frame that these bodies come to; they stay as they are."""
        if self._frame is not None and self._fits(self._frame, bodies, ground, statics, dt_s, substeps):
            return
        if self._in_vain >= MOST_IN_VAIN:
            self._left_out += 1
            if self._left_out < TRIED_AGAIN:
                return
            self._in_vain = self._left_out = 0
        before, specs = _words(bodies.state, bodies.count).copy(), _words(bodies.specs, bodies.count).copy()
        contacts = advance(bodies, ground, statics, dt_s, substeps)
        state = _words(bodies.state, bodies.count)
        self._frame = _Frame(ground, statics, dt_s, substeps, bodies.count, before, specs, state.copy(), contacts)
        state[:] = before

    def advance(self, bodies: Bodies, ground: Ground, statics: Statics, dt_s: float, substeps: int) -> Contacts:
        """Advance the bodies as :func:`linden.physics.step.advance` does; return what touched."""
        frame, self._frame = self._frame, None
        if frame is None:
            return advance(bodies, ground, statics, dt_s, substeps)
        if not self._fits(frame, bodies, ground, statics, dt_s, substeps):
            self._in_vain += 1
            return advance(bodies, ground, statics, dt_s, substeps)
        self._in_vain = 0
        _words(bodies.state, bodies.count)[:] = frame.after
        return frame.contacts

    @staticmethod
    def _fits(frame: _Frame, bodies: Bodies, ground: Ground, statics: Statics, dt_s: float, substeps: int) -> bool:
        """Return whether a frame was computed from just this."""
        return (
            frame.ground is ground
            and frame.statics is statics
            and (frame.dt_s, frame.substeps, frame.count) == (dt_s, substeps, bodies.count)
            and np.array_equal(frame.before, _words(bodies.state, bodies.count))
            and np.array_equal(frame.specs, _words(bodies.specs, bodies.count))
        )


def _words(rows: Rows, count: int) -> Words:
    """Return the rows in use as they lie in memory."""
    words: Words = rows[:count].view(np.ndarray).view(np.uint64)
    return words
