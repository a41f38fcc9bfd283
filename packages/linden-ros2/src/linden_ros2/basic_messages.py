"""Messages that others are made of: times, headers, vectors, poses, transforms, and the clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from linden_ros2 import frames
    from linden_ros2.frames import Pose
    from linden_ros2.types import Types

NS_PER_S = 1_000_000_000


def nanoseconds(t_s: float) -> int:
    """Return a simulated time in ns; CARLA's sums of steps are rounded to the microsecond."""
    return round(t_s * 1e6) * 1000


def stamp(types: Types, t_s: float) -> Any:  # noqa: ANN401 - a message
    """Return a time."""
    sec, nanosec = divmod(nanoseconds(t_s), NS_PER_S)
    return types.message("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)


def header(types: Types, t_s: float, frame: str) -> Any:  # noqa: ANN401 - a message
    """Return a header: the simulated time and the frame."""
    return types.message("std_msgs/msg/Header", stamp=stamp(types, t_s), frame_id=frame)


def clock(types: Types, t_s: float) -> Any:  # noqa: ANN401 - a message
    """Return the simulated time as a message of /clock."""
    return types.message("rosgraph_msgs/msg/Clock", clock=stamp(types, t_s))


def vector3(types: Types, xyz: frames.Vector, kind: str = "Vector3") -> Any:  # noqa: ANN401 - a message
    """Return a geometry_msgs/Vector3, or a Point."""
    return types.message(f"geometry_msgs/msg/{kind}", x=xyz[0], y=xyz[1], z=xyz[2])


def quaternion(types: Types, turn: frames.Quaternion) -> Any:  # noqa: ANN401 - a message
    """Return a geometry_msgs/Quaternion."""
    return types.message("geometry_msgs/msg/Quaternion", x=turn[0], y=turn[1], z=turn[2], w=turn[3])


def pose_message(types: Types, pose: Pose) -> Any:  # noqa: ANN401 - a message
    """Return a geometry_msgs/Pose."""
    return types.message(
        "geometry_msgs/msg/Pose",
        position=vector3(types, pose.position_m, "Point"),
        orientation=quaternion(types, pose.attitude),
    )


def transforms(types: Types, t_s: float, tree: list[tuple[str, str, Pose]]) -> Any:  # noqa: ANN401 - a message
    """Return transforms, each of a parent, a child and the child's pose in the parent."""
    rows = [
        types.message(
            "geometry_msgs/msg/TransformStamped",
            header=header(types, t_s, parent),
            child_frame_id=child,
            transform=types.message(
                "geometry_msgs/msg/Transform",
                translation=vector3(types, pose.position_m),
                rotation=quaternion(types, pose.attitude),
            ),
        )
        for parent, child, pose in tree
    ]
    return types.message("tf2_msgs/msg/TFMessage", transforms=rows)
