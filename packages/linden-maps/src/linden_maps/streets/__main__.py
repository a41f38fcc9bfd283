"""``python -m linden_maps.streets``: build a street file's map and its route files, as they are shipped.

``linden map build`` writes a map alone; this writes the routes as well, because both must come from the same streets.
"""

import argparse
import json
from pathlib import Path

from linden_maps.streets.build import assembled
from linden_maps.streets.controls import without_lights
from linden_maps.streets.geojson import read
from linden_maps.streets.routes import xml
from linden_maps.streets.writing import text


def main() -> None:
    """Write the map and the routes named on the command line, as ROUTE=FILE."""
    parser = argparse.ArgumentParser(prog="python -m linden_maps.streets", description=__doc__)
    parser.add_argument("streets", type=Path, help="GeoJSON file (docs/reference/maps.md)")
    parser.add_argument("-o", "--output", type=Path, required=True, help="OpenDRIVE file to write")
    parser.add_argument("--route", action="append", default=[], metavar="ROUTE=FILE", help="a route's id, and its file")
    parser.add_argument("--without-lights", action="store_true", help="put all-way stops in place of lights")
    arguments = parser.parse_args()
    facts = read(json.loads(arguments.streets.read_text(encoding="utf-8")))
    built = assembled(without_lights(facts) if arguments.without_lights else facts)
    arguments.output.write_bytes(text(built.document))
    for number, (route, path) in enumerate(pair.split("=", 1) for pair in arguments.route):
        Path(path).write_bytes(xml(built, built.facts.routes[route], number))


if __name__ == "__main__":
    main()
