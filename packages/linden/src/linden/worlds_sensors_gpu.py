"""`GpuSensors`: lidars, depth and tags of many worlds, measured on a GPU by one launch for all of them."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.errors import UserError
from linden.sensors.camera.labels import FAR_M
from linden.sensors.camera.pixel_rays import directions, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.thread_pool import in_stretches
from linden.sensors.casting.warp_caster import WarpCaster
from linden.sensors.casting.warp_worlds import DeviceArray, WorldBodies, WorldEyes, WorldHits, WorldsCaster
from linden.sensors.devices.lidar.firing_pattern import Fan, Fired, fire
from linden.sensors.devices.lidar.sensor import draw
from linden.sensors.devices.lidar.sweep import Losses, points_of
from linden.sensors.view import Seen

F32 = NDArray[np.float32]

_FEWEST = 8
"""Worlds that a thread takes at least."""


class Eyes(NamedTuple):
    """The sensors of K worlds, and the bodies that they may see."""

    at: WorldEyes
    bodies: WorldBodies


class GpuSensors:
    """Measures in many worlds at once; depth, tags and distances are those of the sensors of the server on a GPU."""

    def __init__(self, base: Seen) -> None:
        """Take the scene from the moment ``base`` of a world without bodies."""
        assert isinstance(base.caster, WarpCaster), "a caster on a GPU is Warp's"
        self._caster = WorldsCaster(base.caster, base.faces.first, base.faces.tag)

    def picture(self, kind: str, spec: CameraSpec, eyes: Eyes) -> DeviceArray:
        """Return (K, H, W) pictures of kind "depth" (m, float32) or "semantic" (tags, uint8) on the device."""
        towards, pixel, size = directions(spec), pixel_of_ray(spec), spec.height_px * spec.width_px
        hits = self._cast(eyes, towards, FAR_M)
        if kind == "depth":
            made = self._caster.depth_m(hits, towards, pixel, size)
        else:
            made = self._caster.semantic(hits, pixel, size)
        return made.reshape((eyes.at.place.shape[0], spec.height_px, spec.width_px))

    def scans(
        self, fan: Fan, losses: Losses, start_deg: float, interval_s: float, eyes: Eyes
    ) -> tuple[DeviceArray, DeviceArray]:
        """Return (K, C, P) points with four columns and (K, C, P) whether each ray returned, both on the device.

        Raises:
            UserError: the lidar loses or moves points by chance, and the dice are on the host.
        """
        if losses.by_chance:
            raise UserError(
                "a lidar with on_device=True can lose and move no points by chance; give it "
                "dropoff_general_rate=0.0, dropoff_zero_intensity=0.0 and noise_stddev=0.0, or use on_device=False"
            )
        fired, towards = _rays(fan, start_deg, interval_s)
        hits = self._cast(eyes, towards, fan.range_m)
        shape = eyes.at.place.shape[0], len(fired.up), len(fired.sine)
        points, returned = self._caster.points(hits, towards, losses.attenuation_per_m)
        return points.reshape(shape), returned.reshape(shape)

    def write_scans(
        self, fan: Fan, losses: list[Losses], start_deg: float, interval_s: float, eyes: Eyes, numbers: list[int],
        points: F32, returned: NDArray[np.bool_],
    ) -> None:  # fmt: skip
        """Write points (K, R, 4) and which rays returned (K, R) of measurements ``numbers`` (K) with losses (K)."""
        fired, towards = _rays(fan, start_deg, interval_s)
        distance_m: F32 = self._cast(eyes, towards, fan.range_m).distance_m.numpy()

        def work(start: int, stop: int) -> None:
            for row in range(start, stop):
                rays, chances = draw(losses[row], fired.rays, numbers[row])
                _, met, kept = points_of(fired, rays, distance_m[row, rays], losses[row], chances)
                points[row, kept], returned[row, kept] = met, True

        in_stretches(len(numbers), work, multiple=1, fewest=_FEWEST)

    def _cast(self, eyes: Eyes, towards: F32, farthest_m: float) -> WorldHits:
        return self._caster.cast(eyes.bodies, eyes.at, towards, farthest_m)


@lru_cache(maxsize=16)
def _rays(fan: Fan, start_deg: float, interval_s: float) -> tuple[Fired, F32]:
    """Return the rays of a sweep, and their unit vectors (R, 3) in the frame of the sensor."""
    fired = fire(fan, start_deg, interval_s)
    towards: NDArray[Any] = np.empty((len(fired.up), len(fired.sine), 3), np.float32)
    towards[..., 0] = fired.level[:, None] * fired.cosine
    towards[..., 1] = fired.level[:, None] * fired.sine
    towards[..., 2] = fired.up[:, None]
    return fired, towards.reshape(-1, 3)
