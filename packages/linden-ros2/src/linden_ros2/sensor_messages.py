"""Messages of sensors, as the ros-bridge or CARLA's own publisher has them: images, clouds, GNSS, IMU, contacts, lanes.

Layouts are those of the official ros-bridge (carla_ros_bridge, master of July 2022), so that its users find the same
fields. A measurement is a ``carla.SensorData`` or anything with the same fields.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from linden_ros2 import frames
from linden_ros2.basic_messages import quaternion, vector3
from linden_ros2.types import Generation

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from linden_ros2.mount import Mount
    from linden_ros2.types import Types

EVENT_CAMERA = "sensor.camera.dvs"
CLOUD = "sensor_msgs/msg/PointCloud2"
Part = tuple[str, Any]  # behind the sensor's topic, and a message

INT8, UINT16, UINT32, FLOAT32, FLOAT64 = 1, 4, 6, 7, 8  # sensor_msgs/PointField
LIDAR_POINT = (("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32), ("intensity", 12, FLOAT32))
SEMANTIC_POINT = (
    *LIDAR_POINT[:3], ("CosAngle", 12, FLOAT32), ("ObjIdx", 16, UINT32), ("ObjTag", 20, UINT32),
)  # fmt: skip
RADAR_POINT = (
    *LIDAR_POINT[:3], ("Range", 12, FLOAT32), ("Velocity", 16, FLOAT32), ("AzimuthAngle", 20, FLOAT32),
    ("ElevationAngle", 28, FLOAT32),
)  # fmt: skip
RADAR_VALUES = {"Range": "depth", "Velocity": "velocity", "AzimuthAngle": "azimuth", "ElevationAngle": "altitude"}
"""CARLA's names of what the ros-bridge's fields hold (RadarData.h)."""
RADAR_ROW = ("velocity", "azimuth", "altitude", "depth")  # on the wire
EVENT_ROW = np.dtype([("x", "<u2"), ("y", "<u2"), ("t", "<i8"), ("polarity", "?")])  # DVSEvent.h, packed
EVENT_POINT = (("x", 0, UINT16), ("y", 2, UINT16), ("t", 4, FLOAT64), ("pol", 12, INT8))
EVENT_OUT = np.dtype([("x", "<u2"), ("y", "<u2"), ("t", "<f8"), ("pol", "i1")])
SEMANTIC_ROW = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("cos", "<f4"), ("index", "<u4"), ("tag", "<u4")])
CONVERTED_ROWS = 16
"""Rows of a depth picture at a time: what is computed in between stays in the processor's cache."""
FARTHEST_M = 1000.0  # of CARLA's depth camera: 24 bits over 1 km, CARLA's documentation of sensor.camera.depth
CITYSCAPES = np.array(
    [
        (0, 0, 0), (128, 64, 128), (244, 35, 232), (70, 70, 70), (102, 102, 156), (190, 153, 153), (153, 153, 153),
        (250, 170, 30), (220, 220, 0), (107, 142, 35), (152, 251, 152), (70, 130, 180), (220, 20, 60), (255, 0, 0),
        (0, 0, 142), (0, 0, 70), (0, 60, 100), (0, 80, 100), (0, 0, 230), (119, 11, 32), (110, 190, 160),
        (170, 120, 50), (55, 90, 80), (45, 60, 150), (157, 234, 50), (81, 0, 81), (150, 100, 100), (230, 150, 140),
        (180, 165, 180),
    ],
    dtype=np.uint8,
)  # fmt: skip
"""Red, green, blue of each semantic tag: CARLA's documentation of the semantic segmentation camera, 0.9.16."""


class Convention(NamedTuple):
    """What differs between the ros-bridge's topics and those of CARLA's own publisher."""

    pictures: Mapping[str, tuple[str, Callable[[NDArray[np.uint8]], NDArray[Any]]]]
    """The encoding of each kind of camera, and how its raw picture is made that."""
    semantic: tuple[tuple[str, int, int], ...] = SEMANTIC_POINT
    radar: tuple[tuple[str, int, int], ...] = RADAR_POINT
    radar_step: int = 32  # the ros-bridge leaves bytes 24 to 27 empty
    has_events: bool = False
    """Whether event cameras are published."""


