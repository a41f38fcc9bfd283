"""Camera and sensor pictures of the HUD: its own camera behind the vehicle, and the agent's sensors."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu.errors import SimulatorError
from basu.managers.sensors_manager import PARTING_TICKS
from basu_window.hud.canvas import GREEN, GREY, WHITE, YELLOW
from basu_window.hud.readings import compass_point, degrees, fix_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.managers.base_manager import Run
    from basu_window.hud.canvas import Canvas


BEHIND_M, ABOVE_M, DOWN_DEG = 4.5, 1.6, 12.0  # of the vehicle's rear and roof: it fills the lower middle of the picture


class ChaseCamera:
    """After ``look``, ``latest`` is the newest picture."""

    def __init__(self, run: Run, size: tuple[int, int], every_s: float) -> None:
        """Attach it and begin to take pictures.

        Args:
            run: with the vehicle.
            size: of the picture, in pixels.
            every_s: simulated time from picture to picture; 0 for one a tick.

        Raises:
            SimulatorError: this simulator has no cameras.
        """
        self._world, self._timeout_s = run.world, run.timeout_s
        box = run.vehicle.bounding_box
        pose = carla.Transform(
            carla.Location(x=box.location.x - box.extent.x - BEHIND_M, z=box.location.z + box.extent.z + ABOVE_M),
            carla.Rotation(pitch=-DOWN_DEG),
        )
        self._looks = False
        self.latest: tuple[bytes, tuple[int, int]] | None = None  # BGRA, and its width and height
        actor = None
        try:
            blueprint = run.world.get_blueprint_library().find("sensor.camera.rgb")
            for name, value in (("image_size_x", size[0]), ("image_size_y", size[1]), ("sensor_tick", every_s)):
                blueprint.set_attribute(name, str(value))
            self._actor = actor = run.world.spawn_actor(blueprint, pose, attach_to=run.vehicle)
            self.look(begin=True)
        except (RuntimeError, IndexError) as error:
            if actor is not None:
                actor.destroy()
            raise SimulatorError(f"no camera: {error}") from error

    def look(self, *, begin: bool) -> None:
        """Begin or stop to take pictures."""
        if begin and not self._looks:
            self._actor.listen(self._take)
        elif not begin and self._looks:
            self._actor.stop()
        self._looks = begin

    def close(self) -> None:
        """Take the camera away, once what is under way has arrived."""
        with contextlib.suppress(RuntimeError):  # the simulator is gone, and the camera with it
            if self._looks:
                self._actor.stop()
                for _ in range(PARTING_TICKS):
                    self._world.tick(self._timeout_s)
            self._actor.destroy()

    def _take(self, image: carla.Image) -> None:
        """Keep the bytes and let go of the image; called on a thread of the client."""
        self.latest = bytes(image.raw_data), (image.width, image.height)


Measured = tuple[int, Any]  # the server's frame, and what CARLA's client hands to a listener
DARK = (24, 26, 30)
RINGS_M = (10.0, 20.0, 40.0, 80.0)
FAR_M = 1000.0  # what a depth of 1 means: CARLA's sensor reference, "Depth camera"
NEAR_M = 1.0  # what is nearer than this is black in a depth picture
MOVING_MPS = 0.5  # radar echoes that come or go faster than this are drawn in a colour
SEMANTIC_RAY = np.dtype([("xyz", "<f4", (3,)), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])
GOLDEN = 0.618034  # of a turn of the hue from tag to tag, so that neighbours differ


class SensorView:
    """Which sensor is shown, and how; ``shown`` is its id, None while the window shows camera or map."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self.shown: str | None = None

    def step(self, types: Mapping[str, str]) -> None:
        """Go on to the next sensor of the set; after the last, to none."""
        ids = list(types)
        following = 0 if self.shown is None else ids.index(self.shown) + 1
        self.shown = ids[following] if following < len(ids) else None

    def draw(self, canvas: Canvas, left: float, types: Mapping[str, str], data: Mapping[str, Measured]) -> None:
        """Draw the latest measurement right of ``left``."""
        assert self.shown is not None, "the window asks only while a sensor is shown"
        canvas.fill(DARK)
        type_id, measured = types[self.shown], data.get(self.shown)
        if measured is None:
            canvas.text((left + 20, 60), "nothing measured yet", GREY, size=24)
        elif isinstance(measured[1], carla.Image):
            image = measured[1]
            canvas.picture(picture(image, type_id), (image.width, image.height), left)
        else:
            points = cloud(measured[1])
            if points is None:
                self._draw_readings(canvas, left, measured[1])
            else:
                _draw_points(canvas, left, points)
        canvas.shade((left, 0, canvas.size[0] - left, 28), 0.6)
        canvas.text((left + 10, 7), f"{self.shown}: {type_id.removeprefix('sensor.')}", size=22)
        if measured is not None:
            canvas.text((canvas.size[0] - 10, 9), f"frame {measured[0]}", GREY, align=1.0)

    def _draw_readings(self, canvas: Canvas, left: float, measured: Any) -> None:  # noqa: ANN401 - any of carla's
        """Lines of words and figures."""
        for row, (name, value) in enumerate(readings(self._run.carla_map, measured)):
            canvas.text((left + 30, 70 + 40 * row), name, GREY, size=26)
            canvas.text((left + 230, 70 + 40 * row), value, WHITE, size=26)


