"""The stages of a colour picture on a GPU; see ``linden.sensors.camera.picture.rgb``."""

import numpy as np

from linden.sensors.camera.gpu.buffers import Array, Desk, Lit, Sheet, Shelf
from linden.sensors.camera.gpu.kernels import KERNELS
from linden.sensors.camera.picture import film as develop
from linden.sensors.camera.picture.edges import SAMPLES, offsets
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.surface_points import SHINE
from linden.sensors.camera.pixel_rays import tile_counts
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.view import Faces


class Shading:
    """What is launched to make a picture of the rays of a desk.

    Attributes:
        sunny: whether the sun throws shadows.
        found: (1,) how many pixels are edges.
        edges_at_once: for how many of them ``whole`` takes more rays.
    """

    def __init__(
        self, desk: Desk, shelf: Shelf, spec: CameraSpec, film: Film, faces: Faces, relief: Relief, lit: Lit,
        image: Array, *, sunny: bool,
    ) -> None:  # fmt: skip
        self._desk, self._gpu, self._shelf, self._spec, self._film = desk, desk.gpu, shelf, spec, film
        self._faces, self._relief, self._lit, self._image, self.sunny = faces, relief, lit, image, sunny
        self.found = desk.scratch("found", (1,), np.int32)
        self.edges_at_once = desk.fine.room // SAMPLES
        self._rows = desk.scratch("rows", (desk.sheet.room,), np.int32)

    def whole(self) -> None:
        """Make the picture, with more rays for as many edges as there is room for."""
        self._shine(self._desk.sheet, 1.0)
        self._find_edges()
        self._refine(0)
        self._develop()

    def rest(self, many: int) -> None:
        """Take more rays for the edges that there was no room for."""
        for first in range(self.edges_at_once, many, self.edges_at_once):
            self._refine(first)
        self._develop()

    def _shine(self, sheet: Sheet, pixels: float) -> None:
        """Fill in the light along the rays of a sheet, each so many pixels wide."""
        gpu, lit, count = self._gpu, self._lit, sheet.room
        if self.sunny:
            towards = self._shelf.numbers(count), sheet.facing, sheet.to_sun, sheet.asked
            gpu.launch(KERNELS.to_the_sun, count, sheet.rays, sheet.hits, lit.sun, *towards)
            sheet.cast_to_sun()
        else:
            gpu.launch(KERNELS.dark, count, sheet.sunny, sheet.asked)
        shine, wide = self._shelf.kept("shine", lambda: SHINE), np.float32(pixels / self._spec.focal_px)
        looks = wide, self._faces, self._relief, lit.places, shine, lit.air, lit.corner, lit.lamps
        gpu.launch(KERNELS.light, count, sheet.rays, sheet.hits, sheet.sunny, *looks, sheet.light, sheet.asked)

    def _find_edges(self) -> None:
        """Note which pixels differ from their neighbours, and how many."""
        sheet = self._desk.sheet
        edge = self._desk.scratch("edge", (sheet.room,), np.bool_)
        self._gpu.launch(KERNELS.no_edges, 1, self.found)
        where = *tile_counts(self._spec), edge, self._rows, self.found, sheet.room
        self._gpu.launch(KERNELS.edge, sheet.room, sheet.hits, sheet.light, *where)

    def _refine(self, first: int) -> None:
        """Take more rays of edges, from number ``first`` on as many as there is room for."""
        spec, fine, most = self._spec, self._desk.fine, self.edges_at_once
        aside = self._shelf.kept(("offsets", spec), lambda: offsets(spec))
        pose = aside, self._lit.view, fine.rays, fine.asked, most
        self._gpu.launch(KERNELS.split, most, self._shelf.directions(spec), self._rows, self.found, first, *pose)
        fine.cast()
        self._shine(fine, 0.5)
        self._gpu.launch(KERNELS.mean, most, fine.light, self._rows, first, self._desk.sheet.light, fine.asked)

    def _develop(self) -> None:
        """Make bytes of light; see ``develop.developed``."""
        gpu, shelf, film, sheet, (across, down) = (
            self._gpu,
            self._shelf,
            self._film,
            self._desk.sheet,
            tile_counts(self._spec),
        )
        table = shelf.kept(("curve", film), lambda: develop.curve(film))
        downwards = shelf.kept(("bloom down", film), lambda: develop.bloom_weights(film)[0])
        sideways = shelf.kept(("bloom across", film), lambda: develop.bloom_weights(film)[1])
        over, halo = (self._desk.scratch(name, (down * across, 3), np.float32) for name in ("over", "halo"))
        tiles, factor = down * across, self._lit.factor
        gpu.launch(KERNELS.excess, tiles, sheet.light, factor, over, tiles)
        gpu.launch(KERNELS.spread, tiles, over, downwards, across, across, halo, tiles)
        gpu.launch(KERNELS.spread, tiles, halo, sideways, across, 1, over, tiles)
        made = shelf.pixel(self._spec), self._spec.width_px, self._lit.rain, table, self._image, sheet.room
        gpu.launch(KERNELS.film, sheet.room, sheet.light, factor, over.reshape(down, across, 3), across, *made)