def sensor_messages(
    types: Types,
    header: Any,  # noqa: ANN401 - a message
    mount: Mount,
    data: Any,  # noqa: ANN401 - see above
    convention: Convention | None = None,
) -> list[Part]:
    """Return the messages of one measurement, each with what follows its sensor's topic; none for an unknown sensor.

    The convention is by default that of the ros-bridge.
    """
    way = convention or BRIDGE
    if mount.type_id in way.pictures:
        return _pictures(types, header, data, *way.pictures[mount.type_id])
    if mount.type_id == EVENT_CAMERA:
        return _events(types, header, data) if way.has_events else []
    make = _SENSORS.get(mount.type_id)
    return [] if make is None else [("", make(types, header, data, way))]


def sensor_types(type_id: str, convention: Convention | None = None) -> list[tuple[str, str]]:
    """Return the topics of a sensor type, each as the end of its name and its message type."""
    way = convention or BRIDGE
    picture = [("/image", "sensor_msgs/msg/Image"), ("/camera_info", "sensor_msgs/msg/CameraInfo")]
    if type_id in way.pictures:
        return picture
    if type_id == EVENT_CAMERA:
        return [*picture, ("/point_cloud", CLOUD)] if way.has_events else []
    return [("", _TYPES[type_id])] if type_id in _TYPES else []


def camera_info(types: Types, header: Any, width: int, height: int, fov_deg: float) -> Any:  # noqa: ANN401 - a message
    """Return the matrix of a camera without distortion; the field of view is horizontal."""
    focal, middle_x, middle_y = frames.focal_length_px(width, fov_deg), width / 2.0, height / 2.0
    matrices = {
        "d": np.zeros(5),
        "k": np.array([focal, 0.0, middle_x, 0.0, focal, middle_y, 0.0, 0.0, 1.0]),
        "r": np.eye(3).ravel(),
        "p": np.array([focal, 0.0, middle_x, 0.0, 0.0, focal, middle_y, 0.0, 0.0, 0.0, 1.0, 0.0]),
    }
    if types.generation is Generation.ROS_1:
        matrices = {name.upper(): matrix for name, matrix in matrices.items()}
    return types.message(
        "sensor_msgs/msg/CameraInfo",
        header=header,
        width=width,
        height=height,
        distortion_model="plumb_bob",
        **matrices,
    )


def cloud(
    types: Types,
    header: Any,  # noqa: ANN401 - a message
    layout: tuple[tuple[str, int, int], ...],
    rows: NDArray[Any],
    *,
    step: int,
) -> Any:  # noqa: ANN401 - a message
    """Return a point cloud of rows that already have ROS's axes; ``layout`` gives name, byte and kind of each field."""
    fields = [
        types.message("sensor_msgs/msg/PointField", name=name, offset=offset, datatype=kind, count=1)
        for name, offset, kind in layout
    ]
    return types.message(
        CLOUD,
        header=header,
        height=1,
        width=len(rows),
        fields=fields,
        point_step=step,
        row_step=step * len(rows),
        data=rows.reshape(-1).view(np.uint8),
    )


def _pictures(
    types: Types,
    header: Any,  # noqa: ANN401 - as above
    data: Any,  # noqa: ANN401 - as above
    encoding: str,
    convert: Callable[[NDArray[np.uint8]], NDArray[Any]],
) -> list[Part]:
    """An image and its camera's matrix."""
    raw = np.frombuffer(data.raw_data, np.uint8).reshape(data.height, data.width, -1)
    return _image(types, header, data, encoding, np.ascontiguousarray(convert(raw)))


def _image(types: Types, header: Any, data: Any, encoding: str, pixels: NDArray[Any]) -> list[Part]:  # noqa: ANN401
    """A picture of (H, W, …) pixels and its camera's matrix."""
    image = types.message(
        "sensor_msgs/msg/Image",
        header=header,
        height=data.height,
        width=data.width,
        encoding=encoding,
        step=pixels.nbytes // data.height,
        data=pixels.reshape(-1).view(np.uint8),
    )
    return [("/image", image), ("/camera_info", camera_info(types, header, data.width, data.height, data.fov))]


