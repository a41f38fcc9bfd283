"""`write_scans`: the clouds of a lidar in a bag as PCD files, with the sensor's pose in the map for each.

`linden map pointcloud --from FOLDER` makes a map of them. Clouds stay in the sensor's frame. The poses come from the
transforms of the bag (``/tf`` and ``/tf_static``), in ROS's axes: x east, y north, z up, in m.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag1 import ReaderError as Error1
from rosbags.rosbag2 import ReaderError as Error2
from scipy.spatial.transform import Rotation, Slerp

from basu.errors import UserError
from basu.files import write_bytes
from linden_ros2.sensor_messages import CLOUD
from linden_ros2.topic import TF
from linden_ros2.types import Generation, types_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

MAP_FRAMES = ("map", "world")
POSES_FILE = "poses.txt"  # a line is: name x y z qx qy qz qw
FLOAT32 = 7  # sensor_msgs/PointField
HEADER = (
    "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
    "WIDTH {0}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n"
)


class _Track:
    """The poses of one frame in its parent's, by time."""

    def __init__(self, parent: str) -> None:
        self.parent = parent
        self._rows: dict[float, tuple[float, ...]] = {}

    def add(self, time_s: float, row: tuple[float, ...]) -> None:
        """Take a pose: x, y, z, qx, qy, qz, qw."""
        self._rows[time_s] = row

    def at(self, time_s: float) -> NDArray[np.float64] | None:
        """Return the (4, 4) transform into the parent's frame, between its neighbours; None outside of the poses."""
        times_s = np.array(sorted(self._rows))
        rows = np.array([self._rows[each] for each in times_s])
        found = np.eye(4)
        if len(rows) == 1:
            found[:3, :3], found[:3, 3] = Rotation.from_quat(rows[0, 3:]).as_matrix(), rows[0, :3]
            return found
        if not times_s[0] <= time_s <= times_s[-1]:
            return None
        found[:3, :3] = Slerp(times_s, Rotation.from_quat(rows[:, 3:]))(time_s).as_matrix()
        found[:3, 3] = [np.interp(time_s, times_s, rows[:, axis]) for axis in range(3)]
        return found


def write_scans(bag: Path, folder: Path, topic: str | None, every: int) -> int:
    """Write each so manyth cloud of a lidar into a folder that is there; return their number.

    Raises:
        UserError: it is no bag, has no such lidar or several, or no transform leads from a cloud to the map.
    """
    if not bag.exists():
        raise UserError(f"the bag {bag} is not there; name a folder of ROS 2, a .mcap, a .db3 or a .bag file")
    try:
        with AnyReader([bag], default_typestore=types_of(Generation.ROS_2).store) as reader:
            chosen = _topic(reader, topic, bag)
            tracks = _tracks(reader)
            lines: list[str] = []
            for number, (time_s, frame, points) in enumerate(_clouds(reader, chosen, bag)):
                if number % every:
                    continue
                pose = _in_map(tracks, frame, time_s)
                if pose is None:
                    if not lines:
                        _check_chain(tracks, frame, bag)
                    continue  # before the first or after the last transform
                name = f"{number:06d}"
                write_bytes(folder / f"{name}.pcd", HEADER.format(len(points)).encode() + points.tobytes())
                values = (*pose[:3, 3], *Rotation.from_matrix(pose[:3, :3]).as_quat())
                lines.append(f"{name} {' '.join(f'{value:.9f}' for value in values)}\n")
    except (AnyReaderError, Error1, Error2, OSError, ValueError) as error:
        raise UserError(f"the bag {bag} cannot be read: {error}") from error
    if not lines:
        raise UserError(f"the bag {bag} has no cloud of {chosen} within the time of its transforms; record it again")
    write_bytes(folder / POSES_FILE, "".join(lines).encode())
    return len(lines)


def _topic(reader: AnyReader, wanted: str | None, bag: Path) -> str:
    """Return the topic of clouds: the wanted one, else the only one."""
    found = sorted({each.topic for each in reader.connections if each.msgtype == CLOUD})
    has = ", ".join(found) or "none"
    if wanted is not None and wanted not in found:
        raise UserError(f"the bag {bag} has no clouds on {wanted}; it has {has}")
    if wanted is None and len(found) != 1:
        what = "several topics with clouds" if found else "no topic with clouds"
        raise UserError(f"the bag {bag} has {what} ({has}); choose one with --topic, or record a lidar")
    return wanted or found[0]


def _tracks(reader: AnyReader) -> dict[str, _Track]:
    """Return the transforms of the bag, by the name of the child's frame."""
    found: dict[str, _Track] = {}
    for message in _messages(reader, TF.type):
        for each in message.transforms:
            moved, turned, stamp = each.transform.translation, each.transform.rotation, each.header.stamp
            row = (moved.x, moved.y, moved.z, turned.x, turned.y, turned.z, turned.w)
            track = found.setdefault(_plain(each.child_frame_id), _Track(_plain(each.header.frame_id)))
            track.add(stamp.sec + 1e-9 * stamp.nanosec, row)
    return found


def _messages(reader: AnyReader, kind: str, topic: str | None = None) -> Iterator[Any]:
    """Yield the messages of a type."""
    wanted = [each for each in reader.connections if each.msgtype == kind and topic in {None, each.topic}]
    for connection, _, data in reader.messages(connections=wanted):
        yield reader.deserialize(data, connection.msgtype)


def _clouds(reader: AnyReader, topic: str, bag: Path) -> Iterator[tuple[float, str, NDArray[np.float32]]]:
    """Yield time, frame and points (N, 3) of each cloud."""
    for message in _messages(reader, CLOUD, topic):
        fields = {each.name: each for each in message.fields}
        if any(name not in fields or fields[name].datatype != FLOAT32 for name in "xyz"):
            raise UserError(f"the bag {bag} has clouds on {topic} without x, y and z as float32; choose others")
        order = ">" if message.is_bigendian else "<"
        row = np.dtype(
            {
                "names": list("xyz"),
                "formats": [f"{order}f4"] * 3,
                "offsets": [fields[name].offset for name in "xyz"],
                "itemsize": message.point_step,
            }
        )
        rows = np.frombuffer(bytes(message.data), row)
        points = np.stack([rows[name] for name in "xyz"], axis=1).astype("<f4")
        stamp = message.header.stamp
        yield stamp.sec + 1e-9 * stamp.nanosec, _plain(message.header.frame_id), points[np.isfinite(points).all(axis=1)]


def _in_map(tracks: dict[str, _Track], frame: str, time_s: float) -> NDArray[np.float64] | None:
    """Return the (4, 4) transform from a frame to the map at a time; None where one of them is not there."""
    found = np.eye(4)
    for _ in range(len(tracks) + 1):
        if frame in MAP_FRAMES:
            return found
        track = tracks.get(frame)
        step = None if track is None else track.at(time_s)
        if track is None or step is None:
            return None
        found, frame = step @ found, track.parent
    return None


def _check_chain(tracks: dict[str, _Track], frame: str, bag: Path) -> None:
    """Check that transforms lead from a frame to the map at some time.

    Raises:
        UserError: they do not.
    """
    chain: Sequence[str] = [frame]
    while chain[-1] in tracks and tracks[chain[-1]].parent not in chain:
        chain = [*chain, tracks[chain[-1]].parent]
    if chain[-1] not in MAP_FRAMES:
        raise UserError(
            f"the bag {bag} has no transforms from the lidar's frame to the map: {' -> '.join(chain)} ends there; "
            "record /tf and /tf_static too"
        )


def _plain(frame: str) -> str:
    return frame.lstrip("/")
