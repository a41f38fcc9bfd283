"""Scans that are there already: PCD files of a folder, or one file, with or without poses."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from linden.errors import UserError
from linden.pointcloud.cloud import F64, HERE, Cloud, Scan
from linden.pointcloud.pcd_reading import clouds_of, header_of
from linden.pointcloud.pcd_writing import PcdWriter
from linden.pointcloud.poses import pose_line, read_poses, write_poses

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