def _events(types: Types, header: Any, data: Any) -> list[Part]:  # noqa: ANN401 - as above
    """Events of a frame as points, t in s, and as a picture: brighter is red, darker blue."""
    events = np.frombuffer(data.raw_data, EVENT_ROW)
    picture = np.zeros((data.height, data.width, 3), np.uint8)
    picture[events["y"], events["x"], np.where(events["polarity"], 2, 0)] = 255
    rows = np.empty(len(events), EVENT_OUT)
    rows["x"], rows["y"], rows["t"], rows["pol"] = events["x"], events["y"], events["t"] * 1e-9, events["polarity"]
    points = cloud(types, header, EVENT_POINT, rows, step=EVENT_OUT.itemsize)
    return [*_image(types, header, data, "bgr8", picture), ("/point_cloud", points)]


def _depth_m(bgra: NDArray[np.uint8]) -> NDArray[np.float32]:
    """(H, W) depth in m of a raw picture: red is the lowest byte of 24."""
    depth = np.empty(bgra.shape[:2], dtype=np.float32)
    for first in range(0, len(bgra), CONVERTED_ROWS):
        packed = bgra[first : first + CONVERTED_ROWS].view("<u4")[..., 0]
        value = (packed >> 16 & 0xFF) | (packed & 0xFF00) | (packed & 0xFF) << 16
        depth[first : first + CONVERTED_ROWS] = value.astype(np.float32) * np.float32(FARTHEST_M / (256**3 - 1))
    return depth


