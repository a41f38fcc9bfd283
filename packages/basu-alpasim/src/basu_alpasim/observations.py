"""Observations as messages of the protocol: cameras, ego motion, route, and CARLA's data.

CARLA's data (``CarlaRendererData``) are an extension of ``carla-driver-interface``. They hold what an agent of BASU
knows: the actors that it sees, the lights on its route, the posted limit. A policy made for AlpaSim does not read them.
"""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from carla_driver_interface.contract import CONTRACT_REVISION, camera_to_revision
from carla_driver_interface.geometry import Trajectory, waypoints_to_proto
from carla_driver_interface.protocol import (
    AABB,
    AvailableCamera,
    CameraSpec,
    CarlaActorState,
    CarlaRendererData,
    DriveSessionRequest,
    DynamicState,
    OpenCVPinholeCameraParam,
    RolloutCameraImage,
    RolloutEgoTrajectory,
    Route,
    RouteRequest,
    ShutterType,
    StopPoint,
    TrafficLight,
    TrafficLightState,
    Vec3,
    pack_lidar_sweep,
)
from PIL import Image

from basu.agents.sight import ActorKind
from basu_alpasim.frames import camera_in_rig, dynamic_state, pose_of, rig_pose, sensor_in_rig

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from carla_driver_interface.geometry import Pose
    from carla_driver_interface.protocol import LidarSweep
    from numpy.typing import NDArray

    from basu.agents.sensor_file import SensorSpec
    from basu.agents.sight import Other
    from basu.records.motion import VehicleMotion
    from basu.routing import Route as PlannedRoute
    from basu.routing import RouteControl

CAMERA, LIDAR = "sensor.camera.rgb", "sensor.lidar.ray_cast"
WAYPOINTS, WAYPOINT_EVERY_M = 20, 4.0  # of a route: AlpaSim's route_generator.py, NUM_WAYPOINTS
JPEG_QUALITY = 95  # AlpaSim asks its renderer for JPEG
LIGHT_AHEAD_M = 60.0  # the next light on the route is named from here on, as far as BASU's own agents look
SEED = 0  # of a policy that draws random numbers: the same in every drive

STATE_OF_LIGHT = {
    "Red": TrafficLightState.TRAFFIC_LIGHT_STATE_RED,
    "Yellow": TrafficLightState.TRAFFIC_LIGHT_STATE_YELLOW,
    "Green": TrafficLightState.TRAFFIC_LIGHT_STATE_GREEN,
    "Off": TrafficLightState.TRAFFIC_LIGHT_STATE_OFF,
}
TYPE_OF_KIND = {ActorKind.VEHICLE: "vehicle", ActorKind.WALKER: "walker", ActorKind.PROP: "static.prop"}


def session_request(
    session: str, cameras: Iterable[SensorSpec], rear_axle_m: float, revision: int
) -> DriveSessionRequest:
    """Return the request for a session with these cameras; it names no scene, as AlpaSim's benchmark does not."""
    request = DriveSessionRequest(session_uuid=session, random_seed=SEED)
    declared = (available_camera(spec, rear_axle_m) for spec in cameras)
    request.rollout_spec.vehicle.available_cameras.extend(
        camera_to_revision(camera, CONTRACT_REVISION, revision) for camera in declared
    )
    return request


def available_camera(spec: SensorSpec, rear_axle_m: float) -> AvailableCamera:
    """Return a camera of ours, an ideal pinhole without distortion and with a global shutter."""
    attributes = dict(spec.attributes)
    width, height = int(attributes.get("image_size_x", "800")), int(attributes.get("image_size_y", "600"))
    focal_px = width / (2.0 * math.tan(math.radians(float(attributes.get("fov", "90"))) / 2.0))
    lens = OpenCVPinholeCameraParam(
        principal_point_x=width / 2.0,
        principal_point_y=height / 2.0,
        focal_length_x=focal_px,
        focal_length_y=focal_px,
        radial_coeffs=[0.0] * 6,
        tangential_coeffs=[0.0] * 2,
        thin_prism_coeffs=[0.0] * 4,
    )
    intrinsics = CameraSpec(
        opencv_pinhole_param=lens,
        logical_id=spec.id,
        resolution_w=width,
        resolution_h=height,
        shutter_type=ShutterType.GLOBAL,
    )
    pose = camera_in_rig(spec, rear_axle_m).to_proto()
    return AvailableCamera(intrinsics=intrinsics, rig_to_camera=pose, logical_id=spec.id)


def image_observation(session: str, camera: str, time_us: int, measured: Any) -> RolloutCameraImage:  # noqa: ANN401
    """Return a picture as JPEG; ``measured`` is a ``carla.Image`` (BGRA), or an array of its pixels."""
    if isinstance(measured, np.ndarray):
        pixels = measured[:, :, :3]
    else:
        shape = (measured.height, measured.width, 4)
        pixels = np.frombuffer(measured.raw_data, dtype=np.uint8).reshape(shape)[:, :, :3]
    written = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels[:, :, ::-1])).save(written, format="JPEG", quality=JPEG_QUALITY)
    observation = RolloutCameraImage(session_uuid=session)
    observation.camera_image.logical_id = camera
    observation.camera_image.frame_start_us = observation.camera_image.frame_end_us = time_us
    observation.camera_image.image_bytes = written.getvalue()
    return observation


