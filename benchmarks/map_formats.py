"""Lanelet2 and Aisan maps of towns: seconds and memory of one process each, what they hold, and how exact they are.

    python benchmarks/map_formats.py Linden path/to/Town01.xodr ...
    python benchmarks/map_formats.py --validator PROGRAM REQUIREMENTS --commonroad PYTHON Linden ...

``--validator`` adds findings of tier4's map validator (docs/reference/outside-programs.md), ``--commonroad`` the same
figures of CommonRoad's converter, which runs in the Python that is named.

Seconds are those of the processor, from the file's text to the bytes to be written. ``wall`` is by the clock.
"""

import argparse
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from linden.maps.opendrive.parse import parse
from linden_maps.aisan.convert import convert as aisan_of
from linden_maps.aisan.reading import complaints, read_folder
from linden_maps.cli.map_files import content_of
from linden_maps.lanelet2.checking import compare, reach, worst_error_m
from linden_maps.lanelet2.convert import convert
from linden_maps.lanelet2.osm import osm_bytes
from linden_maps.lanelet2.second_reader import routes_of
from linden_maps.output import write_folder

ROWS = (
    ("parse", "s"),
    ("lanelet2", "s"),
    ("aisan", "s"),
    ("wall", "s"),
    ("memory", "MB"),
    ("lanelets", ""),
    ("nodes", ""),
    ("elements", ""),
    ("osm", "MB"),
    ("rows", ""),
    ("covered", "%"),
    ("plan", "mm"),
    ("height", "mm"),
    ("shared", "mm"),
    ("load errors", ""),
    ("pairs", ""),
    ("missing", ""),
    ("added", ""),
    ("complaints", ""),
    ("validator's errors", ""),
    ("validator's warnings", ""),
    ("CommonRoad seconds", "s"),
    ("CommonRoad memory", "MB"),
    ("CommonRoad lanelets", ""),
    ("CommonRoad, validator's errors", ""),
    ("CommonRoad, validator's warnings", ""),
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="*", default=["Linden"])
    parser.add_argument("--validator", nargs=2, metavar=("PROGRAM", "REQUIREMENTS"), default=())
    parser.add_argument("--commonroad", metavar="PYTHON", help="a Python that has commonroad-scenario-designer")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measured(arguments.maps[0])))
        return
    columns = {}
    for name in arguments.maps:
        run = subprocess.run([sys.executable, __file__, "--one", name], capture_output=True, text=True, check=True)
        columns[Path(name).stem] = json.loads(run.stdout.splitlines()[-1]) | findings(arguments.validator, name)
        if arguments.commonroad:
            columns[Path(name).stem] |= peer(arguments.commonroad, arguments.validator, name)
    print("| | " + " | ".join(columns) + " |\n|---|" + "---|" * len(columns))
    found = {key for column in columns.values() for key in column}
    for key, unit in ((key, unit) for key, unit in ROWS if key in found):
        values = [column.get(key) for column in columns.values()]
        cells = " | ".join("" if value is None else f"{value:,.2f}" if unit else f"{value:,.0f}" for value in values)
        print(f"| {key}{f' ({unit})' if unit else ''} | {cells} |")


def findings(validator: tuple[str, str], name: str, before: str = "") -> dict[str, float]:
    """Return how many errors and warnings tier4's validator finds; nothing where it is not named."""
    if not validator:
        return {}
    script = Path(__file__).parents[1] / "scripts" / "outside" / "validate_lanelet2.py"
    run = subprocess.run([sys.executable, str(script), *validator, name], capture_output=True, text=True, check=False)
    if run.returncode not in {0, 1}:
        raise SystemExit(run.stderr)
    rows = dict(re.findall(r"^\| (errors|warnings) \| (\d+) \|$", run.stdout, re.MULTILINE))
    return {f"{before}validator's {key}": float(value) for key, value in rows.items()}


def peer(python: str, validator: tuple[str, str], name: str) -> dict[str, float]:
    """Return what CommonRoad's converter makes of a map; it times itself, without its imports."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "map.xodr", Path(folder) / "map.osm"
        source.write_bytes(content_of(name))
        script = Path(__file__).with_name("peer_commonroad.py")
        words = [python, str(script), str(source), str(target)]
        run = subprocess.run(words, capture_output=True, text=True, check=False)
        if run.returncode:
            sys.stderr.write(f"CommonRoad's converter failed on {name}: {run.stderr.splitlines()[-1]}\n")
            return {}
        figures = json.loads(run.stdout.splitlines()[-1])
        told = {f"CommonRoad {key}": float(value) for key, value in figures.items()}
        return told | findings(validator, str(target), "CommonRoad, ")


def measured(name: str) -> dict[str, float]:
    text, wall = content_of(name), time.perf_counter()
    marks = [time.process_time()]
    opendrive = parse(text)
    marks.append(time.process_time())
    converted = convert(opendrive)
    osm = osm_bytes(converted.lanelet_map)
    marks.append(time.process_time())
    vectors = aisan_of(converted.lanelet_map)
    files = vectors.tables.files()
    marks.append(time.process_time())
    wall = time.perf_counter() - wall
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    with tempfile.TemporaryDirectory() as folder:
        write_folder(Path(folder) / "aisan", files)
        found = complaints(read_folder(Path(folder) / "aisan"))
    routes = routes_of(converted.lanelet_map)
    pairs = reach(opendrive, routes, converted)
    driving = compare(converted.lanelet_map, opendrive)[0]
    worst = worst_error_m(opendrive, converted)
    return {
        "parse": marks[1] - marks[0],
        "lanelet2": marks[2] - marks[1],
        "aisan": marks[3] - marks[2],
        "wall": wall,
        "memory": memory,
        "lanelets": sum(1 for _ in converted.lanelet_map.lanelets()),
        "nodes": len(converted.lanelet_map.nodes),
        "elements": sum(1 for _ in converted.lanelet_map.elements()),
        "osm": len(osm) / 1e6,
        "rows": len(vectors.tables.rows["lane"]),
        "covered": 100.0 * driving.after / driving.before,
        "plan": 1000.0 * worst.plan_m,
        "height": 1000.0 * worst.height_m,
        "shared": 1000.0 * worst.shared_m,
        "load errors": len(routes.errors),
        "pairs": pairs.both,
        "missing": len(pairs.missing),
        "added": len(pairs.added),
        "complaints": len(found),
    }


if __name__ == "__main__":
    main()
