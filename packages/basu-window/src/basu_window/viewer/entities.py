"""Entities logged to Rerun: static scenery, sensor data, and the actors, signals and events of one tick."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np
import rerun as rr

from basu_window.viewer.layout import TIMELINE, Pose, about_the_vertical, shown, turned

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.metrics.score import Scores
    from basu.records.history import Vehicle
    from basu.routing import Route


SAMPLE_SPACING_M = 2.0
VEHICLE_HEIGHT_M = 2.4  # of the box that is drawn: records hold lengths and widths
GREY, BLUE, GREEN, AMBER, WHITE = (120, 120, 120), (60, 130, 246), (34, 160, 90), (230, 150, 20), (235, 235, 235)
THIN = np.array([-1.0])  # radius in points on the screen: Rerun has it negative
ABOVE_ROAD_M = 0.1


def lane_edges(carla_map: carla.Map) -> list[NDArray[np.float64]]:
    """Left and right edge of every driving lane, each (K, 3) in m, CARLA's frame."""
    lanes: dict[tuple[int, int, int], list[tuple[float, ...]]] = {}
    for waypoint in carla_map.generate_waypoints(SAMPLE_SPACING_M):
        at, right = waypoint.transform.location, waypoint.transform.get_right_vector()
        half_m = waypoint.lane_width / 2.0
        key = (waypoint.road_id, waypoint.section_id, waypoint.lane_id)
        lanes.setdefault(key, []).append(
            (waypoint.s, at.x, at.y, at.z, half_m * right.x, half_m * right.y, half_m * right.z)
        )
    edges = []
    for samples in lanes.values():
        lane = np.array(sorted(samples))
        edges += [lane[:, 1:4] - lane[:, 4:7], lane[:, 1:4] + lane[:, 4:7]]
    return [edge for edge in edges if len(edge) > 1]


def log_map(recording: Any, carla_map: carla.Map) -> None:  # noqa: ANN401 - rerun.RecordingStream
    """The lanes."""
    recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    strips = [shown(edge) for edge in lane_edges(carla_map)]
    recording.log("world/map/lanes", rr.LineStrips3D(strips, colors=[GREY], radii=THIN), static=True)


def log_route(recording: Any, route: Route) -> None:  # noqa: ANN401 - likewise
    """The way as it is planned, and what is on it."""
    way = shown(route.points_m + np.array([0.0, 0.0, ABOVE_ROAD_M]))
    recording.log("world/route", rr.LineStrips3D([way], colors=[BLUE], radii=[0.15]), static=True)
    for path, places, names, colour in (
        ("stops", route.stops, [stop.name for stop in route.stops], GREEN),
        ("controls", route.controls, [control.kind.value for control in route.controls], AMBER),
    ):
        if places:
            points = shown([(place.x_m, place.y_m, place.z_m + ABOVE_ROAD_M) for place in places])
            recording.log(f"world/{path}", rr.Points3D(points, labels=names, colors=[colour], radii=[0.5]), static=True)


def log_vehicle(recording: Any, vehicle: Vehicle) -> None:  # noqa: ANN401 - likewise
    """The box of the vehicle under test, which follows ``world/ego``."""
    half = ((vehicle.front_m + vehicle.rear_m) / 2.0, vehicle.width_m / 2.0, VEHICLE_HEIGHT_M / 2.0)
    centre = ((vehicle.front_m - vehicle.rear_m) / 2.0, 0.0, VEHICLE_HEIGHT_M / 2.0)
    recording.log(
        "world/ego/body",
        rr.Boxes3D(
            half_sizes=[half], centers=[shown(centre)], colors=[WHITE], labels=[vehicle.type_id], show_labels=False
        ),
        static=True,
    )


EVERY_S = 0.1  # of simulated time between two pictures or clouds of one sensor: a file of a whole ride stays handy
JPEG_QUALITY = 75
FAR_M = 1000.0  # what a depth of 1 means: CARLA's cameras, "Depth camera" of the sensors' reference
SMALL, LARGE = np.array([-1.5]), np.array([-3.0])  # radii in points on the screen: Rerun has them negative
SEMANTIC_RAY = np.dtype([("xyz", "<f4", (3,)), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])


