"""Where the pictures of one view are made on a GPU, beside those of others: memory, and work that was done before."""

from collections.abc import Callable, Hashable, Mapping
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from linden.casting.gpu import Gpu, Mailbox
from linden.casting.warp_caster import WarpCaster
from linden.sensors.camera.gpu.sheets import Sheet
from linden.sensors.camera.picture.edges import SAMPLES
from linden.sensors.camera.rays import directions, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec

_EDGES = 6
"""One in so many pixels gets its samples at once; where more are edges, the others follow, lot after lot."""


class Shelf:
    """Arrays on a GPU that stay as they are, by what they are for."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._kept: dict[Hashable, Any] = {}

    def kept(self, key: Hashable, make: Callable[[], NDArray[Any]]) -> Any:  # noqa: ANN401 - an array of numba's
        """Return the GPU's copy of an array, made once; for what there is one of for each kind of camera."""
        if key not in self._kept:
            self._kept[key] = self._gpu.put(make())
        return self._kept[key]

    def directions(self, spec: CameraSpec) -> Any:  # noqa: ANN401 - an array of numba's
        """Return (N, 3): see ``rays.directions``."""
        return self.kept(("directions", spec), lambda: directions(spec))

    def pixel(self, spec: CameraSpec) -> Any:  # noqa: ANN401 - an array of numba's
        """Return (N,): see ``rays.pixel_of_ray``."""
        return self.kept(("pixel", spec), lambda: pixel_of_ray(spec))

    def numbers(self, count: int) -> Any:  # noqa: ANN401 - an array of numba's
        """Return 0, 1, 2, ... up to ``count`` at least."""
        enough = 1 << max(count - 1, 1).bit_length()
        return self.kept(("numbers", enough), lambda: np.arange(enough, dtype=np.int64))


class Desk:
    """For one view in a frame, and for another one of the same size and lens in the next.

    Attributes:
        gpu: the device, for work that does not wait for that of other desks.
        sheet: its rays.
        fine: more rays of some of its pixels.
    """

    def __init__(self, caster: WarpCaster, spec: CameraSpec) -> None:
        self.gpu, self._caster = caster.gpu.beside(), caster
        count = len(directions(spec))
        self.sheet = Sheet(caster, self.gpu, count)
        self.fine = Sheet(caster, self.gpu, SAMPLES * -(-count // _EDGES))
        self._scratch: dict[str, Any] = {}
        self._boxes: dict[str, Mailbox] = {}
        self._captured: dict[Hashable, Any] = {}
        self._captured_for: tuple[int, ...] = ()

    def scratch(self, name: str, shape: tuple[int, ...], dtype: DTypeLike) -> Any:  # noqa: ANN401 - an array of numba's
        """Return an array that holds its values until the next picture."""
        if name not in self._scratch:
            self._scratch[name] = self.gpu.empty(shape, dtype)
        return self._scratch[name]

    def sent(self, box: str, letters: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return arrays on the GPU, at the same place as those sent before under the name of this box."""
        if box not in self._boxes:
            self._boxes[box] = Mailbox(self.gpu)
        return self._boxes[box].send(letters)

    def run(self, key: Hashable, moves: int, work: Callable[[], None]) -> None:
        """Do ``work``, which only launches kernels on arrays that stay where they are; ``key`` says which work.

        The first time it is done as it stands, which compiles and loads what it needs. The second time what it
        launches is captured, and from then on launched by one call: launching from Python takes longer than most
        kernels run. ``moves`` changes when arrays that are not the desk's lie elsewhere.
        """
        valid_for = (self._caster.trees, moves, *(box.moves for box in self._boxes.values()))
        if valid_for != self._captured_for:
            self._captured, self._captured_for = dict.fromkeys(self._captured), valid_for
        if key not in self._captured:
            self._captured[key] = None
            work()
            return
        if self._captured[key] is None:
            self._captured[key] = self.gpu.capture(work)
        self.gpu.replay(self._captured[key])
