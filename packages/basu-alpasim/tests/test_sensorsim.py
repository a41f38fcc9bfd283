"""A run's folder as a scene of AlpaSim's ``sensorsim``, over real gRPC: pictures of the simulator, and refusals."""

import contextlib
import io
import itertools
import queue
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import carla
import grpc
import numpy as np
import pytest
from carla_driver_interface._proto import common_pb2
from carla_driver_interface._proto import sensorsim_pb2 as messages
from carla_driver_interface.geometry import Pose, Trajectory, optical_to_body
from carla_driver_interface.protocol import channel_options
from PIL import Image

from basu.agents.sensor_file import parse_sensors
from basu.cli import main
from basu.conditions import SimulatorSpec
from basu.simulator import simulator_for
from basu_alpasim.frames import pose_of, transform_of
from basu_alpasim.renderer import SceneRenderer
from basu_alpasim.run_scene import RunScene, scene_of
from basu_alpasim.sensorsim import SERVICE, SensorsimService, message_class, serving_scenes
from basu_fixtures import SHORT_ROUTE
from ros_runs import run
from servers import RunningServer

AXLE_M = 1.4
CAMERA = {"type": "sensor.camera.rgb", "id": "front", "x": 1.0, "z": 1.6, "width": 96, "height": 64, "fov": 90}
CAR, TRACK = "vehicle.tesla.model3", "7"
Calls = Callable[[str, Any], Any]


@pytest.fixture(scope="module")
def scene(simulator: RunningServer, tmp_path_factory: pytest.TempPathFactory) -> RunScene:
    """The scene of a second of driving, with one more actor in its list."""
    output = tmp_path_factory.mktemp("runs")
    _, _, folder = run("basic", simulator, SHORT_ROUTE, output, "--stop-after", "1")
    made = scene_of(folder.resolve(), parse_sensors([CAMERA], "the test"), AXLE_M)
    return made._replace(id="drive", actors={TRACK: CAR, "8": "vehicle.of.nobody"})


@pytest.fixture(scope="module")
def call(simulator: RunningServer, scene: RunScene) -> Iterator[Calls]:
    """Calls of the protocol by name."""
    spec = SimulatorSpec(host="127.0.0.1", port=simulator.port, timeout_s=300.0, is_open=True)
    with simulator_for(spec) as found, contextlib.closing(SceneRenderer(found)) as renderer:
        service = SensorsimService([scene], renderer, AXLE_M)
        with serving_scenes(service, "127.0.0.1", 0) as port:
            channel = grpc.insecure_channel(f"127.0.0.1:{port}", options=channel_options())

            def ask(name: str, request: Any) -> Any:
                answer = message_class(SERVICE.methods_by_name[name].output_type)
                path = f"/{SERVICE.full_name}/{name}"
                method = channel.unary_unary(path, type(request).SerializeToString, answer.FromString)
                return method(request, timeout=300.0)

            yield ask
            channel.close()


def request(scene: RunScene, **given: Any) -> messages.RGBRenderRequest:
    """Return a request for the front camera's picture at the end of the drive."""
    at = scene.trajectory.poses[-1] @ pose_of(1.0 + AXLE_M, 0.0, 1.6)
    [camera] = scene.cameras
    assert camera.id == "front"
    values = {
        "scene_id": "drive",
        "resolution_w": 96,
        "resolution_h": 64,
        "camera_intrinsics": ideal(),
        "sensor_pose": pair(optical(at)),
        "image_format": messages.PNG,
    }
    return messages.RGBRenderRequest(**{**values, **given})


def optical(body: Pose) -> Pose:
    """Return the optical frame of a camera that looks along x of its body."""
    return body @ optical_to_body(Pose.identity()).inverse()


def pair(pose: Pose, end: Pose | None = None) -> messages.PosePair:
    return messages.PosePair(start_pose=pose.to_proto(), end_pose=(end or pose).to_proto())


