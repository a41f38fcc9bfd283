"""The renderer on a GPU: it uses the stages of the CPU's renderer, and only the picture comes back.

Expected pictures are begun first. So the pictures of a frame are made side by side, each with buffers of its own.
"""

from collections import defaultdict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linden.sensors.camera import optical_flow as motion
from linden.sensors.camera.gpu.buffers import (
    Array,
    ConstantBuffers,
    Inputs,
    ViewBuffers,
    lit,
    of_light,
    of_motion,
    of_owners,
    posed,
)
from linden.sensors.camera.gpu.kernels import KERNELS
from linden.sensors.camera.gpu.shading import Shading
from linden.sensors.camera.picture.rgb import light_of, looks_of, places_of
from linden.sensors.camera.picture.smooth_normals import Relief
from linden.sensors.camera.picture.sun_shadows import shines
from linden.sensors.camera.picture.surface_points import Places
from linden.sensors.camera.spec import CameraSpec, Film, Picture
from linden.sensors.casting.caster import Caster
from linden.sensors.casting.gpu_memory import UploadBuffer
from linden.sensors.casting.warp_caster import WarpCaster
from linden.sensors.view import Faces, Seen, SensorLook

Pixels = NDArray[Any]
Waiting = Callable[[], Pixels]
Thing = TypeVar("Thing")


def gpu_renderer(caster: Caster) -> "GpuRenderer":
    """Return the renderer of what a caster on a GPU sees."""
    assert isinstance(caster, WarpCaster), "a caster on a GPU is Warp's"
    return GpuRenderer(caster)


