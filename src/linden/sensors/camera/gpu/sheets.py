"""Memory on a GPU for the rays of one camera: what they are, what they met, and the light that came along them."""

import numpy as np

from linden.casting.gpu import Gpu
from linden.casting.rays import Hits, Rays
from linden.casting.warp_caster import Asked, WarpCaster
from linden.sensors.camera.labels import FAR_M
from linden.sensors.camera.picture.shadows import LONGEST_SHADOW_M


class Sheet:
    """Arrays of numba's for up to ``room`` rays; ``asked`` (1,) says how many they are, on the device too."""

    def __init__(self, caster: WarpCaster, gpu: Gpu, room: int) -> None:
        self._caster, self._gpu = caster, gpu
        self.room = room
        self.asked = gpu.put(np.array([room], np.int32))
        self.rays = Rays(*(gpu.empty((room, 3), np.float32) for _ in range(2)))
        self.hits = Hits(
            gpu.empty((room,), np.float32),
            gpu.empty((room,), np.int32),
            gpu.empty((room,), np.int32),
            gpu.empty((room, 3), np.float32),
        )
        self.facing, self.sunny = gpu.empty((room,), np.bool_), gpu.empty((room,), np.float32)
        self.to_sun = Rays(*(gpu.empty((room, 3), np.float32) for _ in range(2)))
        self.light = gpu.empty((room, 3), np.float32)
        count = gpu.view(self.asked)
        self._questions = [Asked(room, [gpu.view(a) for a in rays], count) for rays in (self.rays, self.to_sun)]
        self._hits = [gpu.view(a) for a in self.hits]
        self._masks = [gpu.view(self.facing), gpu.view(self.sunny)]

    def cast(self) -> None:
        """Find what the rays meet; they go out through the inner sides of bodies."""
        self._caster.closest_into(self._questions[0], self._hits, FAR_M, self._gpu)

    def cast_to_sun(self) -> None:
        """Find which of what faces the sun it reaches."""
        self._caster.sunny_into(self._questions[1], self._masks, LONGEST_SHADOW_M, self._gpu)
