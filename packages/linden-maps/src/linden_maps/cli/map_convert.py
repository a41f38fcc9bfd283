"""``linden map convert``: a map as Lanelet2 (.osm) or Aisan (a folder of .csv)."""

import argparse
import time
from pathlib import Path

from linden.errors import UserError
from linden.maps.opendrive.model import OpenDrive
from linden_maps.aisan.convert import convert as aisan_of
from linden_maps.aisan.reading import complaints, read_folder
from linden_maps.cli.map_files import bytes_of, is_built_in
from linden_maps.cli.map_source import opendrive_of
from linden_maps.cli.output import say
from linden_maps.lanelet2.bounds import STATED_ERROR_M
from linden_maps.lanelet2.bus_stops import KerbStop, shuttle_stops
from linden_maps.lanelet2.convert import UNKNOWN_SPEED_KMH, ConvertedMap, Wanted, convert, counts
from linden_maps.lanelet2.model import LaneletMap, without_lanelets
from linden_maps.lanelet2.osm import osm_bytes, projector_info, read_osm
from linden_maps.lanelet2.shared import NEAR_M
from linden_maps.lanelet2.stretches import WALKWAY
from linden_maps.output import write_file, write_folder
from linden_maps.sumo.bus_stops import read_stops

_PROJECTOR = "map_projector_info.yaml"


def run(arguments: argparse.Namespace) -> int:
    """Write the map in the format that the output's name asks for."""
    started = time.perf_counter()
    if arguments.output.suffix == ".osm":
        _to_lanelet2(arguments)
    elif arguments.output.suffix:
        raise UserError(f"{arguments.output} is neither a .osm file nor a folder; name one of these")
    else:
        _to_aisan(arguments)
    say(f"{time.perf_counter() - started:.1f} s")
    return 0


def _to_lanelet2(arguments: argparse.Namespace) -> None:
    opendrive = opendrive_of(arguments.file)
    converted = written_of(convert(opendrive, wanted_of(arguments, opendrive)), arguments)
    info = projector_info(converted.lanelet_map, transverse_mercator=arguments.transverse_mercator)
    write_file(arguments.output, osm_bytes(converted.lanelet_map))
    write_file(arguments.output.with_name(_PROJECTOR), info)
    report(arguments.output, converted)


def wanted_of(arguments: argparse.Namespace, opendrive: OpenDrive) -> Wanted:
    """Return what the arguments ask for of a map.

    Raises:
        UserError: the file of stops cannot be read.
    """
    stops: tuple[KerbStop, ...] = ()
    if arguments.stops is not None:
        stops = tuple(KerbStop(one.id, one.name, one.x_m, -one.y_m) for one in read_stops(arguments.stops))
    elif is_built_in(arguments.file):
        stops = shuttle_stops(opendrive.geo_origin)
    return Wanted(arguments.pairwise_priority, arguments.format == 2, stops)


def written_of(converted: ConvertedMap, arguments: argparse.Namespace) -> ConvertedMap:
    """Return what is written of a map: without sidewalks, if they are not wanted."""
    if arguments.walkways:
        return converted
    return converted._replace(lanelet_map=without_lanelets(converted.lanelet_map, WALKWAY))


def lanelets_of(name: str) -> LaneletMap:
    """Return the Lanelet2 map of a .osm file, or of an OpenDRIVE file or built-in map."""
    if Path(name).suffix == ".osm":
        return read_osm(bytes_of(Path(name)), name)
    return convert(opendrive_of(name)).lanelet_map


def _to_aisan(arguments: argparse.Namespace) -> None:
    if arguments.transverse_mercator:
        raise UserError("an Aisan vector map has no map_projector_info.yaml; leave --transverse-mercator out")
    if arguments.walkways or arguments.stops is not None or arguments.format != 1 or arguments.pairwise_priority:
        raise UserError("--walkways, --stops, --format and --pairwise-priority are for Lanelet2; leave them out")
    vectors = aisan_of(lanelets_of(arguments.file))
    write_folder(arguments.output, vectors.tables.files())
    for name, rows in vectors.tables.rows.items():
        if rows:
            say(f"{len(rows):8,} {name}.csv")
    if vectors.lost_links:
        say(f"{vectors.lost_links} links are lost: a row has room for four before and four after it")
    if vectors.without_limit:
        say(f"{vectors.without_limit} lanelets have no speed limit: 50 km/h is assumed")
    found = complaints(read_folder(arguments.output))
    for line in found:
        say(f"error {line}")
    say(f"{arguments.output}: read back by the rules of Autoware's nodes, {len(found)} complaints")


def report(path: Path, converted: ConvertedMap) -> None:
    """Print what a Lanelet2 map has, what was left out, and what was assumed."""
    lanelet_map = converted.lanelet_map
    say(
        f"{path}: {len(lanelet_map.nodes):,} nodes, {len(lanelet_map.ways):,} ways, "
        f"{len(lanelet_map.relations):,} relations; bounds within {100 * STATED_ERROR_M:g} cm of the OpenDRIVE curves"
    )
    if converted.shared:
        say(
            f"{len(converted.shared)} edges of ways through junctions are {len(converted.shared) // 2} shared bounds, "
            f"within {100 * NEAR_M / 2:g} cm"
        )
    for name, count in sorted(counts(lanelet_map).items()):
        say(f"{count:8,} {name}")
    for reason, count in sorted(converted.network.left_out.items()):
        say(f"left out: {count} {reason}")
    if not lanelet_map.geo_reference.strip():
        say("the map has no <geoReference>: its origin is written as latitude 0, longitude 0; local_x and local_y hold")
    if converted.without_limit:
        say(f"{converted.without_limit} road lanelets have no limit in the map: {UNKNOWN_SPEED_KMH:g} km/h is assumed")
    if converted.lost_links:
        say(f"{converted.lost_links} links are lost: the lanes' ends lie too far apart; linden map check names them")
    for stop in converted.lost_stops:
        say(f"stop {stop.id} ({stop.name}) is left out: no driving lane is near")
    if converted.signals_without_lane:
        say(f"{converted.signals_without_lane} signs and lights speak to no driving lane, and are left out")
