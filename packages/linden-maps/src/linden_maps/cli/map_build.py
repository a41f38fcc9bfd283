"""``linden map build``: streets (GeoJSON), or an OpenStreetMap extract, to OpenDRIVE."""

import argparse
import difflib
import json
from collections import Counter
from collections.abc import Collection, Iterable
from importlib import resources
from pathlib import Path
from typing import Any

from linden.errors import UserError
from linden_maps.cli.map_files import bytes_of
from linden_maps.cli.output import say
from linden_maps.openstreetmap.convert import Imported, convert
from linden_maps.output import write_output
from linden_maps.streets.build import Built, assembled, off_ground_m
from linden_maps.streets.controls import without_lights
from linden_maps.streets.geojson import read
from linden_maps.streets.levels import LEVEL_M
from linden_maps.streets.routes import xml
from linden_maps.streets.terrain import with_terrain
from linden_maps.streets.writing import text as written

_HOME_STREETS = "linden.geojson"


def run(arguments: argparse.Namespace) -> int:
    """Write the OpenDRIVE map of a file of streets, and the route files that are wanted."""
    source: Path | None = arguments.streets
    imported = convert(bytes_of(source), str(source)) if source is not None and source.suffix == ".osm" else None
    if arguments.facts is not None and imported is None:
        raise UserError("--facts writes the streets of an OpenStreetMap extract; name a .osm file, or leave it out")
    facts = read(_streets(source) if imported is None else imported.streets)
    facts = without_lights(facts) if arguments.without_lights else facts
    built = assembled(facts if arguments.elevation is None else with_terrain(facts, arguments.elevation))
    wanted = [_route_and_file(given, built.facts.routes) for given in arguments.route]
    files = [(arguments.output, written(built.document))]
    files += [(file, xml(built, built.facts.routes[name], number)) for number, (name, file) in enumerate(wanted)]
    if imported is not None and arguments.facts is not None:
        files.append((arguments.facts, (json.dumps(imported.streets, indent=1) + "\n").encode()))
    for file, data in files:
        write_output(file, data)
        say(f"{file}: {len(data):,} bytes")
    if imported is not None:
        _report(imported)
    if arguments.elevation is not None:
        away_m, near_m = off_ground_m(built)
        say(f"off the ground: {away_m:.2f} m at most, {near_m:.2f} m beside junctions")
    _report_simplified(built)
    unwritten = [name for name in built.facts.routes if name not in {name for name, _ in wanted}]
    if unwritten and source is not None:
        say(f"not written: {', '.join(unwritten)}; `--route {unwritten[0]}=FILE.xml` writes a route feature")
    return 0


def _report(imported: Imported) -> None:
    """Print what the extract says, what is guessed, and what is left out."""
    kinds = Counter(feature["properties"]["feature"] for feature in imported.streets["features"])
    say(", ".join(f"{count:,} {kind}" for kind, count in sorted(kinds.items())))
    for fact in sorted(imported.known.keys() | imported.guessed.keys()):
        say(f"{fact:24} {imported.known[fact]:6,} tagged {imported.guessed[fact]:6,} guessed")
    for reason, count in sorted(imported.left_out.items()):
        if count:
            say(f"left out: {count:,} {reason}")


def _report_simplified(built: Built) -> None:
    """Print what is built otherwise than the streets' file says, with counts and the first ids."""
    if built.left_out:
        say(f"left out: {len(built.left_out)} buildings or things that would stand on a street")
    if built.simplified:
        say(f"built as plain junctions: {len(built.simplified)} roundabouts without room: {_first(built.simplified)}")
    if built.over:
        pairs = _first(map(" / ".join, built.over))
        say(f"{len(built.over)} crossings at different levels, {LEVEL_M:g} m a level: {pairs}")
    if built.through:
        pairs = _first(map(" / ".join, built.through))
        say(f"{len(built.through)} crossings at one height without a common point, where traffic meets unseen: {pairs}")


def _first(names: Iterable[str]) -> str:
    """Return the first five names, and how many follow."""
    known = list(names)
    return ", ".join(known[:5]) + (f" and {len(known) - 5} more" if len(known) > 5 else "")


def _route_and_file(given: str, known: Collection[str]) -> tuple[str, Path]:
    """The route feature and the file of ``NAME=FILE``."""
    name, sign, file = given.partition("=")
    if not (name and sign and file):
        raise UserError(f"--route {given}: give the name of a route feature and a file, such as --route loop=loop.xml")
    if name not in known:
        close = difflib.get_close_matches(name, known, 1)
        there = f"it has {', '.join(known)}" if known else "it has none"
        raise UserError(f"the streets have no route '{name}'; {f'did you mean {close[0]!r}?' if close else there}")
    return name, Path(file)


def _streets(path: Path | None) -> dict[str, Any]:
    data = (resources.files("linden") / "data" / _HOME_STREETS).read_bytes() if path is None else bytes_of(path)
    try:
        streets = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise UserError(f"{path} is no GeoJSON: {error}") from None
    if not isinstance(streets, dict):
        raise UserError(f"{path} is no GeoJSON: it should be an object of type FeatureCollection")
    return streets
