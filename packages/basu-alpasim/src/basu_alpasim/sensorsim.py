"""AlpaSim's protocol ``sensorsim``: BASU's runs as scenes, and a simulator of CARLA's protocol as the renderer.

Ten calls. Nine are served as far as their shapes fit; ``render_lidar`` is refused, because its request names a device
and no pattern of rays. What cannot be drawn is refused by a sentence with the status INVALID_ARGUMENT, NOT_FOUND or
UNIMPLEMENTED.
"""

from __future__ import annotations

import io
import threading
from concurrent import futures
from contextlib import contextmanager
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, NamedTuple

import grpc
import numpy as np
from carla_driver_interface._proto import common_pb2
from carla_driver_interface._proto import sensorsim_pb2 as messages
from carla_driver_interface.geometry import Pose, Trajectory
from carla_driver_interface.protocol import ALPASIM_API_VERSION, ALPASIM_REV, Empty, VersionId, channel_options
from PIL import Image

from basu.errors import SimulatorError
from basu_alpasim.faces import Faces, faces_of
from basu_alpasim.lens import LensError, directions, ideal_fov_deg
from basu_alpasim.observations import available_camera
from basu_alpasim.renderer import UnknownTrackError, View

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from basu_alpasim.renderer import SceneRenderer
    from basu_alpasim.run_scene import RunScene

SERVICE = messages.DESCRIPTOR.services_by_name["SensorsimService"]
FORMATS = {messages.PNG: "PNG", messages.JPEG: "JPEG"}
STILL_M, STILL = 1e-4, 1e-5
"""How far start and end of a picture may be apart: m, and components of the quaternion."""
LARGEST_PX = 4096
"""The longest edge of a picture."""
WORKERS = 4


class RefusedError(Exception):
    """A request cannot be served; the error carries a status of gRPC and a sentence."""

    def __init__(self, status: grpc.StatusCode, sentence: str) -> None:
        """Make the error of a call that ends with a status of gRPC and a sentence."""
        super().__init__(sentence)
        self.status = status


class _Wanted(NamedTuple):
    """A request that has been read."""

    scene: RunScene
    view: View
    objects: Mapping[str, Pose]
    moment: tuple[str, frozenset[bytes]]  # equal for requests that can be served in one step
    format: str
    quality: int


