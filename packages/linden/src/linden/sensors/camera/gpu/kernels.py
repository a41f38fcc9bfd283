"""Kernels of a GPU: each thread does for its number what the CPU's loops do for theirs, by the same compiled functions.

The loops of ``labels``, ``motion`` and ``picture`` go from ``start`` to ``stop``; here they go from one number to the
next. What stands here besides is what only a GPU wants: stages joined, so that fewer are launched, and what the CPU
leaves to numpy. ``asked`` (1,) says how many rays of a ray_buffers there are, for the CPU does not know in time.

numba renews the kept machine code of a kernel when this file changes, not when one that it calls does: so all kernels
are made by ``_build``, which closes over a fingerprint of the others.
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numba import cuda as numba_cuda

from linden.compiled import fingerprint
from linden.sensors.camera.labels import depth_loop, instance_loop, normals_loop, semantic_loop
from linden.sensors.camera.optical_flow import Eye, flow_loop
from linden.sensors.camera.picture.edges import SAMPLES, mark_loop, mean_loop, split_loop
from linden.sensors.camera.picture.film import develop_loop, excess_loop
from linden.sensors.camera.picture.lamps import LampGrid
from linden.sensors.camera.picture.rgb import BRIGHTEST
from linden.sensors.camera.picture.shade import shade_loop
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.sun_shadows import facing_loop, gather_loop
from linden.sensors.camera.picture.surface_points import Places
from linden.sensors.camera.picture.texture_noise import narrow
from linden.sensors.camera.pixel_rays import aim_loop
from linden.sensors.casting.caster import Hits, Rays
from linden.sensors.view import Faces

Array = Any
"""An array of numba's on a GPU."""

cuda: Any = numba_cuda
"""What it offers it makes up as it is loaded: nothing of that is typed."""

_CAMERA = Path(__file__).parents[1]
_BRIGHTEST = narrow(BRIGHTEST)