def _coloured(bgra: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """(H, W) packed pixels in the colours of Cityscapes; the raw picture's tag is in red, an unknown tag is black."""
    table = np.zeros((256, 4), dtype=np.uint8)
    table[: len(CITYSCAPES), :3] = CITYSCAPES[:, ::-1]
    table[:, 3] = 255
    packed: NDArray[np.uint32] = np.take(table.view("<u4")[:, 0], bgra[..., 2])
    return packed


def _as_is(bgra: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return bgra


def _lidar(types: Types, header: Any, data: Any, _way: Convention) -> Any:  # noqa: ANN401 - as above
    rows = np.frombuffer(data.raw_data, np.float32).reshape(-1, 4)
    return cloud(types, header, LIDAR_POINT, frames.points(rows), step=16)


def _semantic_lidar(types: Types, header: Any, data: Any, way: Convention) -> Any:  # noqa: ANN401 - as above
    rows = np.frombuffer(data.raw_data, SEMANTIC_ROW)
    return cloud(types, header, way.semantic, frames.points(rows), step=SEMANTIC_ROW.itemsize)


def _radar(types: Types, header: Any, data: Any, way: Convention) -> Any:  # noqa: ANN401 - as above
    """A radar's detections as points."""
    raw = np.frombuffer(data.raw_data, np.float32).reshape(-1, 4)
    values = dict(zip(RADAR_ROW, raw.T, strict=True))
    azimuth, altitude, depth = values["azimuth"], values["altitude"], values["depth"]
    rows = np.zeros((len(raw), way.radar_step // 4), dtype=np.float32)
    rows[:, 0] = depth * np.cos(azimuth) * np.cos(altitude)
    rows[:, 1] = -depth * np.sin(azimuth) * np.cos(altitude)
    rows[:, 2] = depth * np.sin(altitude)
    for name, offset, _ in way.radar[3:]:
        rows[:, offset // 4] = values[RADAR_VALUES.get(name, name)]
    return cloud(types, header, way.radar, rows, step=way.radar_step)


def _gnss(types: Types, header: Any, data: Any, _way: Convention) -> Any:  # noqa: ANN401 - as above
    place = {name: getattr(data, name) for name in ("latitude", "longitude", "altitude")}
    return types.message("sensor_msgs/msg/NavSatFix", header=header, **place)


def _imu(types: Types, header: Any, data: Any, _way: Convention) -> Any:  # noqa: ANN401 - as above
    """An IMU: rates and acceleration of its own frame, attitude of its frame in the world."""
    turn = data.transform.rotation
    angles = np.radians((turn.roll, turn.pitch, turn.yaw)).tolist()
    spin, force = data.gyroscope, data.accelerometer
    return types.message(
        "sensor_msgs/msg/Imu",
        header=header,
        orientation=quaternion(types, frames.attitude(*angles)),
        angular_velocity=vector3(types, frames.axial(spin.x, spin.y, spin.z)),
        linear_acceleration=vector3(types, frames.vector(force.x, force.y, force.z)),
    )


def _collision(types: Types, header: Any, data: Any, _way: Convention) -> Any:  # noqa: ANN401 - as above
    push, other = data.normal_impulse, data.other_actor
    return collision_message(types, header, 0 if other is None else other.id, (push.x, push.y, push.z))


def collision_message(types: Types, header: Any, other_id: int, impulse_ns: frames.Vector) -> Any:  # noqa: ANN401
    """Return a contact; the impulse in CARLA's axes becomes one in ROS's. The ros-bridge leaves CARLA's there."""
    impulse = vector3(types, frames.vector(*impulse_ns))
    kind = "carla_msgs/msg/CarlaCollisionEvent"
    return types.message(kind, header=header, other_actor_id=other_id, normal_impulse=impulse)


def _lane_invasion(types: Types, header: Any, data: Any, _way: Convention) -> Any:  # noqa: ANN401 - as above
    return lane_invasion_message(types, header, [int(marking.type) for marking in data.crossed_lane_markings])


def lane_invasion_message(types: Types, header: Any, kinds: list[int]) -> Any:  # noqa: ANN401 - a message
    """Return crossed markings, each a value of carla.LaneMarkingType."""
    crossed = np.array(kinds, dtype=np.int32)
    return types.message("carla_msgs/msg/CarlaLaneInvasionEvent", header=header, crossed_lane_markings=crossed)


MARKINGS = {
    "Other": 0, "Broken": 1, "Solid": 2, "SolidSolid": 3, "SolidBroken": 4, "BrokenSolid": 5, "BrokenBroken": 6,
    "BottsDots": 7, "Grass": 8, "Curb": 9, "NONE": 10,
}  # fmt: skip
"""The value of each carla.LaneMarkingType by its name: road/element/LaneMarking.h of LibCarla 0.9.16."""


BRIDGE = Convention(
    {
        "sensor.camera.rgb": ("bgra8", _as_is),
        "sensor.camera.depth": ("32FC1", _depth_m),
        "sensor.camera.semantic_segmentation": ("bgra8", _coloured),
        "sensor.camera.instance_segmentation": ("bgra8", _as_is),
        "sensor.camera.normals": ("bgra8", _as_is),
    }
)
"""The encodings and fields of messages as CARLA's ros-bridge has them."""
NATIVE = Convention(
    {
        **dict.fromkeys(BRIDGE.pictures, ("bgra8", _as_is)),
        "sensor.camera.optical_flow": ("32FC2", _as_is),
    },
    semantic=(
        *LIDAR_POINT[:3], ("cos_inc_angle", 12, FLOAT32), ("object_idx", 16, UINT32), ("object_tag", 20, UINT32),
    ),
    radar=(
        *LIDAR_POINT[:3], ("velocity", 12, FLOAT32), ("azimuth", 16, FLOAT32), ("altitude", 20, FLOAT32),
        ("depth", 24, FLOAT32),
    ),
    radar_step=28,
    has_events=True,
)  # fmt: skip
"""That of CARLA's own publisher (LibCarla's ros2), with raw pictures. Its optical flow is a picture in colours; here it
has the flow's own two numbers. Its events have the bits of an integer of ns where the field says FLOAT64; here s."""
_SENSORS: dict[str, Callable[[Types, Any, Any, Convention], Any]] = {
    "sensor.lidar.ray_cast": _lidar,
    "sensor.lidar.ray_cast_semantic": _semantic_lidar,
    "sensor.other.radar": _radar,
    "sensor.other.gnss": _gnss,
    "sensor.other.imu": _imu,
    "sensor.other.collision": _collision,
    "sensor.other.lane_invasion": _lane_invasion,
}
_TYPES = {
    "sensor.lidar.ray_cast": CLOUD,
    "sensor.lidar.ray_cast_semantic": CLOUD,
    "sensor.other.radar": CLOUD,
    "sensor.other.gnss": "sensor_msgs/msg/NavSatFix",
    "sensor.other.imu": "sensor_msgs/msg/Imu",
    "sensor.other.collision": "carla_msgs/msg/CarlaCollisionEvent",
    "sensor.other.lane_invasion": "carla_msgs/msg/CarlaLaneInvasionEvent",
}
