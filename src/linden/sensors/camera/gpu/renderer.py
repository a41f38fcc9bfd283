"""Makes the pictures of cameras on a GPU, by the stages of the CPU's: nothing but the picture comes back.

A picture that is expected is begun: then the pictures of a frame are made side by side, each at a desk of its own.
"""

from collections import defaultdict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linden.sensors.camera import optical_flow as motion
from linden.sensors.camera.gpu.buffers import Array, Desk, Letters, Shelf, lit, of_light, of_motion, of_owners, posed
from linden.sensors.camera.gpu.kernels import KERNELS
from linden.sensors.camera.gpu.shading import Shading
from linden.sensors.camera.picture.rgb import light_of, looks_of, places_of
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.sun_shadows import shines
from linden.sensors.camera.picture.surface_points import Places
from linden.sensors.camera.spec import CameraSpec, Film, Picture
from linden.sensors.casting.gpu_memory import Mailbox
from linden.sensors.casting.warp_caster import WarpCaster
from linden.sensors.view import Faces, Look, Seen

Pixels = NDArray[Any]
Waiting = Callable[[], Pixels]
Thing = TypeVar("Thing")


class GpuDarkroom:
    """The GPU's pictures of what one caster sees; see ``linden.sensors.camera.renderer.Darkroom``."""

    def __init__(self, caster: WarpCaster) -> None:
        self._caster, self._gpu = caster, caster.gpu
        self._shelf = Shelf(caster.gpu)
        self._boxes: dict[str, Mailbox] = defaultdict(lambda: Mailbox(caster.gpu))
        self._desks: dict[CameraSpec, list[Desk]] = defaultdict(list)
        self._taken: dict[CameraSpec, int] = {}
        self._of_frame: dict[Hashable, Any] = {}
        self._frame: dict[Hashable, object] | None = None
        self._stage: tuple[Faces, Relief] | None = None

    def expect(self, picture: Picture, look: Look) -> None:
        """Begin a picture that will be asked for in this frame."""
        self._begun(picture, look)

    def make(self, picture: Picture, look: Look) -> Pixels:
        """Return a picture; to be called once in a frame."""
        spec = picture.spec
        return self._begun(picture, look)().reshape(spec.height_px, spec.width_px, -1)

    def _begun(self, picture: Picture, look: Look) -> Waiting:
        """Return what waits for a picture, once begun in a frame."""

        def begin() -> Waiting:
            desk = self._desk(picture.spec, look)
            if picture.film is not None:
                return self._shine(desk, picture.spec, picture.film, look)
            return self._paint(picture.kind, desk, picture.spec, look)

        return self._once((picture, look.pose, look.before), look, begin)

    def _paint(self, kind: str, desk: Desk, spec: CameraSpec, look: Look) -> Waiting:
        """Begin a picture of what was measured."""
        pixel, image = self._shelf.pixel(spec), self._image(desk, spec, kind)
        columns = self._columns(kind, desk, spec, look)
        kernel, count = getattr(KERNELS, kind), desk.sheet.room
        desk.run(kind, self._moves, lambda: desk.gpu.launch(kernel, count, *columns, pixel, image, count))
        return desk.gpu.fetching(image)

    def _columns(self, kind: str, desk: Desk, spec: CameraSpec, look: Look) -> tuple[Any, ...]:
        """Return what the kernel of a kind is given before the picture."""
        sheet = desk.sheet
        if kind == "depth":
            return sheet.hits.distance_m, self._shelf.directions(spec)
        if kind == "normals":
            return sheet.hits, desk.sent("view", {"view": posed(look.pose)})["view"]
        if kind == "flow":
            scale = self._shelf.kept(("scale", spec), lambda: motion.scale(spec))
            return sheet.rays, sheet.hits, *desk.sent("motion", of_motion(look)).values(), scale
        faces, _ = self._on(look.seen)
        whose = self._once("owners", look, lambda: self._sent("owners", of_owners(look.seen)))
        desk.gpu.after(self._gpu)
        if kind == "semantic":
            return sheet.hits, whose["first"], faces.tag
        return sheet.hits, whose["first"], whose["actor_id"], faces, whose["object_id"]

    def _shine(self, desk: Desk, spec: CameraSpec, film: Film, look: Look) -> Waiting:
        """Begin a picture of light."""
        stage = self._on(look.seen)
        places = self._once("places", look, lambda: Places(**self._sent("places", places_of(look.seen)._asdict())))
        here = light_of(look.pose, look.seen, places)
        desk.gpu.after(self._gpu)
        light = lit(here.places, desk.sent("light", of_light(here, film, look.pose)))
        image = self._image(desk, spec, "coloured")
        shading = Shading(desk, self._shelf, spec, film, *stage, light, image, sunny=shines(here.air))
        desk.run(("coloured", film, shading.sunny), self._moves, shading.whole)
        found, made = desk.gpu.fetching(shading.found), desk.gpu.fetching(image)

        def picture() -> Pixels:
            many = int(found()[0])
            if many <= shading.edges_at_once:
                return made()
            shading.rest(many)
            return desk.gpu.fetching(image)()

        return picture

    def _desk(self, spec: CameraSpec, look: Look) -> Desk:
        """Return where the pictures of a view are made, its rays cast."""

        def cast() -> Desk:
            taken = self._taken.get(spec, 0)
            self._taken[spec] = taken + 1
            if taken == len(self._desks[spec]):
                self._desks[spec].append(Desk(self._caster, spec))
            desk = self._desks[spec][taken]
            sheet, towards = desk.sheet, self._shelf.directions(spec)
            desk.gpu.after(self._gpu)
            view = desk.sent("aim", {"view": posed(look.pose)})["view"]

            def work() -> None:
                desk.gpu.launch(KERNELS.aim, sheet.room, towards, view, sheet.rays, sheet.room)
                sheet.cast()

            desk.run("view", self._moves, work)
            return desk

        return self._once(("view", spec, look.pose), look, cast)

    def _once(self, key: Hashable, look: Look, make: Callable[[], Thing]) -> Thing:
        """Return what is made once in a frame, for all its cameras."""
        if self._frame is not look.shared:
            self._frame, self._of_frame, self._taken = look.shared, {}, {}
            for desk in (desk for desks in self._desks.values() for desk in desks):
                self._gpu.after(desk.gpu)
        if key not in self._of_frame:
            self._of_frame[key] = make()
        found: Thing = self._of_frame[key]
        return found

    def _sent(self, box: str, letters: Letters) -> dict[str, Array]:
        return self._boxes[box].send(letters)

    @property
    def _moves(self) -> int:
        return sum(box.moves for box in self._boxes.values())

    def _on(self, seen: Seen) -> tuple[Faces, Relief]:
        if self._stage is None:
            relief = looks_of(seen.standing, seen.bodies).relief
            self._stage = Faces(*map(self._gpu.put, seen.faces)), Relief(*map(self._gpu.put, relief))
        return self._stage

    @staticmethod
    def _image(desk: Desk, spec: CameraSpec, kind: str) -> Array:
        channels, dtype = (2, np.float32) if kind == "flow" else (4, np.uint8)
        return desk.scratch(kind, (spec.height_px * spec.width_px, channels), dtype)