class GpuRenderer:
    """The GPU's pictures of what one caster sees; see ``linden.sensors.camera.renderer.Renderer``."""

    def __init__(self, caster: WarpCaster) -> None:
        self._caster, self._gpu = caster, caster.gpu
        self._constants = ConstantBuffers(caster.gpu)
        self._boxes: dict[str, UploadBuffer] = defaultdict(lambda: UploadBuffer(caster.gpu))
        self._buffers_of_views: dict[CameraSpec, list[ViewBuffers]] = defaultdict(list)
        self._taken: dict[CameraSpec, int] = {}
        self._of_frame: dict[Hashable, Any] = {}
        self._frame: dict[Hashable, object] | None = None
        self._stage: tuple[Faces, Relief] | None = None

    def expect(self, picture: Picture, look: SensorLook) -> None:
        """Begin a picture that a sensor reads later in this frame."""
        self._begun(picture, look)

    def make(self, picture: Picture, look: SensorLook) -> Pixels:
        """Return a picture; to be called once in a frame."""
        spec = picture.spec
        return self._begun(picture, look)().reshape(spec.height_px, spec.width_px, -1)

    def _begun(self, picture: Picture, look: SensorLook) -> Waiting:
        """Return what waits for a picture, once begun in a frame."""

        def begin() -> Waiting:
            view_buffers = self._view_buffers(picture.spec, look)
            if picture.film is not None:
                return self._shine(view_buffers, picture.spec, picture.film, look)
            return self._paint(picture.kind, view_buffers, picture.spec, look)

        return self._once((picture, look.pose, look.before), look, begin)

    def _paint(self, kind: str, view_buffers: ViewBuffers, spec: CameraSpec, look: SensorLook) -> Waiting:
        """Begin a picture of what was measured."""
        pixel, image = self._constants.pixel(spec), self._image(view_buffers, spec, kind)
        columns = self._columns(kind, view_buffers, spec, look)
        kernel, count = getattr(KERNELS, kind), view_buffers.ray_buffers.room
        view_buffers.run(
            kind, self._moves, lambda: view_buffers.gpu.launch(kernel, count, *columns, pixel, image, count)
        )
        return view_buffers.gpu.fetching(image)

    def _columns(self, kind: str, view_buffers: ViewBuffers, spec: CameraSpec, look: SensorLook) -> tuple[Any, ...]:
        """Return what the kernel of a kind is given before the picture."""
        ray_buffers = view_buffers.ray_buffers
        if kind == "depth":
            return ray_buffers.hits.distance_m, self._constants.directions(spec)
        if kind == "normals":
            return ray_buffers.hits, view_buffers.sent("view", {"view": posed(look.pose)})["view"]
        if kind == "flow":
            scale = self._constants.kept(("scale", spec), lambda: motion.scale(spec))
            return ray_buffers.rays, ray_buffers.hits, *view_buffers.sent("motion", of_motion(look)).values(), scale
        faces, _ = self._on(look.seen)
        owners = self._once("owners", look, lambda: self._sent("owners", of_owners(look.seen)))
        view_buffers.gpu.after(self._gpu)
        if kind == "semantic":
            return ray_buffers.hits, owners["first"], faces.tag
        return ray_buffers.hits, owners["first"], owners["actor_id"], faces, owners["object_id"]

    def _shine(self, view_buffers: ViewBuffers, spec: CameraSpec, film: Film, look: SensorLook) -> Waiting:
        """Begin a picture of light."""
        stage = self._on(look.seen)
        places = self._once("places", look, lambda: Places(**self._sent("places", places_of(look.seen)._asdict())))
        here = light_of(look.pose, look.seen, places)
        view_buffers.gpu.after(self._gpu)
        light = lit(here.places, view_buffers.sent("light", of_light(here, film, look.pose)))
        image = self._image(view_buffers, spec, "coloured")
        shading = Shading(view_buffers, self._constants, spec, film, *stage, light, image, sunny=shines(here.air))
        view_buffers.run(("coloured", film, shading.sunny), self._moves, shading.whole)
        found, made = view_buffers.gpu.fetching(shading.found), view_buffers.gpu.fetching(image)

        def picture() -> Pixels:
            many = int(found()[0])
            if many <= shading.edges_at_once:
                return made()
            shading.rest(many)
            return view_buffers.gpu.fetching(image)()

        return picture

    def _view_buffers(self, spec: CameraSpec, look: SensorLook) -> ViewBuffers:
        """Return where the pictures of a view are made, its rays cast."""

        def cast() -> ViewBuffers:
            taken = self._taken.get(spec, 0)
            self._taken[spec] = taken + 1
            if taken == len(self._buffers_of_views[spec]):
                self._buffers_of_views[spec].append(ViewBuffers(self._caster, spec))
            view_buffers = self._buffers_of_views[spec][taken]
            ray_buffers, towards = view_buffers.ray_buffers, self._constants.directions(spec)
            view_buffers.gpu.after(self._gpu)
            view = view_buffers.sent("aim", {"view": posed(look.pose)})["view"]

            def work() -> None:
                view_buffers.gpu.launch(
                    KERNELS.aim, ray_buffers.room, towards, view, ray_buffers.rays, ray_buffers.room
                )
                ray_buffers.cast()

            view_buffers.run("view", self._moves, work)
            return view_buffers

        return self._once(("view", spec, look.pose), look, cast)

    def _once(self, key: Hashable, look: SensorLook, make: Callable[[], Thing]) -> Thing:
        """Return what is made once in a frame, for all its cameras."""
        if self._frame is not look.shared:
            self._frame, self._of_frame, self._taken = look.shared, {}, {}
            for view_buffers in (
                view_buffers
                for buffers_of_views in self._buffers_of_views.values()
                for view_buffers in buffers_of_views
            ):
                self._gpu.after(view_buffers.gpu)
        if key not in self._of_frame:
            self._of_frame[key] = make()
        found: Thing = self._of_frame[key]
        return found

    def _sent(self, box: str, inputs: Inputs) -> dict[str, Array]:
        return self._boxes[box].send(inputs)

    @property
    def _moves(self) -> int:
        return sum(box.moves for box in self._boxes.values())

    def _on(self, seen: Seen) -> tuple[Faces, Relief]:
        if self._stage is None:
            relief = looks_of(seen.standing, seen.bodies).relief
            self._stage = Faces(*map(self._gpu.put, seen.faces)), Relief(*map(self._gpu.put, relief))
        return self._stage

    @staticmethod
    def _image(view_buffers: ViewBuffers, spec: CameraSpec, kind: str) -> Array:
        channels, dtype = (2, np.float32) if kind == "flow" else (4, np.uint8)
        return view_buffers.scratch(kind, (spec.height_px * spec.width_px, channels), dtype)
