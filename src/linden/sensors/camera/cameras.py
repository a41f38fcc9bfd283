"""The cameras: each a spec and how its picture is made of what its rays meet."""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.sensors.camera.darkroom import darkroom_of
from linden.sensors.camera.events import Events, Retina
from linden.sensors.camera.spec import CameraSpec, Film, camera_spec, event_spec, film
from linden.sensors.looking import Look
from linden.values.actors import ActorDescription

Pixels: TypeAlias = NDArray[np.uint8] | NDArray[np.float32]


class Image(NamedTuple):
    """A picture of one camera."""

    blueprint: str
    fov_deg: float
    pixels: Pixels  # (height, width, 4) bytes B, G, R, A, or (height, width, 2) floats of a flow


def coloured(spec: CameraSpec, of_film: Film, look: Look) -> NDArray[np.uint8]:
    """Return the colour picture of a camera; an event camera of the same place, lens and film shares it."""
    key = ("picture", spec, of_film, look.pose)
    if key not in look.shared:
        look.shared[key] = darkroom_of(look.seen.caster).coloured(spec, of_film, look)
    return look.shared[key]  # type: ignore[return-value] # put there above


class Camera:
    """A camera of any kind; subclasses say how its picture is made."""

    def __init__(self, description: ActorDescription) -> None:
        """Read the attributes.

        Raises:
            Refusal: no picture can have this size or field of view.
        """
        self.blueprint = description.id
        self.spec = camera_spec(description)

    def measure(self, look: Look) -> Image:
        """Return the picture of a frame."""
        return Image(self.blueprint, self.spec.fov_deg, self.pixels(look))

    def pixels(self, look: Look) -> Pixels:
        """Return the picture's pixels."""
        raise NotImplementedError

    def skip(self, _interval_s: float) -> None:
        """Let a picture pass: none depends on those before it."""


class DepthCamera(Camera):
    """``sensor.camera.depth``."""

    def pixels(self, look: Look) -> Pixels:
        """Return depth along the camera's axis in 24 bits."""
        return darkroom_of(look.seen.caster).depth(self.spec, look)


class SemanticCamera(Camera):
    """``sensor.camera.semantic_segmentation``."""

    def pixels(self, look: Look) -> Pixels:
        """Return tags."""
        return darkroom_of(look.seen.caster).semantic(self.spec, look)


class InstanceCamera(Camera):
    """``sensor.camera.instance_segmentation``."""

    def pixels(self, look: Look) -> Pixels:
        """Return tags and ids."""
        return darkroom_of(look.seen.caster).instance(self.spec, look)


class NormalsCamera(Camera):
    """``sensor.camera.normals``."""

    def pixels(self, look: Look) -> Pixels:
        """Return normals in the camera's view."""
        return darkroom_of(look.seen.caster).normals(self.spec, look)


class FlowCamera(Camera):
    """``sensor.camera.optical_flow``."""

    def pixels(self, look: Look) -> Pixels:
        """Return the motion of each pixel since the frame before."""
        return darkroom_of(look.seen.caster).flow(self.spec, look)


class ColourCamera(Camera):
    """``sensor.camera.rgb``."""

    def __init__(self, description: ActorDescription) -> None:
        super().__init__(description)
        self.film = film(description)

    def pixels(self, look: Look) -> Pixels:
        """Return colours."""
        return coloured(self.spec, self.film, look)


class EventCamera:
    """``sensor.camera.dvs``: speaks of pixels that become brighter or darker, and not in its first picture."""

    def __init__(self, description: ActorDescription) -> None:
        """Read the attributes.

        Raises:
            Refusal: no picture can have this size or field of view.
        """
        self.spec, self.film, self.events = camera_spec(description), film(description), event_spec(description)
        self._retina: Retina | None = None

    def measure(self, look: Look) -> Events | None:
        """Return what has changed since the last picture, None where nothing has."""
        image = coloured(self.spec, self.film, look)
        if self._retina is None:
            self._retina = Retina(self.events, image, look.seen.now_s)
            return None
        found = self._retina.watch(image, look.seen.now_s, look.number)
        return Events(self.spec.width_px, self.spec.height_px, self.spec.fov_deg, found) if len(found) else None

    def skip(self, _interval_s: float) -> None:
        """Forget the last picture: to remember one that nobody listens to would mean to make it."""
        self._retina = None


CAMERAS: dict[str, type[Camera] | type[EventCamera]] = {
    "sensor.camera.depth": DepthCamera,
    "sensor.camera.dvs": EventCamera,
    "sensor.camera.instance_segmentation": InstanceCamera,
    "sensor.camera.normals": NormalsCamera,
    "sensor.camera.optical_flow": FlowCamera,
    "sensor.camera.rgb": ColourCamera,
    "sensor.camera.semantic_segmentation": SemanticCamera,
}
"""What makes a camera of a complete description, by its blueprint."""
