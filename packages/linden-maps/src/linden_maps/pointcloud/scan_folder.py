"""Scans from PCD files, with or without a file of poses in the map's frame.

A file of poses has one pose a line, in one of two forms. Eight columns are "name x y z qx qy qz qw", where the name is
that of the scan's file without ".pcd" (TUM's trajectories). Twelve columns are the rows of a 3 x 4 matrix (KITTI's), a
line for each file in the order of their names. Lines that begin with # are comments.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from linden.errors import UserError
from linden_maps.pointcloud.cloud import F64, HERE, Cloud, Scan
from linden_maps.pointcloud.pcd_reading import clouds_of, header_of
from linden_maps.pointcloud.pcd_writing import PcdWriter

_REMARK = "# name x y z qx qy qz qw: the sensor in the map, m and a unit quaternion; x east, y north, z up\n"


def read_poses(file: Path, names: Sequence[str]) -> list[F64]:
    """Return the pose (3, 4) of each scan of these names.

    Raises:
        UserError: the file cannot be read, or a scan has no pose in it.
    """
    try:
        lines = [line.split() for line in file.read_text("utf-8").splitlines()]
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"cannot read {file}: {error}") from None
    rows = [(number, words) for number, words in enumerate(lines, 1) if words and not words[0].startswith("#")]
    if not rows:
        raise UserError(f"{file} holds no pose")
    if len(rows[0][1]) == 12:
        if len(rows) != len(names):
            raise UserError(f"{file} holds {len(rows)} poses for {len(names)} scans; poses without names go one by one")
        return [_numbers(file, number, words, 12).reshape(3, 4) for number, words in rows]
    named = {words[0]: _of_quaternion(file, number, words[1:]) for number, words in rows}
    missing = [name for name in names if name not in named]
    if missing:
        raise UserError(f"{file} holds no pose for {len(missing)} of {len(names)} scans, the first being {missing[0]}")
    return [named[name] for name in names]


def pose_line(name: str, pose: F64) -> str:
    """Return a line of eight columns for a pose (3, 4) that only turns about z, as a level sensor's does."""
    half_rad = 0.5 * math.atan2(pose[1, 0], pose[0, 0])
    x, y, z = pose[:, 3].tolist()
    return f"{name} {x:.6f} {y:.6f} {z:.6f} 0 0 {math.sin(half_rad):.12f} {math.cos(half_rad):.12f}\n"


def write_poses(file: Path, lines: Sequence[str]) -> None:
    """Write a file of such lines.

    Raises:
        UserError: it cannot be written.
    """
    try:
        file.write_text(_REMARK + "".join(lines), "utf-8")
    except OSError as error:
        raise UserError(f"cannot write {file}: {error.strerror}") from None


def _numbers(file: Path, number: int, words: Sequence[str], count: int) -> F64:
    try:
        values = np.array([float(word) for word in words])
    except ValueError as error:
        raise UserError(f"{file}, line {number}: {error}") from None
    if len(values) != count or not np.isfinite(values).all():
        raise UserError(f"{file}, line {number}: a pose is a name and 7 numbers, or 12 numbers, all finite")
    return values


def _of_quaternion(file: Path, number: int, words: Sequence[str]) -> F64:
    """Return (3, 4) of x, y, z and a quaternion x, y, z, w (Diebel 2006, "Representing Attitude", equation 125)."""
    values = _numbers(file, number, words, 7)
    length = float(np.linalg.norm(values[3:]))
    if length < 1e-6:
        raise UserError(f"{file}, line {number}: the quaternion is zero, so it turns nothing anywhere")
    x, y, z, w = (values[3:] / length).tolist()
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.column_stack([turn, values[:3]])


POSES = "poses.txt"
"""Poses of a folder's scans, where it has such a file."""
_SENSOR_FRAME = "the sensor's frame: x forward, y left, z up, m; its poses are in poses.txt"


class Recorded(NamedTuple):
    """Scans that can be read."""

    files: tuple[Path, ...]
    poses: tuple[F64, ...]
    points: int
    labelled: bool  # whether every file says what its points are part of
    moved: bool  # whether there are poses

    def scans(self) -> Iterator[Scan]:
        """Give the scans in stretches; a point counts as one."""
        for file, pose in zip(self.files, self.poses, strict=True):
            for cloud in clouds_of(file):
                yield Scan(pose, cloud if self.labelled else Cloud(cloud.points_m), len(cloud.points_m))


def recorded(path: Path, poses: Path | None = None) -> Recorded:
    """Look at the heads of a folder's files, in the order of their names, or of one file.

    Poses are those of ``poses``, else of the folder's poses.txt; with neither, the scans lie in the map's frame.

    Raises:
        UserError: there is no PCD file, one cannot be read, or a pose is missing.
    """
    files = sorted(path.glob("*.pcd")) if path.is_dir() else [path]
    if not files:
        raise UserError(f"{path} holds no .pcd file")
    headers = [header_of(file) for file in files]
    if poses is None and path.is_dir() and (path / POSES).is_file():
        poses = path / POSES
    found: Sequence[F64] = [HERE] * len(files) if poses is None else read_poses(poses, [file.stem for file in files])
    labelled = all("label" in (header.point.names or ()) for header in headers)
    return Recorded(tuple(files), tuple(found), sum(header.points for header in headers), labelled, poses is not None)


def kept_scans(scans: Iterable[Scan], folder: Path) -> Iterator[Scan]:
    """Give the same scans on, and write each as a file of the folder; at the end their poses.

    Raises:
        UserError: the folder holds scans already, or cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"cannot write to {folder}: {error.strerror}") from None
    if next(folder.glob("*.pcd"), None) is not None:
        raise UserError(f"{folder} holds scans already; name a new folder, or empty it")
    lines = []
    for number, scan in enumerate(scans):
        name = f"{number:06}"
        with PcdWriter(folder / f"{name}.pcd", _SENSOR_FRAME, labelled=scan.cloud.label is not None) as writer:
            writer.write(scan.cloud)
        lines.append(pose_line(name, scan.map_from_sensor))
        yield scan
    write_poses(folder / POSES, lines)