class SensorsimService:
    """The calls of the protocol; pictures are taken one after the other."""

    def __init__(self, scenes: Sequence[RunScene], renderer: SceneRenderer, rear_axle_m: float) -> None:
        """Serve these scenes; the rig lies ``rear_axle_m`` behind the vehicle's origin."""
        self._scenes = {scene.id: scene for scene in scenes}
        self._renderer, self._rear_axle_m = renderer, rear_axle_m
        self._lock = threading.Lock()
        self._lenses: dict[bytes, Faces] = {}

    def get_version(self, _request: Empty) -> VersionId:
        """Return the version of the distribution, and the version of AlpaSim's protocol that its messages have."""
        answer = VersionId(version_id=f"basu-alpasim {version('basu-alpasim')}", git_hash=ALPASIM_REV)
        answer.grpc_api_version.CopyFrom(ALPASIM_API_VERSION)
        return answer

    def get_available_scenes(self, _request: Empty) -> common_pb2.AvailableScenesReturn:
        """Return the ids of the scenes."""
        return common_pb2.AvailableScenesReturn(scene_ids=list(self._scenes))

    def get_loaded_scenes(self, _request: Empty) -> messages.LoadedScenesReturn:
        """Return the scene that is on the simulator; there is room for one."""
        shown = self._renderer.shown
        entry = [] if shown is None else [messages.LoadedSceneEntry(scene_id=shown, loaded_instance_count=1)]
        return messages.LoadedScenesReturn(scenes=entry, loaded_instance_capacity=1)

    def get_available_cameras(self, request: messages.AvailableCamerasRequest) -> messages.AvailableCamerasReturn:
        """Return the cameras of a scene: ideal pinholes, with the optical frame in the rig as their pose."""
        cameras = [available_camera(spec, self._rear_axle_m) for spec in self._scene(request.scene_id).cameras]
        return messages.AvailableCamerasReturn(available_cameras=cameras)

    def get_available_trajectories(
        self, request: messages.AvailableTrajectoriesRequest
    ) -> messages.AvailableTrajectoriesReturn:
        """Return the driven trajectory of the rig."""
        driven: Trajectory = self._scene(request.scene_id).trajectory
        return messages.AvailableTrajectoriesReturn(available_trajectories=[{"trajectory": driven.to_proto()}])

    def get_available_ego_masks(self, _request: Empty) -> messages.AvailableEgoMasksReturn:
        """Return no mask: the vehicle itself is not in the pictures."""
        return messages.AvailableEgoMasksReturn()

    def render_rgb(self, request: messages.RGBRenderRequest) -> messages.RGBRenderReturn:
        """Return one picture."""
        return self._drawn([request])[0]

    def batch_render_rgb(self, request: messages.BatchRGBRenderRequest) -> messages.BatchRGBRenderReturn:
        """Return a picture for each camera; one that cannot be drawn carries its sentence and fails alone."""
        answer = messages.BatchRGBRenderReturn()
        try:
            drawn = self._drawn([item.request for item in request.items])
        except RefusedError:
            drawn = None
        for number, item in enumerate(request.items):
            result = self._alone(item.request) if drawn is None else drawn[number]
            if isinstance(result, RefusedError):
                answer.items.add(camera_name=item.camera_name, success=False, error_message=str(result))
            else:
                answer.items.add(camera_name=item.camera_name, result=result, success=True)
        return answer

    def _alone(self, request: messages.RGBRenderRequest) -> messages.RGBRenderReturn | RefusedError:
        """Return one picture, or why there is none."""
        try:
            return self._drawn([request])[0]
        except RefusedError as refused:
            return refused

    def render_lidar(self, _request: messages.LidarRenderRequest) -> messages.LidarRenderReturn:
        """Refuse: CARLA's lidar has a pattern of its own."""
        raise RefusedError(
            grpc.StatusCode.UNIMPLEMENTED,
            "render_lidar: the request names a device (PANDAR128 or AT128), and CARLA's lidar does not have its "
            "pattern of rays; ask for cameras",
        )

    def render_aggregated(self, request: messages.AggregatedRenderRequest) -> messages.AggregatedRenderReturn:
        """Return several pictures; a lidar among them is refused. There are no data for the driver."""
        if request.lidar_requests:
            self.render_lidar(request.lidar_requests[0])
        return messages.AggregatedRenderReturn(rgb_returns=self._drawn(request.rgb_requests))

    def _drawn(self, requests: Sequence[messages.RGBRenderRequest]) -> list[messages.RGBRenderReturn]:
        """Return the pictures of requests; those of the same moment are taken in one step of the simulation.

        Raises:
            RefusedError: one of them cannot be drawn.
        """
        wanted = [self._read(request) for request in requests]
        pictures: list[NDArray[np.uint8]] = []
        try:
            with self._lock:
                is_one = len({each.moment for each in wanted}) == 1
                for group in [wanted] if is_one else [[each] for each in wanted]:
                    views = [each.view for each in group]
                    pictures += self._renderer.pictures(group[0].scene, views, group[0].objects)
        except UnknownTrackError as error:
            raise RefusedError(grpc.StatusCode.NOT_FOUND, str(error)) from None
        except SimulatorError as error:
            raise RefusedError(grpc.StatusCode.UNAVAILABLE, str(error)) from None
        return [
            messages.RGBRenderReturn(image_bytes=_encoded(picture, each))
            for picture, each in zip(pictures, wanted, strict=True)
        ]

    def _scene(self, scene_id: str) -> RunScene:
        """Return a scene by its id.

        Raises:
            RefusedError: there is none.
        """
        if scene_id not in self._scenes:
            raise RefusedError(
                grpc.StatusCode.NOT_FOUND, f"there is no scene '{scene_id}'; the scenes: {', '.join(self._scenes)}"
            )
        return self._scenes[scene_id]

    def _read(self, request: messages.RGBRenderRequest) -> _Wanted:
        """Read a request for a picture.

        Raises:
            RefusedError: it cannot be drawn.
        """
        scene, spec = self._scene(request.scene_id), request.camera_intrinsics
        camera = f"camera '{spec.logical_id}'"
        if request.image_format not in FORMATS:
            known = dict(zip(messages.ImageFormat.values(), messages.ImageFormat.keys(), strict=True))
            name = known.get(request.image_format, request.image_format)
            raise _invalid(f"{camera}: the image_format {name} is not supported; set PNG or JPEG")
        if spec.shutter_type not in (messages.GLOBAL, messages.UNKNOWN):
            raise _invalid(
                f"{camera}: the shutter_type {messages.ShutterType.Name(spec.shutter_type)} needs a time for each row; "
                "a picture here has one time, so set GLOBAL"
            )
        if request.insert_ego_mask:
            raise _invalid(f"{camera}: insert_ego_mask is set, and there are no ego masks; unset it")
        width, height = request.resolution_w, request.resolution_h
        if not (0 < width <= LARGEST_PX and 0 < height <= LARGEST_PX):
            raise _invalid(
                f"{camera}: the resolution is {width} x {height}; each edge must be 1 to {LARGEST_PX} pixels"
            )
        view = View(_still(request.sensor_pose, camera), width, height, self._lens(spec, width, height, camera))
        objects = {
            each.track_id: _still(each.pose_pair, f"track '{each.track_id}'") for each in request.dynamic_objects
        }
        quality = round(request.image_quality) if request.image_quality > 0.0 else 95
        moment = (scene.id, frozenset(each.SerializeToString(deterministic=True) for each in request.dynamic_objects))
        return _Wanted(scene, view, objects, moment, FORMATS[request.image_format], min(100, quality))

    def _lens(self, spec: messages.CameraSpec, width: int, height: int, camera: str) -> float | Faces:
        """Return the field of view of an ideal camera, or the faces through which another lens looks."""
        try:
            fov_deg = ideal_fov_deg(spec, width, height)
            if fov_deg is not None:
                return fov_deg
            key = spec.SerializeToString(deterministic=True) + f"{width} {height}".encode()
            if key not in self._lenses:
                self._lenses[key] = faces_of(directions(spec, width, height))
            return self._lenses[key]
        except LensError as error:
            raise _invalid(f"{camera}: {error}") from None


