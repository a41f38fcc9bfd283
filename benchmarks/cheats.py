"""Drives every cheat through the public commands: a table of what each tried, what came of it before, and now.

    unshare --net --map-root-user python benchmarks/cheats.py --own-network [--output DIR] [--markdown]

``OtherDoorsAllTheTime`` tries all ports of the machine, so it is left out without a network of its own. The column
"before" is what issue 24 says; a cheat without it is not named there. "As without it": the vehicle was where the
honest driver's was, in each frame. Exit status 1: a cheat won, or an honest driver beside the cheats had another drive.
"""

import argparse
import inspect
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import cheat_deeds
import cheat_drivers
import numpy as np

from basu.records.history.files import read_history

HERE = Path(__file__).parent
BASU = [str(Path(sys.executable).with_name("basu"))]
CASE, GROUP = "pedestrian_crossing_1", 12
ON_THE_ROUTE = [
    "Honest",
    "OppositeLaneAtLines",
    "FourMetresLeft",
    "FarBeside",
    "OverTheBlock",
    "RoundaboutBackwards",
    "PastTheSigns",
    "ThreeTimesTheLimit",
    "TwoPoints",
    "ByHand",
    "DiesAtOnce",
    "ReversesAlong",
    "Shuttles",
    "Circles",
    "OneWheelInLane",
    "StopsBesideTheLine",
    "Weaves",
    "SkipsTheEnd",
]
NO_CHEATS = {"Honest", "Polyline", "Deed", "OwnControl"}
NEEDS_OWN_NETWORK = {"OtherDoors", "OtherDoorsAllTheTime"}
IN_BOTH = {"Honest", "PastTheSigns", "ThreeTimesTheLimit", "ByHand", "OneWheelInLane"}
LEFT_OUT = {"ExcuseHang", "Shuttles"} | {"OtherDoors"}  # the first takes the wall time of a step limit
BEFORE = {
    "OppositeLaneAtLines": "1.000 with no stop",
    "FourMetresLeft": "0.998",
    "FarBeside": "arrived, stops served",
    "OverTheBlock": "arrived",
    "RoundTheConflict": "SUCCESS",
    "RoundaboutBackwards": "arrived",
    "PastTheSigns": "arrived, counted as passed",
    "ThreeTimesTheLimit": "one infraction",
    "TwoPoints": "COMPLETED under the official route's name",
    "OtherConditions": "its own conditions",
    "ByHand": "not shown",
    "DiesAtOnce": "0.800 shown",
    "DrivesInSetup": "27 m of travel, 160 ticks, green lights",
    "FillsTheRecord": "filled the record's rows",
    "Orphan": "drove the next agent's vehicle",
    "LimitsOthers": "killed the simulator",
    "Deletes": "deleted all earlier runs",
    "Excuse": "excused after the contact",
    "ExcuseUser": "excused",
    "ExcuseUnknown": "excused",
    "ExcuseOverflow": "excused",
    "ExcuseSubclass": "excused",
    "ExcuseKill": "BASU's failure",
    "LateImpossibleSensors": "case left out",
    "FailsInDestroy": "changed the outcome",
    "FailsInDestroyAfterAHit": "changed the outcome",
} | dict.fromkeys(
    [
        "Teleports",
        "Pushes",
        "ConstantVelocity",
        "BetterPhysics",
        "NoCollisions",
        "NoWitness",
        "BetterWeather",
        "OwnClock",
        "OwnSettings",
        "Reloads",
        "GreenLights",
        "ClearsTheRoad",
        "MovesOthers",
        "StopsOthers",
        "ABatchWithAll",
        "Records",
    ],
    "carried out, some found afterwards",
)
FAIR = {
    "ShiftsByHand": "a gear is part of a control: it yields as others do",
    "WaitsThenRuns": "waits for the walker, then drives as others do: no cheat",
}


class Row(NamedTuple):
    """What came of one cheat."""

    name: str
    drive: str
    tries: str
    before: str
    now: str
    has_won: bool


def main() -> int:
    """Drive, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, help="keep the drives here (default: a folder that is deleted)")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME")
    parser.add_argument("--own-network", action="store_true", help="this network holds nothing else")
    parser.add_argument("--markdown", action="store_true")
    arguments = parser.parse_args()
    if arguments.own_network:
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    cheats = all_cheats(has_own_network=arguments.own_network)
    chosen = [name for name in cheats if not arguments.only or name in {*arguments.only, "Honest"}]
    with tempfile.TemporaryDirectory() as short:
        output = (arguments.output or Path(short)).resolve()
        files = {name: agent_file(output / "agents", name, cheats[name]) for name in chosen}
        os.environ["CHEATS_OUTPUT"] = str(output)  # what a search of an agent's would find
        with ThreadPoolExecutor(2) as threads:
            both = [threads.submit(drive, output, files) for drive in (routes, cases)]
            rows = [row for each in both for row in each.result()]
    for title, named in (("named in issue 24", True), ("not named", False)):
        print(f"\n{title}\n")
        show([row for row in rows if bool(row.before) is named], markdown=arguments.markdown)
    winners = [f"{row.name} ({row.drive})" for row in rows if row.has_won]
    print(f"\n{len(rows)} drives of {len(files)} drivers; won: {', '.join(winners) or 'none'}")
    return 1 if winners else 0


def all_cheats(*, has_own_network: bool) -> dict[str, ModuleType]:
    """Return the module of each driver, by its name."""
    found = {
        name: module
        for module in (cheat_drivers, cheat_deeds)
        for name, value in vars(module).items()
        if inspect.isclass(value) and value.__module__ == module.__name__
    }
    dropped = (NO_CHEATS - {"Honest"}) | LEFT_OUT | (set() if has_own_network else NEEDS_OWN_NETWORK)
    return {name: module for name, module in found.items() if name not in dropped}


def agent_file(folder: Path, name: str, module: ModuleType) -> Path:
    """Write a driver as a user would give it: a file with one class."""
    folder.mkdir(parents=True, exist_ok=True)
    text = f"import sys\n\nsys.path.insert(0, {str(HERE)!r})\nimport {module.__name__} as cheats\n\n\n"
    path = folder / f"{name}.py"
    path.write_text(f"{text}class {name}(cheats.{name}):\n    pass\n", encoding="utf-8")
    return path


def command(words: Iterable[str | Path]) -> str:
    """Run a command of BASU's, and return what it said."""
    done = subprocess.run([*BASU, *map(str, words)], check=False, capture_output=True, text=True, errors="replace")
    return done.stdout + done.stderr