def egomotion(session: str, motions: Sequence[tuple[int, VehicleMotion]], rear_axle_m: float) -> RolloutEgoTrajectory:
    """Return poses and motion of the rig at times in µs, the earliest first."""
    poses = Trajectory([time_us for time_us, _ in motions], [rig_pose(motion, rear_axle_m) for _, motion in motions])
    states: list[DynamicState] = [dynamic_state(motion, rear_axle_m) for _, motion in motions]
    return RolloutEgoTrajectory(session_uuid=session, trajectory=poses.to_proto(), dynamic_states=states)


def route_ahead(session: str, time_us: int, route: PlannedRoute, s_m: float, rig: Pose) -> RouteRequest:
    """Return the next points of the route in the rig's frame, from beside its origin on, 4 m apart.

    AlpaSim fills a route that ends with NaN up to 20 points. Here it has fewer points then.
    """
    places_m = s_m + WAYPOINT_EVERY_M * np.arange(WAYPOINTS)
    places_m = np.append(places_m[places_m < route.length_m], route.length_m)[:WAYPOINTS]
    points_m: NDArray[np.float64] = np.column_stack(
        [np.interp(places_m, route.s_m, route.points_m[:, axis]) for axis in range(3)]
    ) * (1.0, -1.0, 1.0)
    waypoints = waypoints_to_proto(rig.inverse().transform_points(points_m))
    return RouteRequest(session_uuid=session, route=Route(timestamp_us=time_us, waypoints=waypoints))


def light_message(control: RouteControl, state: str) -> TrafficLight:
    """Return a light on the route with the place of its line."""
    place = StopPoint(position_local=Vec3(x=control.x_m, y=-control.y_m, z=control.z_m))
    shown = STATE_OF_LIGHT.get(state, TrafficLightState.TRAFFIC_LIGHT_STATE_UNKNOWN)
    return TrafficLight(opendrive_id=control.landmark_id, state=shown, stop_points=[place])


def actor_message(other: Other) -> CarlaActorState:
    """Return an actor that is seen: its box and its velocity in the box's axes."""
    pose = pose_of(other.x_m, other.y_m, other.z_m, yaw_rad=other.yaw_rad)
    mirrored = [other.velocity_x_mps, -other.velocity_y_mps, 0.0]
    along_m, across_m, up_m = pose.rotation.inv().apply(mirrored).tolist()
    return CarlaActorState(
        track_id=str(other.id),
        type_id=TYPE_OF_KIND[other.kind],
        pose_local_to_aabb=pose.to_proto(),
        aabb=AABB(size_x=2.0 * other.half_length_m, size_y=2.0 * other.half_width_m, size_z=2.0 * other.half_height_m),
        dynamic_state=DynamicState(
            linear_velocity=Vec3(x=along_m, y=across_m, z=up_m), angular_velocity=Vec3(z=-other.yaw_rate_radps)
        ),
    )


def sweep(spec: SensorSpec, time_us: int, measured: Any, rear_axle_m: float) -> LidarSweep:  # noqa: ANN401
    """Return the points of a ``carla.LidarMeasurement``, or of its (N, 4) array, in the rig's frame."""
    raw = measured if isinstance(measured, np.ndarray) else np.frombuffer(measured.raw_data, dtype=np.float32)
    points = raw.reshape(-1, 4)
    mount = sensor_in_rig(spec, rear_axle_m)
    placed = mount.transform_points(points[:, :3].astype(np.float64) * (1.0, -1.0, 1.0))
    return pack_lidar_sweep(spec.id, time_us, np.column_stack([placed, points[:, 3]]), mount.to_proto())


def renderer_data(
    *,
    time_us: int,
    frame: int,
    town: str,
    limit_mps: float,
    lights: Sequence[tuple[RouteControl, str]],
    s_m: float,
    others: Iterable[Other],
    sweeps: Iterable[LidarSweep],
) -> bytes:
    """Return CARLA's data of a frame; ``lights`` on the route have their states, the vehicle is at ``s_m``."""
    data = CarlaRendererData(
        snapshot_timestamp_us=time_us,
        frame_id=frame,
        map_name=town,
        speed_limit_mps=0.0 if math.isnan(limit_mps) else limit_mps,
        ego_traffic_light=TrafficLightState.TRAFFIC_LIGHT_STATE_NONE,
        ego_traffic_light_distance_m=-1.0,
        actors=[actor_message(other) for other in others],
        lidar=sweeps,
        traffic_lights=[light_message(control, state) for control, state in lights],
    )
    ahead = [(control.s_m - s_m, state) for control, state in lights if 0.0 <= control.s_m - s_m <= LIGHT_AHEAD_M]
    if ahead:
        data.ego_traffic_light_distance_m, state = min(ahead)
        data.ego_traffic_light = STATE_OF_LIGHT.get(state, TrafficLightState.TRAFFIC_LIGHT_STATE_UNKNOWN)
    written: bytes = data.SerializeToString()
    return written
