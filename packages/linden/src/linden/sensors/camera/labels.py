"""Pictures of what was measured: depth, semantic tags, instances and normals, as CARLA writes them into B, G, R, A.

Source: CARLA 0.9.16, "Sensors reference", and the client's converters. All take what the rays of a camera met, tile by
tile, and return (height, width, 4) bytes, top row first.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Transform
from linden.sensors.camera.pixel_rays import TILE_PX, pixel_of_ray
from linden.sensors.camera.spec import CameraSpec
from linden.sensors.casting.caster import NOTHING, Hits
from linden.sensors.casting.thread_pool import in_stretches
from linden.sensors.view import Seen, first_of_places, id_of_places

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]
U32 = NDArray[np.uint32]

FAR_M = 1000.0
"""Nothing is seen beyond; CARLA's depth pictures end there."""

DEPTH_STEPS = 16777215.0  # 2^24 - 1


def depth(spec: CameraSpec, hits: Hits, vectors: F32) -> U8:
    """Return depth along the camera's axis: R + 256 G + 65536 B counts (2^24 - 1) steps to 1000 m; the sky is there."""
    return _picture(spec, depth_loop, hits.distance_m, vectors)


def depth_m(image: U8) -> F32:
    """Return the metres (height, width) that a depth picture says."""
    blue, green, red = (image[..., channel].astype(np.uint32) for channel in range(3))
    code = red | green << np.uint32(8) | blue << np.uint32(16)
    metres: F32 = (code * (FAR_M / DEPTH_STEPS)).astype(np.float32)
    return metres


def semantic(spec: CameraSpec, hits: Hits, seen: Seen) -> U8:
    """Return the semantic tag of each pixel in R."""
    first = first_of_places(seen.faces, seen.instances)
    return _picture(spec, semantic_loop, hits.instance, hits.triangle, first, seen.faces.tag)


def instance(spec: CameraSpec, hits: Hits, seen: Seen) -> U8:
    """Return the semantic tag in R and the lower 16 bits of the object's or actor's id in G and B, low byte first."""
    places = first_of_places(seen.faces, seen.instances), id_of_places(seen.instances)
    objects = seen.faces.tag, seen.faces.object, seen.object_id
    return _picture(spec, instance_loop, hits.instance, hits.triangle, *places, *objects)


def normals(spec: CameraSpec, hits: Hits, pose: Transform) -> U8:
    """Return normals in the camera's view, (n + 1) / 2: R to the right, G up, B towards the camera; the sky is black.

    CARLA's own material for it is not public; these are the axes of view space, in which such materials are written.
    """
    return _picture(spec, normals_loop, hits.instance, hits.normal, rotation_matrix(pose.rotation).astype(np.float32))


def _picture(spec: CameraSpec, paint: Callable[..., None], *columns: NDArray[Any]) -> U8:
    """Return the picture that a kernel makes of columns, all processors painting."""
    pixel = pixel_of_ray(spec)
    image = np.empty((spec.height_px * spec.width_px, 4), np.uint8)

    def work(start: int, stop: int) -> None:
        paint(*columns, pixel, image, start, stop)

    in_stretches(len(pixel), work, multiple=TILE_PX**2)
    return image.reshape(spec.height_px, spec.width_px, 4)


@unlocked
def depth_loop(distance_m: F32, vectors: F32, pixel: I32, image: U8, start: int, stop: int) -> None:
    """Write the depth of rays ``start`` to ``stop`` into the picture."""
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        ahead_m = min(distance_m[ray] * vectors[ray, 0], np.float32(FAR_M))
        code = np.uint32(np.float64(ahead_m) * (DEPTH_STEPS / FAR_M) + 0.5)
        image[at, 0] = np.uint8(code >> np.uint32(16))
        image[at, 1] = np.uint8((code >> np.uint32(8)) & np.uint32(255))
        image[at, 2] = np.uint8(code & np.uint32(255))
        image[at, 3] = np.uint8(255)


@unlocked
def semantic_loop(
    instances: I32, triangle: I32, first: I64, tags: U8, pixel: I32, image: U8, start: int, stop: int
) -> None:
    """Write the tags of rays ``start`` to ``stop`` into the picture."""
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        place = instances[ray]
        image[at, 0] = image[at, 1] = np.uint8(0)
        image[at, 2] = np.uint8(SemanticTag.SKY) if place == NOTHING else tags[first[place + 1] + triangle[ray]]
        image[at, 3] = np.uint8(255)


@unlocked
def instance_loop(
    instances: I32, triangle: I32, first: I64, actor_id: U32, tags: U8, objects: I32, object_id: U32,
    pixel: I32, image: U8, start: int, stop: int,
) -> None:  # fmt: skip
    """Write tags and ids of rays ``start`` to ``stop`` into the picture."""
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        place = instances[ray]
        number, tag = np.uint32(0), np.uint8(SemanticTag.SKY)
        if place != NOTHING:
            face = first[place + 1] + triangle[ray]
            number, tag = actor_id[place + 1], tags[face]
            if place < 0 and objects[face] >= 0:
                number = object_id[objects[face]]
        image[at, 0] = np.uint8((number >> np.uint32(8)) & np.uint32(255))
        image[at, 1] = np.uint8(number & np.uint32(255))
        image[at, 2] = tag
        image[at, 3] = np.uint8(255)


@unlocked
def normals_loop(instances: I32, normal: F32, turn: F32, pixel: I32, image: U8, start: int, stop: int) -> None:
    """Write the normals of rays ``start`` to ``stop`` into the picture."""
    for ray in range(start, stop):
        at = pixel[ray]
        if at < 0:
            continue
        image[at, 3] = np.uint8(255)
        if instances[ray] == NOTHING:
            image[at, 0] = image[at, 1] = image[at, 2] = np.uint8(0)
            continue
        for axis in range(3):  # of the camera: forward, right, up; which go to B (towards it), R and G
            along = turn[0, axis] * normal[ray, 0] + turn[1, axis] * normal[ray, 1] + turn[2, axis] * normal[ray, 2]
            channel = 0 if axis == 0 else 3 - axis
            value = (1.0 - along if axis == 0 else 1.0 + along) * 127.5
            image[at, channel] = np.uint8(min(max(value + 0.5, 0.0), 255.0))