def ideal(**given: Any) -> messages.CameraSpec:
    """Return a pinhole of 96 x 64 pixels and 90 degrees."""
    lens = {"principal_point_x": 48.0, "principal_point_y": 32.0, "focal_length_x": 48.0, "focal_length_y": 48.0}
    values = {"opencv_pinhole_param": lens, "shutter_type": messages.GLOBAL}
    return messages.CameraSpec(**{"logical_id": "front", "resolution_w": 96, "resolution_h": 64, **values, **given})


def ahead(scene: RunScene) -> messages.DynamicObject:
    """Return the actor 9 m before the rig."""
    middle = scene.trajectory.poses[-1] @ Pose.from_xyz_yaw(12.0, 0.0, 0.75, 0.3)
    return messages.DynamicObject(track_id=TRACK, pose_pair=pair(middle))


def picture(answer: messages.RGBRenderReturn) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(answer.image_bytes)), dtype=int)


def refused(call: Calls, name: str, asked: Any) -> tuple[grpc.StatusCode, str]:
    """Return the status and the sentence of a refusal."""
    with pytest.raises(grpc.RpcError) as error:
        call(name, asked)
    return error.value.code(), error.value.details()


def test_a_scene_has_the_cameras_and_the_trajectory_of_its_run(call: Calls, scene: RunScene) -> None:
    assert call("get_version", common_pb2.Empty()).grpc_api_version.major == 0
    assert list(call("get_available_scenes", common_pb2.Empty()).scene_ids) == ["drive"]
    assert not call("get_available_ego_masks", common_pb2.Empty()).ego_mask_metadata
    [camera] = call("get_available_cameras", messages.AvailableCamerasRequest(scene_id="drive")).available_cameras
    assert camera.intrinsics.opencv_pinhole_param.focal_length_x == pytest.approx(48.0)
    body = optical_to_body(Pose.from_proto(camera.rig_to_camera))
    assert body.position.tolist() == pytest.approx([1.0 + AXLE_M, 0.0, 1.6])
    asked = messages.AvailableTrajectoriesRequest(scene_id="drive")
    [driven] = call("get_available_trajectories", asked).available_trajectories
    read = Trajectory.from_proto(driven.trajectory)
    assert read.timestamps_us == list(range(0, 1_000_001, 50_000))
    assert read.positions == pytest.approx(scene.trajectory.positions, abs=1e-4)


def test_a_picture_is_that_of_a_camera_at_its_pose(call: Calls, scene: RunScene, simulator: RunningServer) -> None:
    """The official client's own camera, put to the same place, sees the same."""
    asked = request(scene)
    drawn = picture(call("render_rgb", asked))
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(300.0)
    world = client.get_world()
    blueprint = world.get_blueprint_library().find("sensor.camera.rgb")
    for name, value in (("image_size_x", "96"), ("image_size_y", "64"), ("fov", "90")):
        blueprint.set_attribute(name, value)
    place = transform_of(optical_to_body(Pose.from_proto(asked.sensor_pose.end_pose)))
    camera = world.spawn_actor(blueprint, place)
    seen: queue.SimpleQueue[carla.Image] = queue.SimpleQueue()
    camera.listen(seen.put)
    again = picture(call("render_rgb", asked))  # one step of the simulation
    image = seen.get(timeout=300.0)
    camera.stop()
    camera.destroy()
    own = np.frombuffer(image.raw_data, np.uint8).reshape(64, 96, 4)[:, :, 2::-1].astype(int)
    assert np.abs(own - again).max() <= 1
    assert np.abs(drawn - again).max() <= 1
    assert drawn.std() > 10.0
    [loaded] = call("get_loaded_scenes", common_pb2.Empty()).scenes
    assert loaded.scene_id == "drive"


