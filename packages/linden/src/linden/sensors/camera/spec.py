"""A camera's attributes, which are text, as the numbers its pictures need."""

import math
from typing import NamedTuple

from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription

LARGEST_SIDE_PX = 8192
LARGEST_AREA_PX = 4096 * 4096
"""Twice a picture of 8 million pixels (4k) takes 0.8 GB to make; more is more likely a slip than a wish."""


class Lens(NamedTuple):
    """CARLA's lens distortion; nothing is distorted where ``circle_multiplier`` is 0, which it is by default."""

    circle_falloff: float = 5.0
    circle_multiplier: float = 0.0
    k: float = -1.0
    kcube: float = 0.0
    x_size: float = 0.08
    y_size: float = 0.08


class CameraSpec(NamedTuple):
    """Size in pixels and horizontal field of view, which every camera has."""

    width_px: int = 800
    height_px: int = 600
    fov_deg: float = 90.0
    lens: Lens = Lens()

    @property
    def focal_px(self) -> float:
        """Distance of the picture's plane from the eye, in pixels."""
        return self.width_px / (2.0 * math.tan(math.radians(self.fov_deg) / 2.0))


class Film(NamedTuple):
    """How the light of a colour picture becomes bytes: Unreal's words, in the units of CARLA's attributes."""

    postprocess: bool = True
    gamma: float = 2.2
    manual: bool = False
    compensation_stops: float = 0.0
    shutter_hz: float = 200.0
    iso: float = 100.0
    fstop: float = 1.4
    bloom: float = 0.675
    temperature_k: float = 6500.0
    tint: float = 0.0


class Picture(NamedTuple):
    """A picture that may be asked for: of light, where there is a film, or of what was measured."""

    kind: str  # depth, semantic, instance, normals, flow or coloured
    spec: CameraSpec
    film: Film | None = None


class EventSpec(NamedTuple):
    """When a pixel of an event camera speaks: steps of brightness, their spread, and the rest after each event."""

    up: float = 0.3
    down: float = 0.3
    up_deviation: float = 0.0
    down_deviation: float = 0.0
    rest_ns: int = 0
    use_log: bool = True
    log_eps: float = 0.001


def camera_spec(description: ActorDescription) -> CameraSpec:
    """Read ``image_size_x``, ``fov`` and the lens of a complete description.

    Raises:
        Refusal: no picture can have this size or field of view.
    """
    width, height = (int(description.attribute(f"image_size_{axis}", "0")) for axis in "xy")
    if not (0 < width <= LARGEST_SIDE_PX and 0 < height <= LARGEST_SIDE_PX):
        raise Refusal(
            f"Spawn failed because of invalid actor description: a picture of {width} x {height} pixels cannot be "
            f"made; image_size_x and image_size_y lie between 1 and {LARGEST_SIDE_PX}"
        )
    if width * height > LARGEST_AREA_PX:
        raise Refusal(
            f"Spawn failed because of invalid actor description: a picture of {width} x {height} pixels cannot be "
            f"made; it has at most {LARGEST_AREA_PX} pixels, such as 4096 x 4096"
        )
    fov_deg = description.number("fov")
    if not 0.0 < fov_deg < 180.0:
        raise Refusal(
            f"Spawn failed because of invalid actor description: no flat picture shows {fov_deg:g} degrees; "
            f"fov lies above 0 and below 180"
        )
    return CameraSpec(width, height, fov_deg, Lens(*(description.number(f"lens_{name}") for name in Lens._fields)))


def film(description: ActorDescription) -> Film:
    """Read the exposure, colour and bloom of a complete description."""
    return Film(
        postprocess=description.flag("enable_postprocess_effects"),
        gamma=description.number("gamma"),
        manual=description.attribute("exposure_mode", "histogram") == "manual",
        compensation_stops=description.number("exposure_compensation"),
        shutter_hz=description.number("shutter_speed"),
        iso=description.number("iso"),
        fstop=description.number("fstop"),
        bloom=description.number("bloom_intensity"),
        temperature_k=description.number("temp"),
        tint=description.number("tint"),
    )


def event_spec(description: ActorDescription) -> EventSpec:
    """Read the thresholds of an event camera's complete description."""
    return EventSpec(
        up=description.number("positive_threshold"),
        down=description.number("negative_threshold"),
        up_deviation=description.number("sigma_positive_threshold"),
        down_deviation=description.number("sigma_negative_threshold"),
        rest_ns=int(description.attribute("refractory_period_ns", "0")),
        use_log=description.flag("use_log"),
        log_eps=description.number("log_eps"),
    )