def _invalid(sentence: str) -> RefusedError:
    """Return the refusal of a request with values that cannot be used."""
    return RefusedError(grpc.StatusCode.INVALID_ARGUMENT, sentence)


def _still(pair: messages.PosePair, what: str) -> Pose:
    """Return the pose of something that stands still while a picture is taken.

    Raises:
        RefusedError: it moves, or a pose is none.
    """
    start, end = Pose.from_proto(pair.start_pose), Pose.from_proto(pair.end_pose)
    apart_m = float(np.max(np.abs(end.position - start.position)))
    turned = float((start.rotation.inv() * end.rotation).magnitude())
    if not np.isfinite([*start.position, *end.position, turned]).all():
        raise _invalid(f"{what}: its pose is no finite number")
    if apart_m > STILL_M or turned > STILL:
        raise _invalid(
            f"{what}: it moves by {apart_m:.4g} m and {turned:.4g} rad from start_pose to end_pose; a picture here has "
            "one time, so set both to the same pose (a shutter_duration_us of 0 in AlpaSim's cameras)"
        )
    return end


def _encoded(picture: NDArray[np.uint8], wanted: _Wanted) -> bytes:
    """Return a picture in the wanted format."""
    written = io.BytesIO()
    options = {"quality": wanted.quality} if wanted.format == "JPEG" else {}
    Image.fromarray(picture).save(written, format=wanted.format, **options)
    return written.getvalue()


def message_class(described: Any) -> Any:  # noqa: ANN401 - a descriptor in, a class of messages out
    """Return the class of a message of the protocol, or of its common part."""
    return getattr(messages, described.name, None) or getattr(common_pb2, described.name)


def _handler(service: SensorsimService, call: str) -> grpc.RpcMethodHandler:
    """Return the handler of a call, which turns refusals into gRPC's statuses."""
    method: Callable[[Any], Any] = getattr(service, call)
    described = SERVICE.methods_by_name[call]

    def answer(request: Any, context: grpc.ServicerContext) -> Any:  # noqa: ANN401 - messages
        try:
            return method(request)
        except RefusedError as refused:
            context.abort(refused.status, str(refused))

    return grpc.unary_unary_rpc_method_handler(
        answer,
        request_deserializer=message_class(described.input_type).FromString,
        response_serializer=lambda message: message.SerializeToString(),
    )


@contextmanager
def serving_scenes(service: SensorsimService, host: str, port: int) -> Iterator[int]:
    """Serve at an address for the duration of the block, and yield the port.

    Raises:
        RuntimeError: the address is taken.
    """
    server = grpc.server(futures.ThreadPoolExecutor(max_workers=WORKERS), options=channel_options())
    handlers = {call.name: _handler(service, call.name) for call in SERVICE.methods}
    server.add_generic_rpc_handlers((grpc.method_handlers_generic_handler(SERVICE.full_name, handlers),))
    bound = server.add_insecure_port(f"{host}:{port}")
    if bound == 0:
        raise RuntimeError("the address is taken")
    server.start()
    try:
        yield bound
    finally:
        server.stop(grace=None).wait()
