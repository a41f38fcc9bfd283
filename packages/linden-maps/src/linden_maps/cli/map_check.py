"""``linden map check``: what second readers find wrong with an OpenDRIVE, Lanelet2 or Aisan map."""

import argparse
from pathlib import Path

from linden_maps.aisan.reading import complaints, read_folder
from linden_maps.checks.check import Severity
from linden_maps.checks.check import check as findings_of
from linden_maps.cli.map_files import bytes_of
from linden_maps.cli.map_source import opendrive_of
from linden_maps.cli.output import number, say
from linden_maps.lanelet2.checking import compare, reach
from linden_maps.lanelet2.osm import read_osm
from linden_maps.lanelet2.second_reader import routes_of


def run(arguments: argparse.Namespace) -> int:
    """Print the findings, one a line, and a summary; return 1 if there are any."""
    if Path(arguments.file).suffix == ".osm":
        return _check_lanelet2(Path(arguments.file), arguments.against)
    if Path(arguments.file).is_dir():
        return _check_folder(Path(arguments.file))
    findings = findings_of(opendrive_of(arguments.file))
    wrong = [finding for finding in findings if finding.severity is not Severity.NOTE]
    for finding in findings if arguments.notes else wrong:
        say(str(finding))
    notes = len(findings) - len(wrong)
    told = "" if arguments.notes or not notes else "; --notes tells them"
    say(f"{arguments.file}: {number(len(wrong), 'finding')}, {number(notes, 'note')}{told}")
    return 1 if wrong else 0


def _check_lanelet2(path: Path, against: str | None) -> int:
    """Print what a Lanelet2 file lacks, by second readers; return 1 if anything."""
    opendrive = None if against is None else opendrive_of(against)
    lanelet_map = read_osm(bytes_of(path), str(path), "" if opendrive is None else opendrive.geo_reference)
    routes = routes_of(lanelet_map)
    wrong = [*routes.errors, *routes.complaints]
    for line in wrong:
        say(f"error lanelet2: {line}")
    say(
        f"lanelet2 reads {routes.lanelets:,} lanelets; vehicles pass {len(routes.passable):,}, "
        f"{len(routes.following):,} pairs follow each other, lanes change between {len(routes.lane_changes):,}"
    )
    if opendrive is None:
        say("not compared with an OpenDRIVE map; name it by --against")
        return 1 if wrong else 0
    lost = 0
    for row in compare(lanelet_map, opendrive):
        lost += row.is_lost
        unit = f" {row.unit}" if row.unit else ""
        before, after = (f"{value:.3f}" if row.unit else f"{value:.0f}" for value in (row.before, row.after))
        say(f"{row.name:28} OpenDRIVE {before}{unit}, Lanelet2 {after}{unit}{'  LOST' if row.is_lost else ''}")
    pairs = reach(opendrive, routes)
    say(f"{pairs.both:,} pairs of driving lanes lead into each other in both maps")
    for name, found in (("missing", pairs.missing), ("added", pairs.added)):
        for pair in found:
            say(f"error {name}: {pair}")
    return 1 if wrong or pairs.missing or pairs.added or lost else 0


def _check_folder(path: Path) -> int:
    """Print what Autoware's nodes would stumble over in an Aisan folder; return 1 if anything."""
    folder = read_folder(path)
    found = complaints(folder)
    for line in found:
        say(f"error {line}")
    say(f"{path}: {len(folder['lane']):,} rows of lanes in {len(folder)} files, {len(found)} complaints")
    return 1 if found else 0