def test_an_actor_is_shown_where_the_request_has_it_and_only_then(call: Calls, scene: RunScene) -> None:
    empty = picture(call("render_rgb", request(scene)))
    shown = picture(call("render_rgb", request(scene, dynamic_objects=[ahead(scene)])))
    rows, columns = np.nonzero(np.abs(shown - empty).max(axis=-1) > 30)
    assert len(rows) > 60
    assert 30 <= columns.min() <= columns.max() <= 66
    assert np.abs(picture(call("render_rgb", request(scene))) - empty).max() <= 1


def test_lenses_of_three_kinds_see_what_the_pinhole_sees(call: Calls, scene: RunScene) -> None:
    """Each describes the pinhole itself, so the pictures differ by their sampling alone."""
    direct = picture(call("render_rgb", request(scene)))
    pinhole = {"principal_point_x": 48.0, "principal_point_y": 32.0, "focal_length_x": 48.0, "focal_length_y": 48.0}
    angles = np.linspace(0.0, 1.1, 200)
    forward = np.polynomial.polynomial.polyfit(angles, 48.0 * np.tan(angles), 12)
    ftheta = {"reference_poly": "ANGLE_TO_PIXELDIST", "angle_to_pixeldist_poly": forward, "max_angle": 1.1}
    odd = np.linalg.lstsq(
        np.stack([angles ** (2 * n + 3) for n in range(4)], axis=1), np.tan(angles) - angles, rcond=None
    )[0]
    fisheye = {**pinhole, "radial_coeffs": odd, "max_angle": 1.1}
    middle = {"principal_point_x": 48.0, "principal_point_y": 32.0}
    lenses = [
        {"opencv_pinhole_param": {**pinhole, "radial_coeffs": [1e-9]}},
        {"opencv_pinhole_param": None, "ftheta_param": {**middle, **ftheta}},
        {"opencv_pinhole_param": None, "opencv_fisheye_param": fisheye},
    ]
    for lens in lenses:
        drawn = picture(call("render_rgb", request(scene, camera_intrinsics=ideal(**lens))))
        assert np.median(np.abs(drawn - direct)) <= 3.0, lens
        assert np.corrcoef(drawn.ravel(), direct.ravel())[0, 1] > 0.97, lens


def test_a_batch_has_a_picture_of_each_camera_and_one_that_fails_fails_alone(call: Calls, scene: RunScene) -> None:
    wide = request(scene, resolution_w=48, resolution_h=32)
    rolling = request(scene, camera_intrinsics=ideal(shutter_type=messages.ROLLING_TOP_TO_BOTTOM))
    items = [{"camera_name": "a", "request": wide}, {"camera_name": "b", "request": rolling}]
    a, b = call("batch_render_rgb", messages.BatchRGBRenderRequest(items=items)).items
    assert (a.camera_name, a.success, picture(a.result).shape) == ("a", True, (32, 48, 3))
    assert (b.camera_name, b.success) == ("b", False)
    assert "set GLOBAL" in b.error_message
    both = messages.AggregatedRenderRequest(rgb_requests=[wide, request(scene, dynamic_objects=[ahead(scene)])])
    shapes = [picture(each).shape for each in call("render_aggregated", both).rgb_returns]
    assert shapes == [(32, 48, 3), (64, 96, 3)]
    jpeg = call("render_rgb", request(scene, image_format=messages.JPEG, image_quality=50.0)).image_bytes
    assert jpeg[:2] == b"\xff\xd8"