def readings(carla_map: carla.Map, measured: Any) -> list[tuple[str, str]]:  # noqa: ANN401 - any of carla's
    """Return what a sensor measured as pairs of a name and a value with its unit."""
    if isinstance(measured, carla.GnssMeasurement):
        fix = fix_of(carla_map, measured, measured.transform.location)
        latitude, longitude = degrees(fix, 7)
        return [("Latitude", latitude), ("Longitude", longitude), ("Altitude", f"{fix.altitude_m:.2f} m")]
    if isinstance(measured, carla.IMUMeasurement):
        force, spin, heading_deg = measured.accelerometer, measured.gyroscope, math.degrees(measured.compass)
        return [
            *((f"Acceleration {axis}", f"{getattr(force, axis):+.2f} m/s²") for axis in "xyz"),
            *((f"Turn rate {axis}", f"{math.degrees(getattr(spin, axis)):+.2f} °/s") for axis in "xyz"),
            ("Compass", f"{heading_deg:.1f}° {compass_point(heading_deg)}"),
        ]
    if isinstance(measured, carla.CollisionEvent):
        impulse = measured.normal_impulse
        other = measured.other_actor
        return [
            ("Last collision", "nothing" if other is None else str(other.type_id)),
            ("Impulse", f"{math.hypot(impulse.x, impulse.y, impulse.z):.0f} N s"),
        ]
    if isinstance(measured, carla.LaneInvasionEvent):
        return [("Last line crossed", ", ".join(str(mark.type) for mark in measured.crossed_lane_markings))]
    if isinstance(measured, carla.ObstacleDetectionEvent):
        return [("Obstacle", str(measured.other_actor.type_id)), ("Distance", f"{measured.distance:.1f} m")]
    return [("Measured", type(measured).__name__)]


def picture(image: carla.Image, type_id: str) -> bytes:
    """Return a camera's picture as BGRA: colours as they are, depth as logarithmic grey, tags as colours."""
    raw = bytes(image.raw_data)
    if not type_id.endswith(("depth", "segmentation")):
        return raw
    bgra = np.frombuffer(raw, dtype=np.uint8).reshape(-1, 4)
    shown = np.full_like(bgra, 255)
    if type_id.endswith("depth"):
        parts = bgra[:, :3].astype(np.float64)
        depth_m = FAR_M * (parts[:, 2] + 256.0 * parts[:, 1] + 65536.0 * parts[:, 0]) / 0xFFFFFF
        grey = np.log(np.maximum(depth_m, NEAR_M) / NEAR_M) / math.log(FAR_M / NEAR_M)
        shown[:, :3] = (255.0 * grey[:, None]).astype(np.uint8)
    else:
        shown[:, :3] = tag_colours(bgra[:, 2])
    return shown.tobytes()


def tag_colours(tags: NDArray[np.integer[Any]]) -> NDArray[np.uint8]:
    """Return a colour (N, 3) for each tag: hues apart, tag 0 black."""
    hue = (np.asarray(tags, dtype=np.float64) * GOLDEN)[:, None] + np.array([0.0, 1.0 / 3.0, 2.0 / 3.0])
    colours = 140.0 + 100.0 * np.cos(math.tau * hue)
    colours[np.asarray(tags) == 0] = 0.0
    return np.asarray(colours, dtype=np.uint8)


def cloud(measured: Any) -> tuple[NDArray[np.float64], NDArray[np.uint8]] | None:  # noqa: ANN401 - any of carla's
    """Return the points of a lidar or radar: (N, 2) m ahead and to the right, and (N, 3) colours; None for others."""
    if isinstance(measured, carla.LidarMeasurement):
        rays = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)
        level = (80.0 + 175.0 * np.clip(rays[:, 3], 0.0, 1.0)).astype(np.uint8)
        return rays[:, :2].astype(np.float64), np.column_stack([level, level, level])
    if isinstance(measured, carla.SemanticLidarMeasurement):
        hits = np.frombuffer(measured.raw_data, dtype=SEMANTIC_RAY)
        return hits["xyz"][:, :2].astype(np.float64), tag_colours(hits["tag"])
    if isinstance(measured, carla.RadarMeasurement):
        echoes = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4).astype(np.float64)
        velocity_mps, azimuth, altitude, depth_m = echoes.T
        flat_m = depth_m * np.cos(altitude)
        colours = np.where(np.abs(velocity_mps)[:, None] > MOVING_MPS, np.array(YELLOW), np.array(WHITE))
        return np.column_stack([flat_m * np.cos(azimuth), flat_m * np.sin(azimuth)]), colours.astype(np.uint8)
    return None


def _draw_points(canvas: Canvas, left: float, points: tuple[NDArray[np.float64], NDArray[np.uint8]]) -> None:
    """Draw points from above, ahead is up, the sensor in the middle; rings show the distance."""
    places_m, colours = points
    width, height = canvas.size
    middle = np.array([(left + width) / 2.0, height / 2.0])
    farthest_m = float(np.abs(places_m).max()) if len(places_m) else 0.0
    reach_m = next((ring_m for ring_m in RINGS_M if ring_m >= 0.7 * farthest_m), RINGS_M[-1])
    scale = 0.5 * height / reach_m
    for ring_m in RINGS_M:
        canvas.circle((middle[0], middle[1]), scale * ring_m, (60, 64, 70), border=1)
        canvas.text((middle[0] + scale * ring_m - 4, middle[1] + 2), f"{ring_m:.0f} m", GREY, align=1.0)
    pixels = np.column_stack([middle[0] + scale * places_m[:, 1], middle[1] - scale * places_m[:, 0]])
    canvas.points(pixels, colours, left)
    canvas.polygon(middle + np.array([[0.0, -7.0], [5.0, 6.0], [-5.0, 6.0]]), GREEN)
