"""What a sensor that looks around is given in a frame of its own, and what every such sensor has to offer."""

from collections.abc import Hashable
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from linden.sensors.seen import Seen
from linden.values.space import Transform

F64 = NDArray[np.float64]


class Look(NamedTuple):
    """One sensor in one frame."""

    seen: Seen
    shared: dict[Hashable, object]
    """What sensors of this frame have found already and others may want too, under keys of their own making."""
    pose: Transform
    """Of the sensor, in the world."""
    before: Transform
    """Where it was one frame earlier; the same place in its first frame."""
    velocity_mps: F64
    """(3,) of the sensor's place, in the world, as its carrier moves it."""
    carrier_id: int
    """The actor it is attached to, 0 where there is none."""
    number: int
    """Of the measurement, counted from the sensor's first, which is 0."""
    interval_s: float
    """Time since the last measurement; that of the frame for the first."""


class LookingSensor(Protocol):
    """A sensor over time."""

    def measure(self, look: Look) -> object | None:
        """Return a reading, None where there is nothing to tell."""
        ...

    def skip(self, interval_s: float) -> None:
        """Let a measurement pass that nobody listens to; no later reading may depend on whether somebody did."""
        ...


@runtime_checkable
class Expectant(Protocol):
    """A sensor whose measurement goes on by itself once it is begun: those of a frame are begun before any is made."""

    def expect(self, look: Look) -> None:
        """Begin what ``measure`` will be asked for with the same look."""
        ...
