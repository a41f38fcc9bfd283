"""Optical flow: how far what a pixel shows has moved in the picture since the frame before.

CARLA sends two floats a pixel. Its documentation wants them scaled with the picture's size; who measured found half of
it (carla-simulator/carla, issues 4795 and 8492), as they come from Unreal's velocity in a view that is 2 wide and 2
high, y upwards: pixels are x width / 2 to the right and y height / 2 up. So they are here.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.casting.crew import in_stretches
from linden.casting.rays import NOTHING, Hits, Instances, Rays
from linden.compiled import part, unlocked
from linden.geometry import rotation_matrix
from linden.sensors.camera.rays import TILE_PX, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec
from linden.values.space import Transform

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
    scale = np.array([2.0 * spec.focal_px / spec.width_px, 2.0 * spec.focal_px / spec.height_px])
    carried = carried_back(instances)
    carried, pixel = carried_back(instances), pixel_of_ray(spec)
    where = rays.origin_m, rays.direction, hits.distance_m, hits.instance, carried, eye(before), eye(now), scale

    def work(start: int, stop: int) -> None:
        _flow(*where, pixel, image, start, stop)

    in_stretches(len(pixel), work, multiple=TILE_PX**2)
    return image.reshape(spec.height_px, spec.width_px, 2)


def carried_back(instances: Instances) -> F64:
    """Return (K, 3, 4): the matrices that bring points on bodies from where they are to where they were a frame ago."""
    now, before = instances.pose.astype(np.float64), instances.before.astype(np.float64)
    turned = before[:, :, :3] @ np.linalg.inv(now[:, :, :3])
    moved = before[:, :, 3] - np.einsum("kij,kj->ki", turned, now[:, :, 3])
    return np.concatenate([turned, moved[:, :, None]], axis=2)


@part
def _slope(turn: F64, apart: F64, axis: int) -> float:
    """Return how far to the right (1) or up (2) a place lies on the plane one metre ahead; far off where behind it."""
    ahead = turn[0, 0] * apart[0] + turn[1, 0] * apart[1] + turn[2, 0] * apart[2]
    aside = turn[0, axis] * apart[0] + turn[1, axis] * apart[1] + turn[2, axis] * apart[2]
    slope: float = aside / max(ahead, 1e-6)
    return slope


@unlocked
def _flow(
    origin: F32, direction: F32, distance_m: F32, instance: I32, carried: F64, before: Eye, now: Eye, scale: F64,
    pixel: I32, image: F32, start: int, stop: int,
) -> None:  # fmt: skip
    here, then = np.empty(3), np.empty(3)
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        place = instance[ray]
        for axis in range(3):
            far = np.float64(direction[ray, axis])
            here[axis] = far if place == NOTHING else origin[ray, axis] + far * distance_m[ray]
            then[axis] = here[axis]
        if place >= 0:
            for axis in range(3):
                then[axis] = (
                    carried[place, axis, 0] * here[0]
                    + carried[place, axis, 1] * here[1]
                    + carried[place, axis, 2] * here[2]
                    + carried[place, axis, 3]
                )
        if place != NOTHING:
            for axis in range(3):
                here[axis] -= now.place_m[axis]
                then[axis] -= before.place_m[axis]
        for side in range(2):
            moved = (_slope(now.turn, here, side + 1) - _slope(before.turn, then, side + 1)) * scale[side]
            image[at, side] = min(max(moved, -_MOST), _MOST)
