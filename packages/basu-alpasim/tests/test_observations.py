"""Claims about observations: what is sent has the frames and the times of the protocol."""

import io
import math

import numpy as np
import pytest
from carla_driver_interface.geometry import Pose
from carla_driver_interface.protocol import (
    CarlaRendererData,
    TrafficLightState,
    unpack_lidar_points,
    unpack_renderer_data,
)
from PIL import Image

from basu.agents.sensor_file import parse_sensors
from basu.agents.sight import ActorKind, Other
from basu.routing import ControlKind, RouteControl
from basu_alpasim import observations
from basu_alpasim.basic_policy import other_of, sent_route
from basu_alpasim.frames import pose_of

AXLE_M = 1.4
CAMERA = {"type": "sensor.camera.rgb", "id": "front", "x": 1.0, "z": 1.5, "width": 640, "height": 480, "fov": 90}
LIDAR = {"type": "sensor.lidar.ray_cast", "id": "top", "x": 0.0, "z": 2.0, "yaw": 90.0}
CAR = Other(
    id=42,
    kind=ActorKind.VEHICLE,
    x_m=20.0,
    y_m=-3.0,
    yaw_rad=0.8,
    velocity_x_mps=4.0,
    velocity_y_mps=5.0,
    yaw_rate_radps=0.2,
    half_length_m=2.4,
    half_width_m=1.0,
    z_m=0.7,
)


def light(s_m: float, landmark: str) -> RouteControl:
    """Return a light on the route."""
    return RouteControl(
        kind=ControlKind.TRAFFIC_LIGHT, landmark_id=landmark, s_m=s_m, x_m=s_m, y_m=2.0, z_m=0.0, yaw_rad=0.0
    )


def carlas_data(s_m: float, *lights: tuple[RouteControl, str]) -> CarlaRendererData:
    """Return CARLA's data as a policy reads them."""
    sent = observations.renderer_data(
        time_us=100_000, frame=2, town="T", limit_mps=math.nan, lights=lights, s_m=s_m, others=[CAR], sweeps=[]
    )
    read = unpack_renderer_data(sent)
    assert read is not None
    return read


def test_a_camera_has_the_focal_length_of_its_field_of_view() -> None:
    (spec,) = parse_sensors([CAMERA], "the test")
    camera = observations.available_camera(spec, AXLE_M)
    lens = camera.intrinsics.opencv_pinhole_param
    assert (lens.focal_length_x, lens.focal_length_y) == pytest.approx((320.0, 320.0))
    assert (lens.principal_point_x, lens.principal_point_y) == (320.0, 240.0)
    assert (camera.intrinsics.resolution_w, camera.intrinsics.resolution_h) == (640, 480)


def test_the_first_revision_declares_the_body_of_a_camera() -> None:
    (spec,) = parse_sensors([CAMERA], "the test")
    request = observations.session_request("s", [spec], AXLE_M, 1)
    body = Pose.from_proto(request.rollout_spec.vehicle.available_cameras[0].rig_to_camera)
    assert body.rotation.apply([1.0, 0.0, 0.0]) == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert not request.HasField("debug_info")  # no scene


def test_a_picture_is_red_where_carla_s_is() -> None:
    bgra = np.zeros((16, 16, 4), np.uint8)
    bgra[:, :, 2] = 255
    sent = observations.image_observation("s", "front", 300_000, bgra).camera_image
    red, green, blue = Image.open(io.BytesIO(sent.image_bytes)).getpixel((8, 8))
    assert red > 240
    assert max(green, blue) < 15
    assert (sent.frame_start_us, sent.frame_end_us, sent.logical_id) == (300_000, 300_000, "front")


def test_a_route_begins_beside_the_rear_axle_and_has_20_points_4_m_apart() -> None:
    along = np.arange(0.0, 200.0, 1.0)
    route = sent_route(Pose.identity(), np.column_stack([along, 0.0 * along, 0.0 * along]))
    assert route is not None
    rig = pose_of(50.0, 1.0, 0.0)  # 1 m to the right of the route
    sent = observations.route_ahead("s", 0, route, 50.0, rig).route.waypoints
    assert [point.x for point in sent] == pytest.approx([4.0 * number for number in range(20)])
    assert {round(point.y, 6) for point in sent} == {1.0}
    at_the_end = observations.route_ahead("s", 0, route, 190.0, rig).route.waypoints
    assert [point.x for point in at_the_end] == pytest.approx([140.0, 144.0, 148.0, 149.0])


def test_an_actor_comes_back_as_it_was() -> None:
    found = other_of(observations.actor_message(CAR))
    assert found.kind is CAR.kind
    assert found._replace(kind=0) == pytest.approx(CAR._replace(kind=0), rel=1e-5, abs=1e-5)


def test_the_next_light_on_the_route_is_named() -> None:
    data = carlas_data(100.0, (light(90.0, "7"), "Green"), (light(130.0, "8"), "Red"))
    assert data.ego_traffic_light == TrafficLightState.TRAFFIC_LIGHT_STATE_RED
    assert data.ego_traffic_light_distance_m == pytest.approx(30.0)
    assert [each.opendrive_id for each in data.traffic_lights] == ["7", "8"]
    assert data.traffic_lights[1].stop_points[0].position_local.y == pytest.approx(-2.0)
    assert data.speed_limit_mps == 0.0  # not posted


def test_a_light_far_ahead_is_not_the_next_one() -> None:
    data = carlas_data(10.0, (light(130.0, "8"), "Red"))
    assert data.ego_traffic_light == TrafficLightState.TRAFFIC_LIGHT_STATE_NONE
    assert data.ego_traffic_light_distance_m == -1.0


def test_points_of_a_lidar_lie_in_the_rig() -> None:
    (spec,) = parse_sensors([LIDAR], "the test")
    measured = np.array([[10.0, 2.0, -1.0, 0.5]], np.float32)  # 10 m ahead, where ahead is to the right
    sent = observations.sweep(spec, 100_000, measured, AXLE_M)
    assert unpack_lidar_points(sent)[0] == pytest.approx([AXLE_M - 2.0, -10.0, 1.0, 0.5], abs=1e-5)