def show(recording: Any, sensor_id: str, type_id: str, measured: Any) -> None:  # noqa: ANN401 - rerun and carla
    """Show one measurement; what is neither picture nor cloud is left to the signals."""
    name = rr.escape_entity_path_part(sensor_id)
    if isinstance(measured, carla.Image):
        recording.log(f"cameras/{name}", picture(measured, type_id))
        return
    points = cloud(measured)
    if points is not None:
        at, angle = measured.transform.location, measured.transform.rotation
        pose = Pose(at.x, at.y, at.z, *(math.radians(a) for a in (angle.roll, angle.pitch, angle.yaw)))
        recording.log(f"world/sensors/{name}", rr.Transform3D(translation=shown(pose[:3]), mat3x3=turned(pose)))
        recording.log(f"world/sensors/{name}/points", points)


def picture(image: carla.Image, type_id: str) -> Any:  # noqa: ANN401 - an archetype of Rerun's
    """Return a camera's picture: colours as JPEG, depth in m, tags as classes."""
    bgra = np.frombuffer(image.raw_data, dtype=np.uint8).reshape(image.height, image.width, 4)
    if type_id.endswith("depth"):
        parts = bgra[:, :, :3].astype(np.uint32)
        depth = parts[:, :, 2] + (parts[:, :, 1] << 8) + (parts[:, :, 0] << 16)
        return rr.DepthImage((depth * (FAR_M * 10.0 / 0xFFFFFF)).astype(np.uint16), meter=10.0)
    if type_id.endswith("segmentation"):
        return rr.SegmentationImage(np.ascontiguousarray(bgra[:, :, 2]))
    return rr.Image(np.ascontiguousarray(bgra[:, :, 2::-1])).compress(jpeg_quality=JPEG_QUALITY)


def cloud(measured: Any) -> Any:  # noqa: ANN401 - an archetype of Rerun's
    """Return the points of a lidar or radar in its own frame; None of anything else."""
    if isinstance(measured, carla.LidarMeasurement):
        rays = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)
        return rr.Points3D(shown(rays[:, :3]), colors=grey(rays[:, 3]), radii=SMALL)
    if isinstance(measured, carla.SemanticLidarMeasurement):
        hits = np.frombuffer(measured.raw_data, dtype=SEMANTIC_RAY)
        return rr.Points3D(shown(hits["xyz"]), class_ids=hits["tag"].astype(np.uint16), radii=SMALL)
    if isinstance(measured, carla.RadarMeasurement):
        echoes = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4)  # velocity, azimuth, altitude, depth
        azimuth, altitude, depth_m = echoes[:, 1], echoes[:, 2], echoes[:, 3]
        flat_m = depth_m * np.cos(altitude)
        points = np.column_stack([flat_m * np.cos(azimuth), flat_m * np.sin(azimuth), depth_m * np.sin(altitude)])
        return rr.Points3D(shown(points), colors=[(255, 140, 0)], radii=LARGE)
    return None


