"""``linden map sumo``: a SUMO network with its demand out of an OpenDRIVE map."""

import argparse
from pathlib import Path

from linden_maps.cli.map_files import content_of
from linden_maps.cli.output import say
from linden_maps.sumo.bus_stops import read_stops
from linden_maps.sumo.check import compare
from linden_maps.sumo.demand import Demand
from linden_maps.sumo.folder import write_folder


def run(arguments: argparse.Namespace) -> int:
    """Write the folder, print how network and map compare; return 1 where they do not fit."""
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
        has_riders=not arguments.no_riders,
        places=arguments.places,
    )
    compared = compare(written.converted)
    say(f"{'':38} {'map':>8} {'network':>8}")
    for what, in_map, in_net in compared.table:
        say(f"{what:38} {in_map:>8} {in_net:>8}")
    lost = [f"stop {stop.id} ({stop.name}): no lane for cars is near" for stop in written.lost_stops]
    for sentence in (*compared.misfits, *lost):
        say(f"does not fit: {sentence}")
    say(
        f"{written.config}: {written.trips} trips, {written.walks} walks, {written.riders} riders; "
        f"{len(compared.misfits) + len(lost)} misfits"
    )
    return 1 if compared.misfits or lost else 0
