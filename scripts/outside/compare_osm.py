"""Compares the map that ``linden map build`` makes of an OpenStreetMap extract with the network of SUMO's netconvert.

``python scripts/outside/compare_osm.py EXTRACT.osm``: prints ways, lanes of each way, junctions and lights in both, and
every way that differs.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any, NamedTuple

import sumo
import sumolib

from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType
from linden_maps.checks.check import Severity, check
from linden_maps.openstreetmap.convert import convert
from linden_maps.streets.build import assembled
from linden_maps.streets.geojson import read
from linden_maps.streets.writing import text

_LEFT_OUT = "highway.footway,highway.service,highway.cycleway,highway.path,highway.steps,highway.pedestrian"


class Side(NamedTuple):
    """What one of the two made: lanes each way by way, junctions of three arms, junctions with lights."""

    lanes: dict[int, set[int]]
    junctions: int
    lights: int


def main() -> int:
    """Print the comparison; return 1 where the map has findings of its own check."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("extract", type=Path)
    arguments = parser.parse_args()
    imported = convert(arguments.extract.read_bytes(), str(arguments.extract))
    built = assembled(read(imported.streets))
    opendrive = parse(text(built.document))
    ours, theirs = side_of_map(opendrive, imported.streets), side_of_net(arguments.extract)
    say = sys.stdout.write
    say(f"{'':32} {'map':>8} {'netconvert':>11}\n")
    for name, one, other in (
        ("ways with lanes for cars", len(ours.lanes), len(theirs.lanes)),
        ("junctions of 3 arms and more", ours.junctions, theirs.junctions),
        ("junctions with lights", ours.lights, theirs.lights),
    ):
        say(f"{name:32} {one:>8} {other:>11}\n")
    same = [way for way in ours.lanes if ours.lanes[way] == theirs.lanes.get(way)]
    say(f"ways with the same lanes in both: {len(same)}\n")
    for way in sorted(ours.lanes.keys() | theirs.lanes.keys()):
        if way not in same:
            say(f"way {way}: lanes {sorted(ours.lanes.get(way, ()))} here, {sorted(theirs.lanes.get(way, ()))} there\n")
    for reason, count in sorted(imported.left_out.items()):
        say(f"left out: {count} {reason}\n" if count else "")
    kinds = Counter(thing.type for road in opendrive.roads for thing in road.objects)
    say(f"objects: {', '.join(f'{count} {kind}' for kind, count in sorted(kinds.items()))}; ")
    say(f"left out for want of room: {len(built.left_out)}\n")
    wrong = [finding for finding in check(opendrive) if finding.severity is not Severity.NOTE]
    for finding in wrong:
        say(f"{finding}\n")
    say(f"linden map check: {len(wrong)} findings\n")
    return int(bool(wrong))


def side_of_map(opendrive: OpenDrive, streets: dict[str, Any]) -> Side:
    """Return what the map has."""
    ways = {
        f["properties"]["id"]: f["properties"]["osm_ways"] for f in streets["features"] if "osm_ways" in f["properties"]
    }
    lanes: dict[int, set[int]] = defaultdict(set)
    for road in opendrive.roads:
        street = dict(road.user_data).get("street")
        if street is None or road.is_in_junction:
            continue
        driving = [lane.id for lane in road.sections[0].lanes if lane.type == LaneType.DRIVING]
        for way in ways[street]:
            lanes[way] |= {sum(number < 0 for number in driving), sum(number > 0 for number in driving)} - {0}
    arms = [{connection.incoming_road for connection in junction.connections} for junction in opendrive.junctions]
    lights = sum(bool(junction.controllers) for junction in opendrive.junctions)
    return Side(dict(lanes), sum(len(roads) > 2 for roads in arms), lights)


def side_of_net(extract: Path) -> Side:
    """Return what netconvert makes of the extract."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(Path(sumo.SUMO_HOME) / "bin" / "netconvert"), "--osm-files", str(extract.resolve())]
        command += ["-o", "net.xml", "--no-turnarounds", "--remove-edges.by-type", _LEFT_OUT]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        net = sumolib.net.readNet(str(Path(folder) / "net.xml"))
    lanes: dict[int, set[int]] = defaultdict(set)
    for edge in net.getEdges():
        found = re.fullmatch(r"-?(\d+)(?:#\d+)?", edge.getID())
        if found is not None:
            lanes[int(found[1])].add(sum(lane.allows("passenger") for lane in edge.getLanes()))
    many = [
        node
        for node in net.getNodes()
        if len({edge.getID().lstrip("-") for edge in (*node.getIncoming(), *node.getOutgoing())}) > 2
    ]
    return Side(dict(lanes), len(many), sum("traffic_light" in node.getType() for node in net.getNodes()))


if __name__ == "__main__":
    sys.exit(main())
