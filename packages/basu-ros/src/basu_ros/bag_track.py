"""The drive in a ROS bag, of ROS 1 or ROS 2: odometry and controls as columns in CARLA's axes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag1 import ReaderError as Error1
from rosbags.rosbag2 import ReaderError as Error2

from basu.errors import UserError
from linden_ros2 import frames
from linden_ros2.types import Generation, types_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

ODOMETRY = "nav_msgs/msg/Odometry"
CONTROL = "carla_msgs/msg/CarlaEgoVehicleControl"
LEAST = 2  # messages of odometry
LONGEST_GAP_S = 1.0  # between two of them; a bag with more has lost a part of the drive


class Track(NamedTuple):
    """A drive as it was measured, with the times of its messages from 0 on."""

    t_s: NDArray[np.float64]  # (N,) strictly ascending
    pose: NDArray[np.float64]  # (N, 6) x, y, z in m, roll, pitch, yaw in rad without jumps; CARLA's axes
    velocity_mps: NDArray[np.float64]  # (N, 3) in the world
    spin_radps: NDArray[np.float64]  # (N, 3) likewise
    control_t_s: NDArray[np.float64]  # (M,)
    controls: NDArray[np.float64]  # (M, 5) throttle, steer, brake, hand brake, reverse
    topic: str  # of the odometry


def read_track(path: Path, odometry: str | None = None, control: str | None = None) -> Track:
    """Read the drive in a bag; by default of its only topic of odometry, with the only one of CARLA's controls.

    Raises:
        UserError: it is no bag, has no such topic or several, or what it measured is no drive.
    """
    if not path.exists():
        raise UserError(f"the bag {path} is not there; name a folder of ROS 2, a .mcap, a .db3 or a .bag file")
    try:
        with AnyReader([path], default_typestore=types_of(Generation.ROS_2).store) as reader:
            topic = _topic(reader, ODOMETRY, odometry, path)
            assert topic is not None, "the odometry is required"
            rows = list(_rows(reader, topic, _odometry_row))
            commanded = _topic(reader, CONTROL, control, path, required=control is not None)
            controls = [] if commanded is None else list(_rows(reader, commanded, _control_row))
    except (AnyReaderError, Error1, Error2, OSError, ValueError) as error:
        raise UserError(f"the bag {path} cannot be read: {error}") from error
    return _track(rows, controls, topic, path)


def _topic(reader: Any, kind: str, wanted: str | None, path: Path, *, required: bool = True) -> str | None:  # noqa: ANN401
    """The topic of a type: the wanted one, else the only one."""
    found = sorted({each.topic for each in reader.connections if each.msgtype == kind})
    if wanted is not None and wanted not in found:
        has = ", ".join(found) or "none"
        raise UserError(f"the bag {path} has no topic {wanted} of the type {kind}; it has {has}")
    if wanted is None and len(found) > 1 and required:
        option = "--odometry" if kind == ODOMETRY else "--control"
        raise UserError(
            f"the bag {path} has several topics of the type {kind}: {', '.join(found)}; choose with {option}"
        )
    if not found and required:
        every = ", ".join(sorted({each.topic for each in reader.connections})) or "no topics"
        raise UserError(f"the bag {path} has no topic of the type {kind}, which a drive is read from; it has {every}")
    return wanted or (found[0] if len(found) == 1 else None)


def _rows(reader: Any, topic: str, row_of: Any) -> Iterator[tuple[float, ...]]:  # noqa: ANN401 - of rosbags
    """A row for each message: its time, the header's where it has one, and what ``row_of`` reads."""
    connections = [each for each in reader.connections if each.topic == topic]
    for connection, received_ns, data in reader.messages(connections=connections):
        message = reader.deserialize(data, connection.msgtype)
        stamp = message.header.stamp
        stamped_s = stamp.sec + 1e-9 * stamp.nanosec
        yield (stamped_s or 1e-9 * received_ns, *row_of(message))


def _odometry_row(message: Any) -> tuple[float, ...]:  # noqa: ANN401 - a message
    """Pose, velocity and angular velocity of a message, all in the world and in CARLA's axes."""
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    attitude = (turn.x, turn.y, turn.z, turn.w)
    if not math.isfinite(sum(attitude)) or math.hypot(*attitude) < 0.5:
        return (math.nan,) * 12
    moving, turning = message.twist.twist.linear, message.twist.twist.angular
    velocity = frames.rotated(attitude, (moving.x, moving.y, moving.z))
    spin = frames.rotated(attitude, (turning.x, turning.y, turning.z))
    return (
        *frames.vector(at.x, at.y, at.z),
        *frames.angles(attitude),
        *frames.vector(*velocity),
        *frames.axial(*spin),
    )


def _control_row(message: Any) -> tuple[float, ...]:  # noqa: ANN401 - a message
    return (message.throttle, message.steer, message.brake, float(message.hand_brake), float(message.reverse))


def _track(rows: list[tuple[float, ...]], controls: list[tuple[float, ...]], topic: str, path: Path) -> Track:
    """The drive as arrays, in the order of its times.

    Raises:
        UserError: it is too short, or holds what is no number, or a gap.
    """
    table: NDArray[np.float64] = np.array(rows, dtype=np.float64).reshape(-1, 13)
    if not np.isfinite(table).all():
        count = int((~np.isfinite(table).all(axis=1)).sum())
        raise UserError(
            f"{count} messages of {topic} in the bag {path} hold no numbers (nan, or no attitude); cut them out"
        )
    table = table[np.unique(table[:, 0], return_index=True)[1]]
    if len(table) < LEAST:
        raise UserError(f"{topic} in the bag {path} has {len(table)} different times; a drive needs {LEAST} or more")
    gap_s = float(np.diff(table[:, 0]).max())
    if gap_s > LONGEST_GAP_S:
        raise UserError(
            f"{topic} in the bag {path} has a gap of {gap_s:.1f} s; a record needs one message every "
            f"{LONGEST_GAP_S:g} s at least: cut the bag into its parts"
        )
    commands: NDArray[np.float64] = np.array(controls, dtype=np.float64).reshape(-1, 6)
    commands = commands[np.argsort(commands[:, 0], kind="stable")]
    first_s = table[0, 0]
    pose = table[:, 1:7].copy()
    pose[:, 3:] = np.unwrap(pose[:, 3:], axis=0)
    return Track(
        table[:, 0] - first_s, pose, table[:, 7:10], table[:, 10:13], commands[:, 0] - first_s, commands[:, 1:], topic
    )
