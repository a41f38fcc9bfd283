"""``linden map package``: one folder with everything that Autoware, or CARLA on Unreal, needs of a town."""

import argparse
import shutil
from pathlib import Path

from linden.cli import map_convert, map_pointcloud
from linden.cli.map_source import content_of, parsed, world_map_of
from linden.cli.process import broken_off_cleanly
from linden.errors import UserError

HELP = "write one folder with all that Autoware (or CARLA built on Unreal) needs of a town"


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    command.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map")
    command.add_argument(
        "--for", dest="user", choices=["autoware", "carla"], required=True, help="the program that reads the folder"
    )
    command.add_argument("-o", "--output", type=Path, required=True, help="a new folder, or one written before")
    command.add_argument(
        "--ros1", action="store_true", help="for autoware: the content folder of carla-autoware (Autoware.AI, ROS 1)"
    )
    command.add_argument("--no-usd", action="store_true", help="for carla: leave out USD, which needs usd-core")
    command.add_argument(
        "--pointcloud", type=Path, metavar="PCD", help="take this cloud instead of driving the streets with a lidar"
    )
    command.add_argument(
        "--voxel", default="0.2", metavar="M", help="width of the cloud's cells (default: %(default)s)"
    )
    map_convert.add_choices(command)
    command.add_argument("--every", default="5.0", metavar="M", help="between two scans (default: %(default)s)")


def run(arguments: argparse.Namespace) -> int:
    """Write the folder as a whole, or leave everything as it was."""
    return _for_carla(arguments) if arguments.user == "carla" else _for_autoware(arguments)


def _for_carla(arguments: argparse.Namespace) -> int:
    from linden.authoring.output import staged_folder  # noqa: PLC0415 - `linden --help` does not pay for it
    from linden.authoring.unreal.package import names_of, write_package  # noqa: PLC0415 - see above
    from linden.authoring.unreal.parts import parts_of  # noqa: PLC0415 - see above
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - see above
    from linden.scenery.map_mesh import standing  # noqa: PLC0415 - see above
    from linden.simulation.surroundings import scenery_of  # noqa: PLC0415 - see above

    if arguments.pointcloud is not None or arguments.ros1:
        raise UserError("--pointcloud and --ros1 are for --for autoware; leave them out")
    names = names_of(Path(arguments.file).name.removesuffix(".xodr"))
    world_map = world_map_of(arguments.file)
    scene = scenery_of(world_map).scene
    with broken_off_cleanly(), staged_folder(arguments.output, names.is_ours) as stage:
        parts = parts_of(standing(parse(world_map.text), world_map, scene), scene, names.map)
        write_package(stage, names, content_of(arguments.file), parts, usd=not arguments.no_usd)
    triangles = sum(len(part.triangles) for part in parts)
    _say(f"{triangles:,} triangles in {len(parts)} objects of {len({part.group for part in parts})} semantic groups")
    for path in sorted(path for path in arguments.output.rglob("*") if path.is_file()):
        _say(f"{path.stat().st_size:12,} bytes {path}")
    return 0


def _for_autoware(arguments: argparse.Namespace) -> int:
    # here, not above: `linden --help` does not pay for them
    from linden.authoring import autoware_folder as folder  # noqa: PLC0415 - see above
    from linden.authoring.aisan.convert import convert as aisan_of  # noqa: PLC0415 - see above
    from linden.authoring.lanelet2.convert import convert  # noqa: PLC0415 - see above
    from linden.authoring.lanelet2.osm import osm_bytes, projector_info  # noqa: PLC0415 - see above
    from linden.authoring.output import staged_folder  # noqa: PLC0415 - see above

    source = content_of(arguments.file)
    opendrive = parsed(arguments.file, source)
    converted = convert(opendrive, map_convert.wanted_of(arguments, opendrive))
    vectors = aisan_of(converted.lanelet_map)
    converted = map_convert.written_of(converted, arguments)
    lanelet_map = converted.lanelet_map
    town = Path(arguments.file).name.removesuffix(".xodr")
    layout = folder.ros1_layout(town) if arguments.ros1 else folder.UNIVERSE
    layout.refuse_other_towns(arguments.output)
    with broken_off_cleanly(), staged_folder(arguments.output, layout.is_ours) as stage:
        for path in (layout.lanelet2, layout.point_cloud, f"{layout.aisan}/lane.csv"):
            (stage / path).parent.mkdir(parents=True, exist_ok=True)
        (stage / layout.lanelet2).write_bytes(osm_bytes(lanelet_map))
        if layout.projector is not None:
            (stage / layout.projector).write_bytes(projector_info(lanelet_map))
        for name, data in vectors.tables.files().items():
            (stage / layout.aisan / name).write_bytes(data)
        _put_cloud(arguments, stage / layout.point_cloud)
        if layout.metadata is not None:
            (stage / layout.metadata).write_bytes(folder.point_cloud_metadata(stage / layout.point_cloud))
        (stage / folder.MANIFEST).write_bytes(folder.manifest(stage, source, lanelet_map))
    map_convert.report(arguments.output / layout.lanelet2, converted)
    for path in sorted(path for path in arguments.output.rglob("*") if path.is_file()):
        _say(f"{path.stat().st_size:12,} bytes {path}")
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


def _say(line: str) -> None:
    print(line)  # noqa: T201 - what a command says to its user