MOVED = Pose.from_xyz_yaw(0.0, 0.0, 2.0, 0.0)
REFUSALS = {
    "no such scene": ({"scene_id": "mars"}, "NOT_FOUND", "there is no scene 'mars'; the scenes: drive"),
    "video": ({"image_format": messages.AVC}, "INVALID_ARGUMENT", "the image_format AVC is not supported"),
    "unknown format": ({"image_format": 77}, "INVALID_ARGUMENT", "the image_format 77 is not supported"),
    "a rolling shutter": (
        {"camera_intrinsics": ideal(shutter_type=messages.ROLLING_LEFT_TO_RIGHT)}, "INVALID_ARGUMENT",
        "camera 'front': the shutter_type ROLLING_LEFT_TO_RIGHT needs a time for each row",
    ),
    "a mask": ({"insert_ego_mask": True}, "INVALID_ARGUMENT", "there are no ego masks"),
    "no size": ({"resolution_w": 0}, "INVALID_ARGUMENT", "the resolution is 0 x 64"),
    "a huge picture": ({"resolution_h": 100_000}, "INVALID_ARGUMENT", "the resolution is 96 x 100000"),
    "a moving camera": (
        {"sensor_pose": pair(MOVED, Pose.from_xyz_yaw(0.5, 0.0, 2.0, 0.0))}, "INVALID_ARGUMENT",
        "it moves by 0.5 m and 0 rad from start_pose to end_pose",
    ),
    "no number": (
        {"sensor_pose": pair(Pose.from_xyz_yaw(float("nan"), 0.0, 0.0, 0.0))}, "INVALID_ARGUMENT",
        "camera 'front': its pose is no finite number",
    ),
    "no lens": ({"camera_intrinsics": ideal(opencv_pinhole_param=None)}, "INVALID_ARGUMENT", "has no parameters"),
    "an unknown actor": (
        {"dynamic_objects": [messages.DynamicObject(track_id="99", pose_pair=pair(MOVED))]}, "NOT_FOUND",
        "scene 'drive' has no track '99'; its tracks: 7, 8",
    ),
    "an actor of an unknown kind": (
        {"dynamic_objects": [messages.DynamicObject(track_id="8", pose_pair=pair(MOVED))]}, "NOT_FOUND",
        "track '8' is a vehicle.of.nobody, which cannot be shown",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_what_cannot_be_drawn_is_refused_by_a_sentence(call: Calls, scene: RunScene, name: str) -> None:
    changed, status, sentence = REFUSALS[name]
    code, told = refused(call, "render_rgb", request(scene, **changed))
    assert (code.name, sentence in told) == (status, True), told


def test_a_lidar_is_refused(call: Calls, scene: RunScene) -> None:
    with_lidar = messages.AggregatedRenderRequest(lidar_requests=[messages.LidarRenderRequest(scene_id="drive")])
    for name, asked in (("render_lidar", messages.LidarRenderRequest()), ("render_aggregated", with_lidar)):
        code, told = refused(call, name, asked)
        assert code is grpc.StatusCode.UNIMPLEMENTED
        assert told.startswith("render_lidar: the request names a device (PANDAR128 or AT128)")
    assert scene.id == "drive"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["{}"], "is no run folder that can be scored"),
    ],
)
def test_the_command_names_what_it_cannot_use(
    words: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = main(["serve", "sensorsim", *(word.format(tmp_path) for word in words)])
    assert code == 2
    assert sentence in capsys.readouterr().err


def test_poses_come_back_from_carla_s_axes() -> None:
    for roll, pitch, yaw in itertools.product((-2.0, 0.0, 1.0), (-1.5, 0.0, 0.7), (-3.0, 0.0, 2.0)):
        turned = transform_of(pose_of(1.0, 2.0, 3.0, roll, pitch, yaw))
        back = carla.Rotation(*(float(np.degrees(each)) for each in (pitch, yaw, roll)))
        assert (turned.location.x, turned.location.y, turned.location.z) == pytest.approx((1.0, 2.0, 3.0))
        assert np.asarray(turned.get_matrix())[:3, :3] == pytest.approx(
            np.asarray(carla.Transform(carla.Location(), back).get_matrix())[:3, :3], abs=1e-5
        )
    upright = transform_of(pose_of(0.0, 0.0, 0.0, 0.0, float(np.pi / 2.0), 0.5))
    assert upright.rotation.pitch == pytest.approx(90.0, abs=0.01)
