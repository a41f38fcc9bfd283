"""The event camera: which pixels crossed a step of brightness between two pictures, and when.

Source: CARLA 0.9.16, DVSCamera.cpp, after Gehrig et al. 2018 ("ESIM: an Open Event Camera Simulator"). One thing
differs: CARLA keeps the time of a pixel's last event as a float of seconds, so that its rest is wrong by more and more;
here it is nanoseconds.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.sensors.camera.spec import EventSpec
from linden.structured import StructuredArray

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]

EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("t", "<i8"), ("polarity", "?")])
"""As it goes over the wire (DVSEvent.h, packed): pixel, ns of simulated time, brighter or darker."""
assert EVENT.itemsize == 13

MOST_EVENTS = 4 * 1024 * 1024
"""Of one frame: nine of each pixel of 800 x 600. What is further down in the picture has none then."""
_NOT_YET = -1
_LEAST_STEP = 0.01
_SAME = 1e-6
_GREY = np.array([0.114, 0.587, 0.299], np.float32)  # of B, G, R: ITU-R BT.601


class Events(NamedTuple):
    """What an event camera saw between two frames, in the order of time."""

    width_px: int
    height_px: int
    fov_deg: float
    events: StructuredArray  # of EVENT


class EventPixels:
    """What an event camera remembers of each pixel; changed by :meth:`watch`."""

    def __init__(self, spec: EventSpec, image: U8, now_s: float) -> None:
        self._spec = spec
        self._before = brightness(spec, image)
        self._crossed = self._before.copy()
        self._spoke_ns = np.full(self._before.shape, _NOT_YET, np.int64)
        self._now_ns = nanoseconds(now_s)

    def watch(self, image: U8, now_s: float, number: int) -> StructuredArray:
        """Return the events between the last picture and this one, the ``number``-th of the camera."""
        spec, light, now_ns = self._spec, brightness(self._spec, image), nanoseconds(now_s)
        up, down = (
            self._steps(step, deviation, number, side)
            for side, (step, deviation) in enumerate(((spec.up, spec.up_deviation), (spec.down, spec.down_deviation)))
        )
        found = _watch(self._before, light, self._crossed, self._spoke_ns, up, down, spec.rest_ns, self._now_ns, now_ns)
        self._before, self._now_ns = light, now_ns
        order = np.argsort(found[:, 2], kind="stable")
        events = np.empty(len(found), EVENT)
        events["x"], events["y"], events["t"], events["polarity"] = found[order].T
        return events

    def _steps(self, step: float, deviation: float, number: int, side: int) -> F32:
        """Return the step of each pixel, or (1, 1) where all have the same."""
        if deviation <= 0.0:
            return np.full((1, 1), step, np.float32)
        stream = np.random.Generator(np.random.Philox(key=np.array([number, side], np.uint64)))
        drawn = step + deviation * stream.standard_normal(self._before.shape, dtype=np.float32)
        steps: F32 = np.maximum(drawn, np.float32(_LEAST_STEP))
        return steps


def nanoseconds(seconds: float) -> int:
    """Return a time in whole nanoseconds."""
    return round(seconds * 1e9)


def brightness(spec: EventSpec, image: U8) -> F32:
    """Return how bright each pixel (height, width) of a picture B, G, R, A is: its logarithm, or 0 to 255."""
    grey = image[:, :, :3].astype(np.float32) @ _GREY
    bright: F32 = np.log(np.float32(spec.log_eps) + grey / np.float32(255.0)) if spec.use_log else grey
    return bright


@kernel
def _watch(
    before: F32, light: F32, crossed: F32, spoke_ns: I64, up: F32, down: F32, rest_ns: int, start_ns: int, end_ns: int
) -> I64:
    """Return events (N, 4) of x, y, ns and polarity, row by row; notes them in ``crossed`` and ``spoke_ns``."""
    found: I64 = np.empty((1024, 4), np.int64)
    count = 0
    height, width = before.shape
    for y in range(height):
        for x in range(width):
            was, now = before[y, x], light[y, x]
            if abs(now - was) <= _SAME:
                continue
            brighter = now > was
            steps = up if brighter else down
            step = steps[y % steps.shape[0], x % steps.shape[1]]
            level = crossed[y, x]
            while step > 0.0:
                level += step if brighter else -step
                if not (was < level <= now if brighter else now <= level < was):
                    break
                at_ns = start_ns + int((level - was) * (end_ns - start_ns) / (now - was))
                if spoke_ns[y, x] == _NOT_YET or at_ns - spoke_ns[y, x] >= rest_ns:
                    if count == MOST_EVENTS:
                        return found
                    if count == len(found):
                        found = np.concatenate((found, np.empty_like(found)))
                    found[count, 0], found[count, 1], found[count, 2], found[count, 3] = x, y, at_ns, brighter
                    count += 1
                    spoke_ns[y, x] = at_ns
                crossed[y, x] = level
    return found[:count]
