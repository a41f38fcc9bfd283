"""``linden map pointcloud``: drive the streets with a lidar, or take existing scans; write one point cloud."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import shapely
from tqdm import tqdm

from linden.cli.process import broken_off_cleanly
from linden.errors import UserError
from linden.maps.cache import MapCache
from linden.maps.opendrive.parse import parse
from linden.scenery.map_mesh_cache import standing_of
from linden.sensors.casting.choose import caster_of, check_device
from linden.simulation.surroundings import scenery_of
from linden_maps.cli.map_source import world_map_of
from linden_maps.cli.output import say
from linden_maps.pointcloud.cloud import Scan
from linden_maps.pointcloud.drive import Lidar, drive, places_along
from linden_maps.pointcloud.merge import merge, working_folder
from linden_maps.pointcloud.pcd_writing import PcdWriter
from linden_maps.pointcloud.scan_folder import kept_scans, recorded

_DEFAULT_MAP = "Linden"
_QUIET_S = 10.0  # between two lines of the bar where the output is no terminal (a log file)


class _Job(NamedTuple):
    """Scans to be made one file of."""

    scans: Iterator[Scan]
    amount: int
    unit: str  # what it is an amount of
    labelled: bool
    remark: str  # for the head of the file


class Near(NamedTuple):
    """A way in the map's frame, and the distance in m within which the lidar scans beside it."""

    way: shapely.Geometry
    within_m: float


def run(arguments: argparse.Namespace, near: Near | None = None) -> int:
    """Write the point cloud, of all streets or of those near a way, and say what is in it."""
    job = _driven(arguments, near) if arguments.source is None else _existing(arguments)
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
    say(f"{arguments.output}: {merged.written:,} of {merged.came:,} points, {_size(arguments.output)}")
    say(job.remark)
    return 0


def _driven(arguments: argparse.Namespace, near: Near | None) -> _Job:
    """Return the scans of a drive that is yet to be made.

    Raises:
        UserError: there is no such map, or it has no lane to drive on.
    """
    if arguments.poses is not None:
        raise UserError("--poses are those of existing scans: name these by --from")
    if arguments.upper_fov < arguments.lower_fov:
        raise UserError(f"--upper-fov {arguments.upper_fov:g} is below --lower-fov {arguments.lower_fov:g}")
    check_device(arguments.device)
    world_map = world_map_of(arguments.file or _DEFAULT_MAP)
    places = places_along(parse(world_map.text), arguments.every, arguments.height)
    if near is not None:
        points = shapely.points([place[:2] for place in places])
        is_near = shapely.dwithin(points, near.way, near.within_m)
        places = [place for place, one in zip(places, is_near.tolist(), strict=True) if one]
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
    if arguments.file is not None or arguments.scans is not None:
        raise UserError("--from takes scans that are there already: leave the map and --scans out")
    found = recorded(arguments.source, arguments.poses)
    if arguments.labels and not found.labelled:
        raise UserError(f"--labels: not every file of {arguments.source} has a field label")
    count = f"{len(found.files)} file{'' if len(found.files) == 1 else 's'}"
    remark = f"points of {count}, {'moved by their poses' if found.moved else 'in the frame they had'}"
    return _Job(found.scans(), found.points, "points", arguments.labels, remark)


def _size(file: Path) -> str:
    return f"{file.stat().st_size / 1e6:,.1f} MB"
