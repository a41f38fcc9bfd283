"""``linden map pointcloud``: drive the streets with a lidar, or take existing scans; write one point cloud."""

import argparse
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from linden.cli.map_source import world_map_of
from linden.cli.process import broken_off_cleanly
from linden.errors import UserError

if TYPE_CHECKING:
    from linden.authoring.pointcloud.cloud import Scan

HELP = "drive the streets with a lidar, or take existing scans, and write one point cloud (.pcd)"
_DEFAULT_MAP = "Linden"
_QUIET_S = 10.0  # between two lines of the bar where the output is no terminal (a log file)


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    command.add_argument("file", nargs="?", help="an OpenDRIVE file, or the name of a built-in map (default: Linden)")
    command.add_argument("-o", "--output", type=Path, required=True, help="where to write the .pcd file")
    command.add_argument(
        "--voxel",
        type=_not_negative,
        default=0.2,
        metavar="M",
        help="width of the cells that keep one point each; 0 keeps all points (default: %(default)s)",
    )
    command.add_argument("--labels", action="store_true", help="give each point CARLA's semantic tag, as field label")
    drive = command.add_argument_group("the drive")
    drive.add_argument(
        "--every", type=_positive, default=5.0, metavar="M", help="scan where none is nearer (default: %(default)s)"
    )
    drive.add_argument("--range", type=_positive, default=100.0, metavar="M", help="(default: %(default)s)")
    drive.add_argument("--channels", type=_count, default=64, metavar="N", help="(default: %(default)s)")
    drive.add_argument(
        "--columns", type=_count, default=1800, metavar="N", help="rays of a channel in a turn (default: %(default)s)"
    )
    drive.add_argument("--upper-fov", type=_angle, default=15.0, metavar="DEG", help="(default: %(default)s)")
    drive.add_argument("--lower-fov", type=_angle, default=-25.0, metavar="DEG", help="(default: %(default)s)")
    drive.add_argument(
        "--height", type=_positive, default=2.4, metavar="M", help="of the lidar above the lane (default: %(default)s)"
    )
    drive.add_argument(
        "--device", default="cpu", metavar="NAME", help="where rays are cast: cpu, or cuda (default: %(default)s)"
    )
    drive.add_argument("--scans", type=Path, metavar="DIR", help="keep every scan too, and its pose, in a new folder")
    existing = command.add_argument_group("existing scans, instead of a drive")
    existing.add_argument("--from", dest="source", type=Path, metavar="PATH", help="a folder of .pcd files, or one")
    existing.add_argument(
        "--poses",
        type=Path,
        metavar="FILE",
        help="where each was made (default: poses.txt of the folder; without it they lie in the map's frame)",
    )


class _Job(NamedTuple):
    """Scans to be made one file of."""

    scans: "Iterator[Scan]"
    amount: int
    unit: str  # what it is an amount of
    labelled: bool
    remark: str  # for the head of the file


def run(arguments: argparse.Namespace) -> int:
    """Write the point cloud, and say what is in it."""
    # here, not above: `linden --help` does not pay for them
    from tqdm import tqdm  # noqa: PLC0415 - see above

    from linden.authoring.pointcloud.merge import merge, working_folder  # noqa: PLC0415 - see above
    from linden.authoring.pointcloud.pcd_writing import PcdWriter  # noqa: PLC0415 - see above

    job = _driven(arguments) if arguments.source is None else _existing(arguments)
    with (
        broken_off_cleanly(),
        working_folder() as folder,  # before the work shows, so that an interrupt finds the folder
        PcdWriter(arguments.output, job.remark, labelled=job.labelled) as writer,
        tqdm(
            total=job.amount,
            unit=f" {job.unit}",
            unit_scale=job.unit == "points",
            mininterval=0.1 if sys.stderr.isatty() else _QUIET_S,
        ) as bar,
    ):
        merged = merge(job.scans, writer, arguments.voxel, Path(folder), bar.update)
    _say(f"{arguments.output}: {merged.written:,} of {merged.came:,} points, {_size(arguments.output)}")
    _say(job.remark)
    return 0


def _driven(arguments: argparse.Namespace) -> _Job:
    """Return the scans of a drive that is yet to be made.

    Raises:
        UserError: there is no such map, or it has no lane to drive on.
    """
    from linden.authoring.pointcloud.drive import (  # noqa: PLC0415 - see `run`
        Lidar,
        drive,
        places_along,
    )
    from linden.authoring.pointcloud.scan_folder import kept_scans  # noqa: PLC0415 - see `run`
    from linden.maps.cache import MapCache  # noqa: PLC0415 - see `run`
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - see `run`
    from linden.scenery.map_mesh_cache import standing_of  # noqa: PLC0415 - see `run`
    from linden.sensors.casting.choose import caster_of, check_device  # noqa: PLC0415 - see `run`
    from linden.simulation.surroundings import scenery_of  # noqa: PLC0415 - see `run`

    if arguments.poses is not None:
        raise UserError("--poses are those of existing scans: name these by --from")
    if arguments.upper_fov < arguments.lower_fov:
        raise UserError(f"--upper-fov {arguments.upper_fov:g} is below --lower-fov {arguments.lower_fov:g}")
    check_device(arguments.device)
    world_map = world_map_of(arguments.file or _DEFAULT_MAP)
    places = places_along(parse(world_map.text), arguments.every, arguments.height)
    if not places:
        raise UserError(f"{world_map.name} has no driving lane, so there is nowhere to drive")
    standing = standing_of(world_map, scenery_of(world_map).scene, MapCache.of_user())
    lidar = Lidar(arguments.channels, arguments.upper_fov, arguments.lower_fov, arguments.range, arguments.columns)
    scans = drive(places, lidar, caster_of(standing, [], arguments.device), standing)
    latitude, longitude = world_map.geo_origin_deg
    remark = (
        f"{world_map.name}: x east, y north, z up, m; x = y = 0 at latitude {latitude:.7f}, longitude {longitude:.7f}"
    )
    kept = scans if arguments.scans is None else kept_scans(scans, arguments.scans)
    return _Job(kept, len(places), "scans", arguments.labels, remark)


def _existing(arguments: argparse.Namespace) -> _Job:
    """Return the scans of a folder or a file.

    Raises:
        UserError: it holds none, or they have no labels where these are wanted.
    """
    from linden.authoring.pointcloud.scan_folder import recorded  # noqa: PLC0415 - see `run`

    if arguments.file is not None or arguments.scans is not None:
        raise UserError("--from takes scans that are there already: leave the map and --scans out")
    found = recorded(arguments.source, arguments.poses)
    if arguments.labels and not found.labelled:
        raise UserError(f"--labels: not every file of {arguments.source} has a field label")
    count = f"{len(found.files)} file{'' if len(found.files) == 1 else 's'}"
    remark = f"points of {count}, {'moved by their poses' if found.moved else 'in the frame they had'}"
    return _Job(found.scans(), found.points, "points", arguments.labels, remark)


def _positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def _not_negative(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is neither 0 nor a positive number")
    return value


def _angle(text: str) -> float:
    value = float(text)
    if not abs(value) <= 90.0:
        raise argparse.ArgumentTypeError(f"{text} is not between -90 and 90 degrees")
    return value


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return value


def _size(file: Path) -> str:
    return f"{file.stat().st_size / 1e6:,.1f} MB"


def _say(line: str) -> None:
    print(line)  # noqa: T201 - what a command says to its user
