"""``linden map convert`` and the check of what it wrote: Lanelet2 (.osm) and Aisan (a folder of .csv)."""

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from linden.cli.map_source import bytes_of, is_built_in, opendrive_of
from linden.errors import UserError

if TYPE_CHECKING:
    from linden.authoring.lanelet2.convert import Converted, Wanted
    from linden.authoring.lanelet2.model import LaneletMap
    from linden.maps.opendrive.model import OpenDrive

HELP = "turn a map into Lanelet2 (.osm) or an Aisan vector map (a folder), for Autoware"
_PROJECTOR = "map_projector_info.yaml"


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add what the command takes."""
    command.add_argument("file", help="an OpenDRIVE file, the name of a built-in map, or a Lanelet2 file (for Aisan)")
    command.add_argument("-o", "--output", type=Path, required=True, help="a file that ends in .osm, or a folder")
    command.add_argument(
        "--transverse-mercator",
        action="store_true",
        help="let map_projector_info.yaml name the map's own projection instead of Local",
    )
    add_choices(command)


def add_choices(command: argparse.ArgumentParser) -> None:
    """Add what a user can choose of a Lanelet2 map."""
    command.add_argument(
        "--stops", type=Path, metavar="FILE", help="a route file; its stops become bus stops (default: Linden's own)"
    )
    command.add_argument(
        "--walkways", action="store_true", help="write sidewalks as lanelets too; Autoware takes these for crossings"
    )
    command.add_argument(
        "--format", type=int, choices=[1, 2], default=1, help="of Autoware's Lanelet2; 2 has roundabouts (default: 1)"
    )
    command.add_argument(
        "--pairwise-priority",
        action="store_true",
        help="name every way that yields to another, also where other ways do not",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the map in the format that the output's name asks for."""
    started = time.perf_counter()
    if arguments.output.suffix == ".osm":
        _to_lanelet2(arguments)
    elif arguments.output.suffix:
        raise UserError(f"{arguments.output} is neither a .osm file nor a folder; name one of these")
    else:
        _to_aisan(arguments)
    _say(f"{time.perf_counter() - started:.1f} s")
    return 0


def _to_lanelet2(arguments: argparse.Namespace) -> None:
    from linden.authoring.lanelet2.convert import convert  # noqa: PLC0415 - `linden --help` does not pay for it
    from linden.authoring.lanelet2.osm import osm_bytes, projector_info  # noqa: PLC0415 - see above
    from linden.authoring.output import write_file  # noqa: PLC0415 - see above

    opendrive = opendrive_of(arguments.file)
    converted = written_of(convert(opendrive, wanted_of(arguments, opendrive)), arguments)
    info = projector_info(converted.lanelet_map, transverse_mercator=arguments.transverse_mercator)
    write_file(arguments.output, osm_bytes(converted.lanelet_map))
    write_file(arguments.output.with_name(_PROJECTOR), info)
    report(arguments.output, converted)


def wanted_of(arguments: argparse.Namespace, opendrive: "OpenDrive") -> "Wanted":
    """Return what the arguments ask for of a map.

    Raises:
        UserError: the file of stops cannot be read.
    """
    from linden.authoring.lanelet2.bus_stops import Stop, shuttle_stops  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.convert import Wanted  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.sumo.bus_stops import read_stops  # noqa: PLC0415 - see `_to_lanelet2`

    stops: tuple[Stop, ...] = ()
    if arguments.stops is not None:
        stops = tuple(Stop(one.id, one.name, one.x_m, -one.y_m) for one in read_stops(arguments.stops))
    elif is_built_in(arguments.file):
        stops = shuttle_stops(opendrive.geo_origin)
    return Wanted(arguments.pairwise_priority, arguments.format == 2, stops)


def written_of(converted: "Converted", arguments: argparse.Namespace) -> "Converted":
    """Return what is written of a map: without sidewalks, if they are not wanted."""
    from linden.authoring.lanelet2.model import without_lanelets  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.stretches import WALKWAY  # noqa: PLC0415 - see `_to_lanelet2`

    if arguments.walkways:
        return converted
    return converted._replace(lanelet_map=without_lanelets(converted.lanelet_map, WALKWAY))


def lanelets_of(name: str) -> "LaneletMap":
    """Return the Lanelet2 map of a .osm file, or of an OpenDRIVE file or built-in map."""
    if Path(name).suffix == ".osm":
        from linden.authoring.lanelet2.osm import read_osm  # noqa: PLC0415 - see `_to_lanelet2`

        return read_osm(bytes_of(Path(name)), name)
    from linden.authoring.lanelet2.convert import convert  # noqa: PLC0415 - see `_to_lanelet2`

    return convert(opendrive_of(name)).lanelet_map


def _to_aisan(arguments: argparse.Namespace) -> None:
    from linden.authoring.aisan.convert import convert  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.aisan.reading import complaints, read_folder  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.output import write_folder  # noqa: PLC0415 - see `_to_lanelet2`

    if arguments.transverse_mercator:
        raise UserError("an Aisan vector map has no map_projector_info.yaml; leave --transverse-mercator out")
    if arguments.walkways or arguments.stops is not None or arguments.format != 1 or arguments.pairwise_priority:
        raise UserError("--walkways, --stops, --format and --pairwise-priority are for Lanelet2; leave them out")
    vectors = convert(lanelets_of(arguments.file))
    write_folder(arguments.output, vectors.tables.files())
    for name, rows in vectors.tables.rows.items():
        if rows:
            _say(f"{len(rows):8,} {name}.csv")
    if vectors.lost_links:
        _say(f"{vectors.lost_links} links are lost: a row has room for four before and four after it")
    if vectors.without_limit:
        _say(f"{vectors.without_limit} lanelets have no speed limit: 50 km/h is assumed")
    found = complaints(read_folder(arguments.output))
    for line in found:
        _say(f"error {line}")
    _say(f"{arguments.output}: read back by the rules of Autoware's nodes, {len(found)} complaints")


