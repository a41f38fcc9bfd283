"""The cameras: each a spec and how its picture is made of what its rays meet."""

from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.actors import ActorDescription
from linden.sensors.camera.events import EventPixels, Events
from linden.sensors.camera.spec import Picture, camera_spec, event_spec, film
from linden.sensors.view import SensorLook

if TYPE_CHECKING:
    from linden.sensors.camera.renderer import Renderer

Pixels: TypeAlias = NDArray[np.uint8] | NDArray[np.float32]


class Image(NamedTuple):
    """A picture of one camera."""

    blueprint: str
    fov_deg: float
    pixels: Pixels  # (height, width, 4) bytes B, G, R, A, or (height, width, 2) floats of a flow


def renderer(look: SensorLook) -> "Renderer":
    """Return the renderer; it is imported when the first camera needs it."""
    from linden.sensors.camera.renderer import renderer_of  # noqa: PLC0415 - see above

    return renderer_of(look.seen.caster)


def pixels(picture: Picture, look: SensorLook) -> Pixels:
    """Return a picture; cameras of one place, kind, lens and film share it."""
    key = (picture, look.pose, look.before)
    if key not in look.shared:
        look.shared[key] = renderer(look).make(picture, look)
    return look.shared[key]  # type: ignore[return-value] # put there above


class Camera:
    """A camera of any kind.

    Attributes:
        picture: what it takes.
    """

    kind: ClassVar[str]

    def __init__(self, description: ActorDescription) -> None:
        """Read the attributes.

        Raises:
            Refusal: no picture can have this size or field of view.
        """
        self.blueprint = description.id
        self.picture = Picture(self.kind, camera_spec(description))

    def expect(self, look: SensorLook) -> None:
        """Begin what ``measure`` will be asked for."""
        renderer(look).expect(self.picture, look)

    def measure(self, look: SensorLook) -> Image:
        """Return the picture of a frame."""
        return Image(self.blueprint, self.picture.spec.fov_deg, pixels(self.picture, look))

    def skip(self, _interval_s: float) -> None:
        """Let a picture pass: none depends on those before it."""


class DepthCamera(Camera):
    """``sensor.camera.depth``: along the camera's axis, in 24 bits."""

    kind = "depth"


class SemanticCamera(Camera):
    """``sensor.camera.semantic_segmentation``: tags."""

    kind = "semantic"


class InstanceCamera(Camera):
    """``sensor.camera.instance_segmentation``: tags and ids."""

    kind = "instance"


class NormalsCamera(Camera):
    """``sensor.camera.normals``: in the camera's view."""

    kind = "normals"


class FlowCamera(Camera):
    """``sensor.camera.optical_flow``: the motion of each pixel since the frame before."""

    kind = "flow"


class ColourCamera(Camera):
    """``sensor.camera.rgb``."""

    kind = "coloured"

    def __init__(self, description: ActorDescription) -> None:
        super().__init__(description)
        self.picture = self.picture._replace(film=film(description))


class EventCamera:
    """``sensor.camera.dvs``: speaks of pixels that become brighter or darker, and not in its first picture."""

    def __init__(self, description: ActorDescription) -> None:
        """Read the attributes.

        Raises:
            Refusal: no picture can have this size or field of view.
        """
        self.picture = Picture(ColourCamera.kind, camera_spec(description), film(description))
        self.events = event_spec(description)
        self._retina: EventPixels | None = None

    def expect(self, look: SensorLook) -> None:
        """Begin what ``measure`` will be asked for."""
        renderer(look).expect(self.picture, look)

    def measure(self, look: SensorLook) -> Events | None:
        """Return what has changed since the last picture, None where nothing has."""
        image, spec = np.asarray(pixels(self.picture, look), np.uint8), self.picture.spec
        if self._retina is None:
            self._retina = EventPixels(self.events, image, look.seen.now_s)
            return None
        found = self._retina.watch(image, look.seen.now_s, look.number)
        return Events(spec.width_px, spec.height_px, spec.fov_deg, found) if len(found) else None

    def skip(self, _interval_s: float) -> None:
        """Forget the last picture: without subscribers the picture of this frame is not rendered."""
        self._retina = None


class CosmosCamera(Camera):
    """``sensor.camera.cosmos_visualization``: lane lines, signs and boxes of actors, in colours on black.

    Attributes:
        ignored: actors that it does not show (``set_ignored_vehicles``).
    """

    kind = "lines"
    ignored: frozenset[int] = frozenset()

    def expect(self, look: SensorLook) -> None:
        """Begin nothing: no ray is cast."""

    def measure(self, look: SensorLook) -> Image:
        """Return the picture of a frame; without an episode it is black."""
        from linden.sensors.camera.strokes import Strokes, draw  # noqa: PLC0415 - compiled code, as the renderer

        spec = self.picture.spec
        strokes = Strokes.none() if look.strokes is None else look.strokes(self.ignored)
        return Image(self.blueprint, spec.fov_deg, draw(spec, look.pose, strokes))


CAMERAS: dict[str, type[Camera] | type[EventCamera]] = {
    "sensor.camera.cosmos_visualization": CosmosCamera,
    "sensor.camera.depth": DepthCamera,
    "sensor.camera.dvs": EventCamera,
    "sensor.camera.instance_segmentation": InstanceCamera,
    "sensor.camera.normals": NormalsCamera,
    "sensor.camera.optical_flow": FlowCamera,
    "sensor.camera.rgb": ColourCamera,
    "sensor.camera.semantic_segmentation": SemanticCamera,
}
"""What makes a camera of a complete description, by its blueprint."""
