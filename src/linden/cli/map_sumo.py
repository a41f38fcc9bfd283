"""``linden map sumo``: a SUMO network with its demand out of an OpenDRIVE map."""

import argparse
import sys
from pathlib import Path

from linden.cli.map_source import content_of

HELP = "write a SUMO network of a map with a demand, and compare both; exit 1 where they do not fit"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map sumo``."""
    parser.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map such as Linden")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the folder to write; made where it is not")
    parser.add_argument("--hour", type=float, default=9.5, help="hour of the day that the demand fits (default: 9.5)")
    parser.add_argument("--duration", type=float, default=3600.0, metavar="S", help="of the demand (default: 3600)")
    parser.add_argument("--scale", type=float, default=1.0, help="the demand against the usual one (default: 1)")
    parser.add_argument("--seed", type=int, default=0, help="of the demand and of SUMO's drivers (default: 0)")
    parser.add_argument("--stops", type=Path, metavar="FILE", help="a route file; its stops become bus stops")
    parser.add_argument(
        "--places", type=Path, metavar="FILE", help="GeoJSON points with a kind (school, transit) (default: Linden's)"
    )
    parser.add_argument("--no-people", action="store_true", help="without people, crossings and walking areas")


def run(arguments: argparse.Namespace) -> int:
    """Write the folder, print how network and map compare; return 1 where they do not fit."""
    from linden.authoring.sumo.bus_stops import read_stops  # noqa: PLC0415 - `linden --help` does not pay for it
    from linden.authoring.sumo.check import compare  # noqa: PLC0415 - see above
    from linden.authoring.sumo.demand import Demand  # noqa: PLC0415 - see above
    from linden.authoring.sumo.folder import write_folder  # noqa: PLC0415 - see above

    stops = () if arguments.stops is None else read_stops(arguments.stops)
    demand = Demand(arguments.hour, arguments.duration, arguments.scale, arguments.seed)
    name = Path(arguments.file).name.removesuffix(".xodr")
    written = write_folder(
        content_of(arguments.file),
        name,
        arguments.output,
        demand,
        stops,
        people=not arguments.no_people,
        places=arguments.places,
    )
    compared = compare(written.converted)
    _say(f"{'':38} {'map':>8} {'network':>8}")
    for what, in_map, in_net in compared.table:
        _say(f"{what:38} {in_map:>8} {in_net:>8}")
    lost = [f"stop {stop.id} ({stop.name}): no lane for cars is near" for stop in written.lost_stops]
    for sentence in (*compared.misfits, *lost):
        _say(f"does not fit: {sentence}")
    _say(
        f"{written.config}: {written.trips} trips, {written.walks} walks, {written.riders} riders; "
        f"{len(compared.misfits) + len(lost)} misfits"
    )
    return 1 if compared.misfits or lost else 0


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