def _build(built_of: int) -> SimpleNamespace:  # noqa: C901, PLR0915 - many small ones, each by itself
    """Return the kernels by their names."""

    def kernel(function: Any) -> Any:  # noqa: ANN401 - numba's
        return cuda.jit(cache=True, fastmath=True)(function)

    @kernel
    def aim(vectors: Array, view: Array, rays: Rays, count: int) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            aim_loop(vectors, view[:, :3], view[:, 3], rays.origin_m, rays.direction, i, i + 1)

    @kernel
    def depth(distance_m: Array, vectors: Array, pixel: Array, image: Array, count: int) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            depth_loop(distance_m, vectors, pixel, image, i, i + 1)

    @kernel
    def semantic(hits: Hits, first: Array, tags: Array, pixel: Array, image: Array, count: int) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            semantic_loop(hits.instance, hits.triangle, first, tags, pixel, image, i, i + 1)

    @kernel
    def instance(
        hits: Hits,
        first: Array,
        actor_id: Array,
        faces: Faces,
        object_id: Array,
        pixel: Array,
        image: Array,
        count: int,
    ) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            owner = first, actor_id, faces.tag, faces.object, object_id
            instance_loop(hits.instance, hits.triangle, *owner, pixel, image, i, i + 1)

    @kernel
    def normals(hits: Hits, view: Array, pixel: Array, image: Array, count: int) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            normals_loop(hits.instance, hits.normal, view[:, :3], pixel, image, i, i + 1)

    @kernel
    def flow(
        rays: Rays, hits: Hits, carried: Array, places_m: Array, turns: Array, scale: Array, pixel: Array, image: Array,
        count: int,
    ) -> None:  # fmt: skip
        """``places_m`` (2, 3) and ``turns`` (2, 3, 3) of the camera: a frame before, and now."""
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            before, now = Eye(places_m[0], turns[0]), Eye(places_m[1], turns[1])
            met = rays.origin_m, rays.direction, hits.distance_m, hits.instance
            flow_loop(*met, carried, before, now, scale, pixel, image, i, i + 1)

    @kernel
    def to_the_sun(
        rays: Rays, hits: Hits, sun: Array, itself: Array, facing: Array, to_sun: Rays, asked: Array
    ) -> None:
        """Mark what the sun could reach, and say where rays to it begin; ``itself`` (N,) are the numbers from 0 on."""
        i = cuda.grid(1)
        if i < asked[0] and built_of >= 0:
            facing_loop(hits.instance, hits.normal, rays.direction, sun, facing, i, i + 1)
            if facing[i]:
                met = rays.origin_m, rays.direction, hits.distance_m, hits.normal
                gather_loop(itself, *met, sun, to_sun.origin_m, to_sun.direction, i, i + 1)

    @kernel
    def dark(sunny: Array, asked: Array) -> None:
        i = cuda.grid(1)
        if i < asked[0] and built_of >= 0:
            sunny[i] = np.float32(0.0)

    @kernel
    def light(
        rays: Rays, hits: Hits, sunny: Array, pixel_rad: float, faces: Faces, relief: Relief, places: Places,
        shine: Array, air: Array, corner: Array, lamps: tuple[Array, Array, Array], light: Array, asked: Array,
    ) -> None:  # fmt: skip
        """``corner`` (2,) of the grid of lamps, west and north."""
        i = cuda.grid(1)
        if i < asked[0] and built_of >= 0:
            grid = LampGrid(corner[0], corner[1], lamps[0], lamps[1], lamps[2])
            shade_loop(rays, hits, sunny, pixel_rad, faces, relief, places, shine, air[0], grid, light, i, i + 1)

    @kernel
    def no_edges(found: Array) -> None:
        found[0] = 0

    @kernel
    def edge(
        hits: Hits, light: Array, across: int, down: int, edge: Array, rows: Array, found: Array, count: int
    ) -> None:
        """Put the numbers of edge pixels into ``rows``, in any order, and how many they are into ``found`` (1,)."""
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            mark_loop(hits.instance, hits.distance_m, hits.normal, light, across, down, edge, i, i + 1)
            if edge[i]:
                rows[cuda.atomic.add(found, 0, 1)] = i

    @kernel
    def split(
        vectors: Array, rows: Array, found: Array, first: int, offsets: Array, view: Array, rays: Rays, asked: Array,
        count: int,
    ) -> None:  # fmt: skip
        """Make the samples of up to ``count`` edge pixels from ``first`` on, and write how many samples they are."""
        i = cuda.grid(1)
        many = min(count, found[0] - first)
        if i == 0:
            asked[0] = SAMPLES * max(many, 0)
        if i < many and built_of >= 0:
            pose = view[:, :3], view[:, 3]
            split_loop(vectors, rows[first:], offsets, *pose, rays.origin_m, rays.direction, i, i + 1)

    @kernel
    def mean(samples: Array, rows: Array, first: int, light: Array, asked: Array) -> None:
        i = cuda.grid(1)
        if SAMPLES * i < asked[0] and built_of >= 0:
            mean_loop(samples, _BRIGHTEST, rows[first:], light, i, i + 1)

    @kernel
    def excess(light: Array, factor: Array, over: Array, count: int) -> None:
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            excess_loop(light, factor, over, i, i + 1)

    @kernel
    def spread(over: Array, weights: Array, across: int, step: int, spread: Array, count: int) -> None:
        """Spread light (tiles, 3) along one axis: ``step`` 1 across, else by rows of ``across`` tiles."""
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            reach = len(weights) // 2
            place, places = (i % across, across) if step == 1 else (i // across, count // across)
            for channel in range(3):
                total = np.float32(0.0)
                for k in range(-reach, reach + 1):
                    if 0 <= place + k < places:
                        total += weights[k + reach] * over[i + k * step, channel]
                spread[i, channel] = total

    @kernel
    def film(
        light: Array, factor: Array, halo: Array, across: int, pixel: Array, width: int, rain: Array, table: Array,
        image: Array, count: int,
    ) -> None:  # fmt: skip
        i = cuda.grid(1)
        if i < count and built_of >= 0:
            drops = rain[0], rain[1], rain[2]
            develop_loop(light, factor, halo, across, pixel, width, *drops, table, image, i, i + 1)

    return SimpleNamespace(
        aim=aim, depth=depth, semantic=semantic, instance=instance, normals=normals, flow=flow, to_the_sun=to_the_sun,
        dark=dark, light=light, no_edges=no_edges, edge=edge, split=split, mean=mean, excess=excess, spread=spread,
        film=film,
    )  # fmt: skip


KERNELS = _build(fingerprint(*_CAMERA.glob("*.py"), *_CAMERA.glob("picture/*.py")))