def grey(intensity: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(N, 3) a lidar's intensity in [0, 1] as brightness, dim enough to see the road through it."""
    level = (90.0 + 165.0 * np.clip(intensity, 0.0, 1.0)).astype(np.uint8)
    return np.column_stack([level, level, level])


DRIVEN_COLOUR, WALKER_COLOUR, OTHER_COLOUR, INFRACTION_COLOUR = (
    (250, 200, 60),
    (240, 90, 160),
    (90, 190, 230),
    (230, 40, 40),
)
OTHER_HEIGHT_M = 1.6  # of the boxes that are drawn: records hold lengths and widths
DRIVEN_ABOVE_M = 0.3  # the driven path, so that it lies over the planned one
HALF_SIZE_M = (2.3, 0.95)  # of an actor without one in the record


class Driving(NamedTuple):
    """What is driven in a tick: world, CARLA's axes; nan where it is not known."""

    velocity_mps: tuple[float, float, float]
    acceleration_mps2: tuple[float, float, float]
    limit_mps: float
    throttle: float
    steer: float
    brake: float


class Other(NamedTuple):
    """An actor nearby; CARLA's frame."""

    id: int
    type_id: str
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    half_size_m: tuple[float, float] | None  # half length and half width


class TickLogger:
    """Logs the entities of ticks, one after the other."""

    def __init__(self, recording: Any) -> None:  # noqa: ANN401 - rerun.RecordingStream
        self.recording = recording
        self._last: NDArray[np.float64] | None = None
        self._told: set[tuple[str, int, str | None]] = set()

    def tick(self, t_s: float, ego: Pose, driving: Driving, others: Sequence[Other]) -> None:
        """Show all actors and the control; later entities belong to this time too."""
        self.recording.set_time(TIMELINE, duration=t_s)
        self._pose(ego)
        self._signals(ego, driving)
        self._others(others)

    def scores(self, scores: Scores) -> None:
        """Show the scores so far."""
        for name in ("driving", "infraction", "path_following"):
            self.recording.log(f"signals/score/{name}", rr.Scalars([getattr(scores, name)]))

    def infractions(self, found: Sequence[Evidence]) -> None:
        """Show what has not been shown yet of what is held against the driver, at the time it happened."""
        for one in found:
            key = (one.kind.value, one.tick, one.other)
            if key in self._told:
                continue
            self._told.add(key)
            self.recording.set_time(TIMELINE, duration=one.t_s)
            text = f"{one.kind.value}: {one.detail}"
            self.recording.log("events", rr.TextLog(text, level="WARN"))
            place = shown((one.x_m, one.y_m, one.z_m + 3.0))
            self.recording.log(
                "world/infractions",
                rr.Points3D([place], labels=[one.kind.value], colors=[INFRACTION_COLOUR], radii=[0.8]),
            )

    def _pose(self, ego: Pose) -> None:
        self.recording.log("world/ego", rr.Transform3D(translation=shown(ego[:3]), mat3x3=turned(ego)))
        here = shown((ego.x_m, ego.y_m, ego.z_m + DRIVEN_ABOVE_M))
        if self._last is not None:
            self.recording.log(
                "world/driven", rr.LineStrips3D([[self._last, here]], colors=[DRIVEN_COLOUR], radii=[0.12])
            )
        self._last = here

    def _signals(self, ego: Pose, driving: Driving) -> None:
        cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
        east, south, _ = driving.acceleration_mps2
        values: Mapping[str, float] = {
            "speed/driven": math.hypot(*driving.velocity_mps),
            "speed/limit": driving.limit_mps if driving.limit_mps > 0.0 else math.nan,
            "control/throttle": driving.throttle,
            "control/brake": driving.brake,
            "control/steer": driving.steer,
            "acceleration/forward": cos * east + sin * south,
            "acceleration/right": cos * south - sin * east,
        }
        for name, value in values.items():
            if not math.isnan(value):
                self.recording.log(f"signals/{name}", rr.Scalars([value]))

    def _others(self, others: Sequence[Other]) -> None:
        half_height_m = OTHER_HEIGHT_M / 2.0
        sizes = [(*(other.half_size_m or HALF_SIZE_M), half_height_m) for other in others]
        centres = np.array([(other.x_m, other.y_m, other.z_m + half_height_m) for other in others]).reshape(-1, 3)
        self.recording.log(
            "world/others",
            rr.Boxes3D(
                half_sizes=np.array(sizes).reshape(-1, 3),
                centers=shown(centres),
                quaternions=about_the_vertical(np.array([other.yaw_rad for other in others])),
                labels=[f"{other.type_id} {other.id}" for other in others],
                show_labels=False,
                colors=[WALKER_COLOUR if other.type_id.startswith("walker.") else OTHER_COLOUR for other in others],
            ),
        )