def routes(output: Path, files: dict[str, Path]) -> list[Row]:
    """Drive the route of ``cheats.xml`` with those that cheat on routes."""
    rows, honest = [], None
    for name in (name for name in ON_THE_ROUTE if name in files):
        folder = output / "routes" / name
        said = command(["run", files[name], "--routes", HERE / "cheats.xml", "--output", folder])
        try:
            found = json.loads((folder / "latest" / "result.json").read_text(encoding="utf-8"))
        except OSError:
            rows.append(row_of(name, "route", f"no drive: {said.strip()[-100:]}", has_won=False))
            continue
        where = poses(folder / "latest")
        honest = where if name == "Honest" else honest
        same = honest is not None and where.shape == honest.shape and bool(np.array_equal(where, honest))
        score = (found["scores"] or {}).get("driving", 0.0)
        reasons = found["reasons"] or [found["message"]]
        now = "passed" if found["passed"] else "failed"
        marks = [word for word in ("NOT COMPARABLE", "not comparable", "driven by hand", "own route") if word in said]
        now += f", {score:.3f}" + (f"; {', '.join(marks)}" if marks else "")
        now += "; as without it" if same and name != "Honest" else "" if found["passed"] else f": {reasons[0]}"
        rows.append(row_of(name, "route", now, has_won=found["passed"] is True and not same and not marks))
    return rows


def cases(output: Path, files: dict[str, Path]) -> list[Row]:
    """Play a case with all others, some agents to a command, each time with an honest driver at the end."""
    names = [name for name in files if (name not in ON_THE_ROUTE or name in IN_BOTH) and name != "Honest"]
    rows, honest = [], None
    for first in range(0, len(names), GROUP):
        group = [*names[first : first + GROUP], "Honest"]
        folder = output / f"cases-{first}"
        words = [word for name in group for word in ("--agent", str(files[name]))]
        workers = "2" if NEEDS_OWN_NETWORK & set(group) else "1"
        command(["scenario", "run", CASE, *words, "--workers", workers, "--output", folder])
        beside = poses(folder / "latest" / "Honest" / CASE)
        honest = beside if honest is None else honest
        for name in group:
            path = folder / "latest" / name / CASE
            found = json.loads((path / "result.json").read_text(encoding="utf-8"))
            where = poses(path)
            same = where.shape == honest.shape and bool(np.array_equal(where, honest))
            refused = ", ".join(f"{call} {count}" for call, count in found["meta"]["access"]["refused"].items())
            case = found["case"]
            now = case["verdict"] + ("; as without it" if same else f": {case['message']}")
            now += f"; refused: {refused}" if refused else ""
            now = f"{now}; {FAIR[name]}" if name in FAIR else now
            if name == "Honest":
                if not same:
                    rows.append(row_of(f"Honest beside {group[0]} and others", "case", now, has_won=True))
                continue
            has_won = case["verdict"] == "SUCCESS" and not same and name not in FAIR
            rows.append(row_of(name, "case", now, has_won=has_won))
    return rows


def poses(folder: Path) -> np.ndarray:
    """Return where the vehicle was in each frame, (N, 3): x and y in m, heading in rad; empty without a record."""
    try:
        frames = read_history(folder).frames
    except Exception:  # noqa: BLE001 - an agent that never drove left none
        return np.empty((0, 3))
    return np.column_stack([frames[column] for column in ("x_m", "y_m", "yaw_rad")])


def row_of(name: str, drive: str, now: str, *, has_won: bool) -> Row:
    """Return a row of the table."""
    driver = getattr(cheat_drivers, name, None) or getattr(cheat_deeds, name, None)
    tries = " ".join((inspect.getdoc(driver) or "").split()) if driver is not None else ""
    clean = "".join(letter if letter.isprintable() else "?" for letter in now.replace(str(HERE), "benchmarks"))
    return Row(name, drive, tries, BEFORE.get(name, ""), clean, has_won)


def show(rows: Sequence[Row], *, markdown: bool) -> None:
    """Print rows, the longest texts cut."""
    if markdown:
        print("| cheat | what it tries | drive | before | now |\n|---|---|---|---|---|")
    for row in rows:
        cells = [f"`{row.name}`", row.tries, row.drive, row.before or "not tried", row.now[:130].replace("|", "/")]
        print(
            f"| {' | '.join(cells)} |" if markdown else f"{row.name:<26}{row.drive:<7}{row.before:<42}{row.now[:130]}"
        )


if __name__ == "__main__":
    sys.exit(main())
