"""Builds every OpenStreetMap extract of a folder and prints a table of what came of each.

``python scripts/outside/build_extracts.py FOLDER``: the folder holds ``.osm`` files. Public extracts are under the ODbL
and none is in this repository; the test data of osm2streets, CommonRoad and OSMnx have some thirty. Returns 1 where an
extract neither builds nor gets a sentence.
"""

import argparse
import sys
import time
import traceback
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from fakes import asam
from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.checks.check import Severity, check
from linden_maps.openstreetmap.convert import convert
from linden_maps.streets.build import assembled
from linden_maps.streets.geojson import read
from linden_maps.streets.writing import text


def row(extract: Path) -> str:
    """Return the table's row of an extract.

    Raises:
        UserError: the extract is refused.
    """
    begun_s = time.perf_counter()
    built = assembled(read(convert(extract.read_bytes(), str(extract)).streets))
    xodr = text(built.document)
    took_s = time.perf_counter() - begun_s
    wrong = sum(one.severity is not Severity.NOTE for one in check(parse(xodr)))
    counts = len(built.document.roads), len(built.document.junctions), wrong, len(asam.issues(xodr)), len(built.over)
    return " | ".join(f"{count:,}" for count in counts) + f" | {took_s:.1f}"


def main() -> int:
    """Print the table; return 1 where an extract ended in an error that is no sentence."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    print("| extract | roads | junctions | findings | ASAM's issues | levels | s |\n|---|---|---|---|---|---|---|")
    code = 0
    for extract in sorted(parser.parse_args().folder.glob("*.osm")):
        try:
            print(f"| {extract.name} | {row(extract)} |", flush=True)
        except UserError as error:  # noqa: PERF203 - each extract by itself
            print(f"| {extract.name} | {error} |", flush=True)
        except Exception:  # noqa: BLE001 - the table goes on; the traceback stands above the row
            traceback.print_exc()
            print(f"| {extract.name} | traceback |", flush=True)
            code = 1
    return code


if __name__ == "__main__":
    sys.exit(main())
