"""What does not move: lanes, the planned way, service stops, signs and lights on the way, the shape of the vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr

from basu.output.viewer.frames import shown

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

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
