"""Optical flow: how far what a pixel shows has moved in the picture since the frame before.

CARLA sends two floats a pixel. Its documentation wants them scaled with the picture's size; measurements found half of
it (carla-simulator/carla, issues 4795 and 8492), as they come from Unreal's velocity in a view that is 2 wide and 2
high, y upwards: pixels are x width / 2 to the right and y height / 2 up. So they are here.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import part, unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform
from linden.sensors.camera.pixel_rays import TILE_PX, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.caster import NOTHING, Hits, Instances, Rays
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_MOST = 2.0
"""The texture that CARLA takes the flow from ends here."""


class Eye(NamedTuple):
    """Where a camera was and how it was turned, (3,) m and (3, 3), columns forward, right and up."""

    place_m: F64
    turn: F64


def eye(pose: Transform) -> Eye:
    """Return a camera's pose as kernels take it."""
    return Eye(np.array(pose.location, np.float64), rotation_matrix(pose.rotation))


def flow(spec: CameraSpec, rays: Rays, hits: Hits, instances: Instances, before: Transform, now: Transform) -> F32:
    """Return (height, width, 2): how far each pixel's surface came to the right and up, of half the picture's size.

    The sky is infinitely far: it moves as the camera turns.
    """
    image = np.empty((spec.height_px * spec.width_px, 2), np.float32)
    carried, pixel = carried_back(instances), pixel_of_ray(spec)
    where = rays.origin_m, rays.direction, hits.distance_m, hits.instance, carried, eye(before), eye(now), scale(spec)

    def work(start: int, stop: int) -> None:
        flow_loop(*where, pixel, image, start, stop)

    in_stretches(len(pixel), work, multiple=TILE_PX**2)
    return image.reshape(spec.height_px, spec.width_px, 2)


def scale(spec: CameraSpec) -> F64:
    """Return (2,) how much of half a picture's size lies between places one metre apart, one metre ahead."""
    return np.array([2.0 * spec.focal_px / spec.width_px, 2.0 * spec.focal_px / spec.height_px])


def carried_back(instances: Instances) -> F64:
    """Return (K, 3, 4): the matrices that bring points on bodies from where they are to where they were a frame ago."""
    now, before = instances.pose.astype(np.float64), instances.before.astype(np.float64)
    turned = before[:, :, :3] @ np.linalg.inv(now[:, :, :3])
    moved = before[:, :, 3] - np.einsum("kij,kj->ki", turned, now[:, :, 3])
    return np.concatenate([turned, moved[:, :, None]], axis=2)


@part
def _slope(turn: F64, x: float, y: float, z: float, axis: int) -> float:
    """Return how far to the right (1) or up (2) a place lies on the plane one metre ahead; far off where behind it."""
    ahead = turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z
    aside = turn[0, axis] * x + turn[1, axis] * y + turn[2, axis] * z
    slope: float = aside / max(ahead, 1e-6)
    return slope


@part
def _through(matrix: F64, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a point through a (3, 4) matrix."""
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z + matrix[0, 3],
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z + matrix[1, 3],
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z + matrix[2, 3],
    )


@unlocked
def flow_loop(
    origin: F32, direction: F32, distance_m: F32, instance: I32, carried: F64, before: Eye, now: Eye, scale: F64,
    pixel: I32, image: F32, start: int, stop: int,
) -> None:  # fmt: skip
    """Write the flow of rays ``start`` to ``stop``."""
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        x, y, z = float(direction[ray, 0]), float(direction[ray, 1]), float(direction[ray, 2])
        u, v, w = x, y, z
        place = instance[ray]
        if place != NOTHING:
            far = float(distance_m[ray])
            x, y, z = origin[ray, 0] + far * x, origin[ray, 1] + far * y, origin[ray, 2] + far * z
            u, v, w = _through(carried[place], x, y, z) if place >= 0 else (x, y, z)
            x, y, z = x - now.place_m[0], y - now.place_m[1], z - now.place_m[2]
            u, v, w = u - before.place_m[0], v - before.place_m[1], w - before.place_m[2]
        for side in range(2):
            moved = _slope(now.turn, x, y, z, side + 1) - _slope(before.turn, u, v, w, side + 1)
            image[at, side] = min(max(moved * scale[side], -_MOST), _MOST)
