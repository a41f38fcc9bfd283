"""``linden map package``: one folder with everything that Autoware, or CARLA on Unreal, needs of a town."""

import argparse
import shutil
from pathlib import Path

import shapely

from linden.cli.process import broken_off_cleanly
from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden.scenery.map_mesh import standing
from linden.simulation.surroundings import scenery_of
from linden_maps import autoware_folder as folder
from linden_maps.aisan.along import part_along, read_positions, way_along
from linden_maps.aisan.convert import convert as aisan_of
from linden_maps.cli import map_convert, map_pointcloud
from linden_maps.cli.map import add_pointcloud
from linden_maps.cli.map_files import content_of
from linden_maps.cli.map_source import parsed, world_map_of
from linden_maps.cli.output import say, say_step
from linden_maps.lanelet2.convert import convert
from linden_maps.lanelet2.osm import osm_bytes, projector_info
from linden_maps.output import staged_folder
from linden_maps.unreal.package import names_of, write_package
from linden_maps.unreal.parts import parts_of

_STEPS = (
    "lanelets of the streets",
    "Aisan's vectors and the files of the map",
    "the point cloud",
    "metadata and manifest",
)


def run(arguments: argparse.Namespace) -> int:
    """Write the folder as a whole, or leave everything as it was."""
    return _for_carla(arguments) if arguments.user == "carla" else _for_autoware(arguments)


def _for_carla(arguments: argparse.Namespace) -> int:
    if arguments.pointcloud is not None or arguments.ros1 or arguments.along is not None:
        raise UserError("--pointcloud, --ros1 and --along are for --for autoware; leave them out")
    names = names_of(Path(arguments.file).name.removesuffix(".xodr"))
    world_map = world_map_of(arguments.file)
    scene = scenery_of(world_map).scene
    with broken_off_cleanly(), staged_folder(arguments.output, names.is_ours) as stage:
        parts = parts_of(standing(parse(world_map.text), world_map, scene), scene, names.map)
        write_package(stage, names, content_of(arguments.file), parts, usd=not arguments.no_usd)
    triangles = sum(len(part.triangles) for part in parts)
    say(f"{triangles:,} triangles in {len(parts)} objects of {len({part.group for part in parts})} semantic groups")
    for path in sorted(path for path in arguments.output.rglob("*") if path.is_file()):
        say(f"{path.stat().st_size:12,} bytes {path}")
    return 0


def _for_autoware(arguments: argparse.Namespace) -> int:
    positions_m = None if arguments.along is None else read_positions(arguments.along)
    source = content_of(arguments.file)
    opendrive = parsed(arguments.file, source)
    _begin(1)
    converted = convert(opendrive, map_convert.wanted_of(arguments, opendrive))
    _begin(2)
    way = None if positions_m is None else way_along(converted.lanelet_map, positions_m)
    whole = converted.lanelet_map
    vectors = aisan_of(whole if way is None else part_along(whole, way, arguments.within))
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
        _begin(3)
        _put_cloud(arguments, stage / layout.point_cloud, way)
        _begin(4)
        if layout.metadata is not None:
            (stage / layout.metadata).write_bytes(folder.point_cloud_metadata(stage / layout.point_cloud))
        (stage / folder.MANIFEST).write_bytes(folder.manifest(stage, source, lanelet_map))
    map_convert.report(arguments.output / layout.lanelet2, converted)
    for path in sorted(path for path in arguments.output.rglob("*") if path.is_file()):
        say(f"{path.stat().st_size:12,} bytes {path}")
    return 0


def _begin(step: int) -> None:
    say_step(step, len(_STEPS), _STEPS[step - 1])


def _put_cloud(arguments: argparse.Namespace, target: Path, way: shapely.Geometry | None) -> None:
    """Write the point cloud: a copy of the one that was named, else that of a drive, of a way or of all streets."""
    if arguments.pointcloud is not None:
        try:
            shutil.copyfile(arguments.pointcloud, target)
        except FileNotFoundError as error:
            raise UserError(f"cannot read {arguments.pointcloud}: {error.strerror}; name a .pcd file") from None
        return
    parser = argparse.ArgumentParser(prog="linden map package")
    add_pointcloud(parser)
    words = [arguments.file, "-o", str(target), "--voxel", arguments.voxel, "--every", arguments.every]
    map_pointcloud.run(parser.parse_args(words), None if way is None else map_pointcloud.Near(way, arguments.within))