def report(path: Path, converted: "Converted") -> None:
    """Print what a Lanelet2 map has, what was left out, and what was assumed."""
    from linden.authoring.lanelet2.bounds import STATED_ERROR_M  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.convert import UNKNOWN_SPEED_KMH, counts  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.shared import NEAR_M  # noqa: PLC0415 - see `_to_lanelet2`

    lanelet_map = converted.lanelet_map
    _say(
        f"{path}: {len(lanelet_map.nodes):,} nodes, {len(lanelet_map.ways):,} ways, "
        f"{len(lanelet_map.relations):,} relations; bounds within {100 * STATED_ERROR_M:g} cm of the OpenDRIVE curves"
    )
    if converted.shared:
        _say(
            f"{len(converted.shared)} edges of ways through junctions are {len(converted.shared) // 2} shared bounds, "
            f"within {100 * NEAR_M / 2:g} cm"
        )
    for name, count in sorted(counts(lanelet_map).items()):
        _say(f"{count:8,} {name}")
    for reason, count in sorted(converted.network.left_out.items()):
        _say(f"left out: {count} {reason}")
    if not lanelet_map.geo_reference.strip():
        _say(
            "the map has no <geoReference>: its origin is written as latitude 0, longitude 0; local_x and local_y hold"
        )
    if converted.without_limit:
        _say(f"{converted.without_limit} road lanelets have no limit in the map: {UNKNOWN_SPEED_KMH:g} km/h is assumed")
    if converted.lost_links:
        _say(f"{converted.lost_links} links are lost: the lanes' ends lie too far apart; linden map check names them")
    for stop in converted.lost_stops:
        _say(f"stop {stop.id} ({stop.name}) is left out: no driving lane is near")
    if converted.signals_without_lane:
        _say(f"{converted.signals_without_lane} signs and lights speak to no driving lane, and are left out")


def check(path: Path, against: str | None) -> int:
    """Print what a Lanelet2 file lacks, by second readers; return 1 if anything."""
    from linden.authoring.lanelet2.checking import compare, reach  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.osm import read_osm  # noqa: PLC0415 - see `_to_lanelet2`
    from linden.authoring.lanelet2.second_reader import routes_of  # noqa: PLC0415 - see `_to_lanelet2`

    opendrive = None if against is None else opendrive_of(against)
    lanelet_map = read_osm(bytes_of(path), str(path), "" if opendrive is None else opendrive.geo_reference)
    routes = routes_of(lanelet_map)
    wrong = [*routes.errors, *routes.complaints]
    for line in wrong:
        _say(f"error lanelet2: {line}")
    _say(
        f"lanelet2 reads {routes.lanelets:,} lanelets; vehicles pass {len(routes.passable):,}, "
        f"{len(routes.following):,} pairs follow each other, lanes change between {len(routes.lane_changes):,}"
    )
    if opendrive is None:
        _say("not compared with an OpenDRIVE map; name it by --against")
        return 1 if wrong else 0
    lost = 0
    for row in compare(lanelet_map, opendrive):
        lost += row.is_lost
        unit = f" {row.unit}" if row.unit else ""
        before, after = (f"{value:.3f}" if row.unit else f"{value:.0f}" for value in (row.before, row.after))
        _say(f"{row.name:28} OpenDRIVE {before}{unit}, Lanelet2 {after}{unit}{'  LOST' if row.is_lost else ''}")
    pairs = reach(opendrive, routes)
    _say(f"{pairs.both:,} pairs of driving lanes lead into each other in both maps")
    for name, found in (("missing", pairs.missing), ("added", pairs.added)):
        for pair in found:
            _say(f"error {name}: {pair}")
    return 1 if wrong or pairs.missing or pairs.added or lost else 0


def check_folder(path: Path) -> int:
    """Print what Autoware's nodes would stumble over in an Aisan folder; return 1 if anything."""
    from linden.authoring.aisan.reading import complaints, read_folder  # noqa: PLC0415 - see `_to_lanelet2`

    folder = read_folder(path)
    found = complaints(folder)
    for line in found:
        _say(f"error {line}")
    _say(f"{path}: {len(folder['lane']):,} rows of lanes in {len(folder)} files, {len(found)} complaints")
    return 1 if found else 0


def drawing(arguments: argparse.Namespace) -> str | None:
    """Return the drawing of a Lanelet2 file or an Aisan folder, None for anything else."""
    path = Path(arguments.file)
    is_lanelet2 = path.suffix == ".osm"
    if not is_lanelet2 and not path.is_dir():
        if arguments.over or arguments.window:
            raise UserError("--over and --window are for Lanelet2 and Aisan maps; name a .osm file or a folder")
        return None
    from linden.authoring.drawing.vector_maps import Window, aisan_svg, lanelet2_svg  # noqa: PLC0415 - see above

    under = None if arguments.over is None else opendrive_of(arguments.over)
    window = None if arguments.window is None else Window(*arguments.window)
    if is_lanelet2:
        return lanelet2_svg(lanelets_of(arguments.file), under, window)
    from linden.authoring.aisan.reading import read_folder  # noqa: PLC0415 - see above

    return aisan_svg(read_folder(path), under, window)


def _say(line: str) -> None:
    print(line)  # noqa: T201 - what a command says to its user
