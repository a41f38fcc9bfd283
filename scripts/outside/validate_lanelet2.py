"""Runs tier4's autoware_lanelet2_map_validator on maps, and prints its findings by check.

``python scripts/outside/validate_lanelet2.py VALIDATOR REQUIREMENTS MAP...``: the program, its file
``autoware_requirement_set.json``, and OpenDRIVE files, names of built-in maps, or Lanelet2 files. docs/reference/
outside-programs.md says how the program was built. Exit 1 where it finds an error.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from linden_maps.cli.map_files import is_built_in
from linden_maps.cli.map_source import opendrive_of
from linden_maps.lanelet2.bus_stops import shuttle_stops
from linden_maps.lanelet2.convert import Wanted, convert
from linden_maps.lanelet2.model import without_lanelets
from linden_maps.lanelet2.osm import osm_bytes, read_osm
from linden_maps.lanelet2.projection import NOWHERE, projection_of
from linden_maps.lanelet2.stretches import WALKWAY


class Findings(NamedTuple):
    """What the validator says of one map."""

    map: str
    seconds: float
    counts: Counter[tuple[str, str]]
    """By severity and check."""
    examples: dict[tuple[str, str], str]
    """The first finding of each check."""


def main() -> int:
    """Print a table of all maps; return 1 where the validator finds an error."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("validator", type=Path)
    parser.add_argument("requirements", type=Path)
    parser.add_argument("maps", nargs="+")
    parser.add_argument("--examples", action="store_true", help="print the first finding of each check too")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="keep the maps and the validator's own reports here"
    )
    arguments = parser.parse_args()
    found = []
    for name in arguments.maps:
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) if arguments.keep is None else arguments.keep / Path(name).stem
            folder.mkdir(parents=True, exist_ok=True)
            found.append(validated(name, arguments.validator, arguments.requirements, folder))
    sys.stdout.write(table(found))
    if arguments.examples:
        for each in found:
            for (severity, check), text in sorted(each.examples.items()):
                sys.stdout.write(f"{each.map}: {severity} {check}: {text}\n")
    return int(any(severity == "Error" for each in found for severity, _ in each.counts))


def validated(name: str, validator: Path, requirements: Path, folder: Path) -> Findings:
    """Return what the validator says of one map; it reads and marks a copy in ``folder``."""
    path = folder / "lanelet2_map.osm"
    latitude_deg, longitude_deg = put_map(name, path)
    words = [validator, "-m", path, "-i", requirements, "-o", folder, "-p", "transverse_mercator"]
    words += ["--lat", str(latitude_deg), "--lon", str(longitude_deg)]
    started = time.perf_counter()
    ran = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - started
    reports = sorted(folder.glob("*.json"))
    if ran.returncode or not reports:
        raise SystemExit(f"the validator failed on {name}: {(ran.stderr or ran.stdout)[-2000:]}")
    counts: Counter[tuple[str, str]] = Counter()
    examples: dict[tuple[str, str], str] = {}
    for requirement in json.loads(reports[0].read_text("utf-8"))["requirements"]:
        for check in requirement["validators"]:
            for issue in check.get("issues", []):
                key = issue["severity"], issue["issue_code"]
                counts[key] += 1
                examples.setdefault(key, f"{issue['primitive']} {issue['id']}: {issue['message']}")
    return Findings(Path(name).stem, seconds, counts, examples)


def put_map(name: str, path: Path) -> tuple[float, float]:
    """Write the Lanelet2 file of a map, as ``linden map convert`` does; return the origin's latitude and longitude."""
    if Path(name).suffix == ".osm":
        shutil.copyfile(name, path)
        first = projection_of(read_osm(path.read_bytes(), name).geo_reference) or NOWHERE
        return first.latitude_deg, first.longitude_deg
    opendrive = opendrive_of(name)
    stops = shuttle_stops(opendrive.geo_origin) if is_built_in(name) else ()
    lanelet_map = without_lanelets(convert(opendrive, Wanted(stops=stops)).lanelet_map, WALKWAY)
    path.write_bytes(osm_bytes(lanelet_map))
    projection = projection_of(lanelet_map.geo_reference) or NOWHERE
    return projection.latitude_deg, projection.longitude_deg


def table(found: list[Findings]) -> str:
    """Return a table in Markdown: checks by row, maps by column."""
    checks = sorted({key for each in found for key in each.counts})
    lines = ["| | " + " | ".join(each.map for each in found) + " |", "|---|" + "---|" * len(found)]
    for severity in ("Error", "Warning", "info"):  # as the validator spells them
        sums = [sum(n for (kind, _), n in each.counts.items() if kind == severity) for each in found]
        lines.append(f"| {severity.lower()}s | " + " | ".join(map(str, sums)) + " |")
    lines += [
        f"| {severity.lower()} {check} | " + " | ".join(str(each.counts[severity, check]) for each in found) + " |"
        for severity, check in checks
    ]
    lines.append("| seconds | " + " | ".join(f"{each.seconds:.0f}" for each in found) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
