"""The stages of a colour picture on a GPU; see ``linden.sensors.camera.picture.rgb``."""

import numpy as np

from linden.sensors.camera.gpu.buffers import Array, ConstantBuffers, RayBuffers, ViewBuffers, ViewLights
from linden.sensors.camera.gpu.kernels import KERNELS
from linden.sensors.camera.picture import film as develop
from linden.sensors.camera.picture.edges import SAMPLES, offsets
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.surface_points import SHINE
from linden.sensors.camera.pixel_rays import tile_counts
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.view import Faces


class Shading:
    """The kernels that make a picture of the rays of one view.

    Attributes:
        sunny: whether the sun throws shadows.
        found: (1,) how many pixels are edges.
        edges_at_once: for how many of them ``whole`` takes more rays.
    """

    def __init__(
        self, view_buffers: ViewBuffers, constants: ConstantBuffers, spec: CameraSpec, film: Film, faces: Faces,
        relief: Relief, lit: ViewLights, image: Array, *, sunny: bool,
    ) -> None:  # fmt: skip
        self._view_buffers, self._gpu, self._constants, self._spec, self._film = (
            view_buffers,
            view_buffers.gpu,
            constants,
            spec,
            film,
        )
        self._faces, self._relief, self._lit, self._image, self.sunny = faces, relief, lit, image, sunny
        self.found = view_buffers.scratch("found", (1,), np.int32)
        self.edges_at_once = view_buffers.fine.room // SAMPLES
        self._rows = view_buffers.scratch("rows", (view_buffers.ray_buffers.room,), np.int32)

    def whole(self) -> None:
        """Make the picture, with more rays for as many edges as there is room for."""
        self._shine(self._view_buffers.ray_buffers, 1.0)
        self._find_edges()
        self._refine(0)
        self._develop()

    def rest(self, many: int) -> None:
        """Take more rays for the edges that there was no room for."""
        for first in range(self.edges_at_once, many, self.edges_at_once):
            self._refine(first)
        self._develop()

    def _shine(self, ray_buffers: RayBuffers, pixels: float) -> None:
        """Fill in the light along the rays of ``ray_buffers``, each so many pixels wide."""
        gpu, lit, count = self._gpu, self._lit, ray_buffers.room
        if self.sunny:
            towards = self._constants.numbers(count), ray_buffers.facing, ray_buffers.to_sun, ray_buffers.asked
            gpu.launch(KERNELS.to_the_sun, count, ray_buffers.rays, ray_buffers.hits, lit.sun, *towards)
            ray_buffers.cast_to_sun()
        else:
            gpu.launch(KERNELS.dark, count, ray_buffers.sunny, ray_buffers.asked)
        shine, wide = self._constants.kept("shine", lambda: SHINE), np.float32(pixels / self._spec.focal_px)
        looks = wide, self._faces, self._relief, lit.places, shine, lit.air, lit.corner, lit.lamps
        gpu.launch(
            KERNELS.light,
            count,
            ray_buffers.rays,
            ray_buffers.hits,
            ray_buffers.sunny,
            *looks,
            ray_buffers.light,
            ray_buffers.asked,
        )

    def _find_edges(self) -> None:
        """Note which pixels differ from their neighbours, and how many."""
        ray_buffers = self._view_buffers.ray_buffers
        edge = self._view_buffers.scratch("edge", (ray_buffers.room,), np.bool_)
        self._gpu.launch(KERNELS.no_edges, 1, self.found)
        where = *tile_counts(self._spec), edge, self._rows, self.found, ray_buffers.room
        self._gpu.launch(KERNELS.edge, ray_buffers.room, ray_buffers.hits, ray_buffers.light, *where)

    def _refine(self, first: int) -> None:
        """Take more rays of edges, from number ``first`` on as many as there is room for."""
        spec, fine, most = self._spec, self._view_buffers.fine, self.edges_at_once
        aside = self._constants.kept(("offsets", spec), lambda: offsets(spec))
        pose = aside, self._lit.view, fine.rays, fine.asked, most
        self._gpu.launch(KERNELS.split, most, self._constants.directions(spec), self._rows, self.found, first, *pose)
        fine.cast()
        self._shine(fine, 0.5)
        self._gpu.launch(
            KERNELS.mean, most, fine.light, self._rows, first, self._view_buffers.ray_buffers.light, fine.asked
        )

    def _develop(self) -> None:
        """Make bytes of light; see ``develop.developed``."""
        gpu, constants, film, ray_buffers, (across, down) = (
            self._gpu,
            self._constants,
            self._film,
            self._view_buffers.ray_buffers,
            tile_counts(self._spec),
        )
        table = constants.kept(("curve", film), lambda: develop.curve(film))
        downwards = constants.kept(("bloom down", film), lambda: develop.bloom_weights(film)[0])
        sideways = constants.kept(("bloom across", film), lambda: develop.bloom_weights(film)[1])
        over, halo = (self._view_buffers.scratch(name, (down * across, 3), np.float32) for name in ("over", "halo"))
        tiles, factor = down * across, self._lit.factor
        gpu.launch(KERNELS.excess, tiles, ray_buffers.light, factor, over, tiles)
        gpu.launch(KERNELS.spread, tiles, over, downwards, across, across, halo, tiles)
        gpu.launch(KERNELS.spread, tiles, halo, sideways, across, 1, over, tiles)
        made = constants.pixel(self._spec), self._spec.width_px, self._lit.rain, table, self._image, ray_buffers.room
        gpu.launch(
            KERNELS.film, ray_buffers.room, ray_buffers.light, factor, over.reshape(down, across, 3), across, *made
        )
