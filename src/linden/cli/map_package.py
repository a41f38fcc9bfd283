"""``linden map package``: one folder with everything that Autoware needs of a town."""

import argparse
import shutil
from pathlib import Path

from linden.cli import map_convert, map_pointcloud
from linden.cli.map_source import content_of
from linden.cli.process import broken_off_cleanly
from linden.errors import UserError

HELP = "write one folder with all that Autoware needs of a town: Lanelet2, point cloud, Aisan, projection, manifest"


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    command.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map")
    command.add_argument(
        "--for", dest="user", choices=["autoware"], required=True, help="the program that reads the folder"
    )
    command.add_argument("-o", "--output", type=Path, required=True, help="a new folder, or one written before")
    command.add_argument(
        "--pointcloud", type=Path, metavar="PCD", help="take this cloud instead of driving the streets with a lidar"
    )
    command.add_argument(
        "--voxel", default="0.2", metavar="M", help="width of the cloud's cells (default: %(default)s)"
    )
    command.add_argument("--every", default="5.0", metavar="M", help="between two scans (default: %(default)s)")


def run(arguments: argparse.Namespace) -> int:
    """Write the folder as a whole, or leave everything as it was."""
    # here, not above: `linden --help` does not pay for them
    from linden.authoring import autoware_folder as folder  # noqa: PLC0415 - see above
    from linden.authoring.aisan.convert import convert as aisan_of  # noqa: PLC0415 - see above
    from linden.authoring.lanelet2.convert import convert  # noqa: PLC0415 - see above
    from linden.authoring.lanelet2.osm import osm_bytes, projector_info  # noqa: PLC0415 - see above
    from linden.authoring.output import staged_folder  # noqa: PLC0415 - see above
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - see above

    source = content_of(arguments.file)
    converted = convert(parse(source))
    lanelet_map = converted.lanelet_map
    vectors = aisan_of(lanelet_map)
    with broken_off_cleanly(), staged_folder(arguments.output, folder.NAMES.__contains__) as stage:
        (stage / folder.LANELET2).write_bytes(osm_bytes(lanelet_map))
        (stage / folder.PROJECTOR).write_bytes(projector_info(lanelet_map))
        (stage / folder.AISAN).mkdir()
        for name, data in vectors.tables.files().items():
            (stage / folder.AISAN / name).write_bytes(data)
        _put_cloud(arguments, stage / folder.POINT_CLOUD)
        (stage / folder.METADATA).write_bytes(folder.point_cloud_metadata(stage / folder.POINT_CLOUD))
        (stage / folder.MANIFEST).write_bytes(folder.manifest(stage, source, lanelet_map))
    map_convert.report(arguments.output / folder.LANELET2, converted)
    for path in sorted(arguments.output.iterdir()):
        size = path.stat().st_size if path.is_file() else sum(part.stat().st_size for part in path.iterdir())
        print(f"{size:12,} bytes {path}")  # noqa: T201 - what a command says to its user
    return 0


def _put_cloud(arguments: argparse.Namespace, target: Path) -> None:
    """Write the point cloud: a copy of the one that was named, else that of a drive."""
    if arguments.pointcloud is not None:
        try:
            shutil.copyfile(arguments.pointcloud, target)
        except FileNotFoundError as error:
            raise UserError(f"cannot read {arguments.pointcloud}: {error.strerror}; name a .pcd file") from None
        return
    parser = argparse.ArgumentParser(prog="linden map package")
    map_pointcloud.add_arguments(parser)
    words = [arguments.file, "-o", str(target), "--voxel", arguments.voxel, "--every", arguments.every]
    map_pointcloud.run(parser.parse_args(words))
