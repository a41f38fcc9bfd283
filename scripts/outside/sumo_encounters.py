"""Count conflicts in SUMO's traffic on Linden's streets by its device for surrogate safety measures (SSM).

usage: sumo_encounters.py OUTPUT.toml [--hours 7 8 12 17] [--seed N] [--folder DIR]

Each hour of the day is played by SUMO alone. A conflict has a time to collision below 1.5 s (FHWA-HRT-08-051). The
file has events and vehicle miles by group of NHTSA's typology, for `basu scenario risk FOLDER --encounters FILE`.
SUMO's drivers do not crash, drift, or meet animals, and its walkers are not in the SSM device: the file leaves these
groups out.
"""

import argparse
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET  # SUMO's own files
from collections import Counter
from pathlib import Path

M_PER_MILE = 1609.344
TTC_S = 1.5
GROUP_OF_TYPE = {  # SUMO's documentation, "SSM Device", table of encounter types; of a pair the follower alone counts
    2: "rear-end",
    **dict.fromkeys((5, 6, 7, 9, 10, 11, 12, 13, 14, 15), "crossing paths"),  # merging and crossing at junctions
    **dict.fromkeys((4, 8), "lane change"),  # on adjacent lanes, merging from one
    20: "opposite direction",
}


def main() -> int:
    """Play the hours and write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", type=Path)
    parser.add_argument("--hours", type=float, nargs="+", default=[7.0, 8.0, 12.0, 17.0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="keep SUMO's files there")
    given = parser.parse_args()
    events: Counter[str] = Counter()
    way_m = 0.0
    with tempfile.TemporaryDirectory() as draft:
        for hour in given.hours:
            found, driven_m = _hour(hour, given.seed, (given.folder or Path(draft)) / f"{hour:g}")
            print(f"hour {hour:g}: {driven_m / M_PER_MILE:.0f} miles, {dict(sorted(found.items()))}")
            events, way_m = events + found, way_m + driven_m
    hours = ", ".join(f"{hour:g}" for hour in given.hours)
    lines = [f"# TTC below {TTC_S} s in SUMO's traffic, hours {hours}, seed {given.seed}"]
    for group in sorted(set(GROUP_OF_TYPE.values())):
        lines += ["", f'["{group}"]', f"events = {events[group]}", f"miles = {way_m / M_PER_MILE:.1f}"]
    given.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 0


def _hour(hour: float, seed: int, folder: Path) -> tuple[Counter[str], float]:
    """Return the conflicts of an hour by group, and the way of all vehicles in m."""
    commands = Path(sys.executable).parent
    options = ["--seed", f"{seed}", "--hour", f"{hour!r}", "--no-riders"]
    make = [str(commands / "linden"), "map", "sumo", "Linden", "-o", str(folder), *options]
    subprocess.run(make, capture_output=True, check=False)  # 1 may say that the network fits but for a lane
    config = next(path for path in folder.glob("*.sumocfg") if not path.name.endswith(".empty.sumocfg"))
    conflicts, trips = folder / "ssm.xml", folder / "trips.xml"
    device = {"probability": "1", "measures": "TTC", "thresholds": f"{TTC_S}", "file": str(conflicts), "range": "50"}
    wanted = [text for name, value in device.items() for text in (f"--device.ssm.{name}", value)]
    play = [str(commands / "sumo"), "-c", str(config), "--seed", f"{seed}", "--step-length", "0.1", "--no-step-log"]
    play += ["--tripinfo-output", str(trips), "--tripinfo-output.write-unfinished", "--end", f"{_end_s(config)}"]
    subprocess.run([*play, *wanted], capture_output=True, check=True)
    found: Counter[str] = Counter()
    for conflict in ET.parse(conflicts).getroot().iter("conflict"):
        least = conflict.find("minTTC")
        if least is not None and least.get("value") not in (None, "NA"):
            group = GROUP_OF_TYPE.get(int(least.get("type", "0")))
            if group is not None and float(least.get("value", "inf")) < TTC_S:
                found[group] += 1
    root = ET.parse(trips).getroot()
    return found, sum(float(trip.get("routeLength", 0.0)) for trip in root.iter("tripinfo"))


def _end_s(config: Path) -> float:
    """Return when to stop: an hour after the scenario begins."""
    begin = ET.parse(config).getroot().find("./time/begin")
    return 3600.0 + (0.0 if begin is None else float(begin.get("value", "0")))


if __name__ == "__main__":
    sys.exit(main())
