"""One run of all cases and all suites with three agents: passed cases, requirements met, wall and processor time.

``python benchmarks/everything.py [--agents basic,behavioral,blind] [--workers N] [--output DIR] [WHAT …]``
``python benchmarks/everything.py --resume FOLDER`` continues a run that was broken off.
``python benchmarks/everything.py --table FOLDER`` prints the table of a run again.

It is one ``basu scenario run``, so a case that several suites have is played once. The wall time of a row is the sum
over its drives, and a drive counts in each row that has its case. The processor time is that of all processes.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from basu.output.report.scenarios.suite_answers import answered, read_suites
from basu.scenarios.cases import ALL, cases_of
from basu.scenarios.suites.suite import suite_names

AGENTS = "basic,behavioral,blind"
CALLS = "everything.json"  # in the folder of the run: what each call cost
TIMEOUT_S, STEP_LIMIT_S = "180", "60"  # a busy machine is no fault of the simulator or of an agent


class Call(NamedTuple):
    """What one call of this program cost."""

    wall_s: float
    processor_s: float
    load_before: float  # of one minute
    load_after: float
    processors: int


def play(words: list[str], output: Path) -> tuple[Path, Call]:
    """Run ``basu scenario run`` and return the folder of the run and its cost."""
    load, began_s, before_s = os.getloadavg()[0], time.perf_counter(), processor_s()
    code = "import sys; from basu.cli import entry_point; sys.exit(entry_point())"
    subprocess.run([sys.executable, "-c", code, "scenario", "run", *words], check=False)
    wall_s, used_s = time.perf_counter() - began_s, processor_s() - before_s
    folder = Path(words[1]) if words[0] == "--resume" else output / "latest"
    return folder.resolve(), Call(wall_s, used_s, load, os.getloadavg()[0], os.cpu_count() or 1)


def processor_s() -> float:
    """Return the processor time in s of all processes that this one started and that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rows(folder: Path, matrix: dict) -> list[tuple[str, ...]]:
    """Return a row for each agent and word: word, agent, cases, passed, not judged, requirements met, wall time."""
    suites = {each["name"]: answered(folder, each, matrix) for each in read_suites(folder)}
    found = []
    for word in (ALL, *suites):
        names = {playable.case.name for playable in cases_of([word])}
        cases = [case for case in matrix["cases"] if case["id"] in names]
        for agent in matrix["agents"]:
            results = [case["results"][agent] for case in cases if agent in case["results"]]
            verdicts = [result["verdict"] for result in results]
            judged = sum(verdict in {"SUCCESS", "FAILURE", "AGENT_FAULT"} for verdict in verdicts)
            met = "{} of {}".format(*suites[word].met(agent)) if word in suites else ""
            wall_s = f"{sum(result['wall_s'] for result in results):.0f}"
            passed = str(verdicts.count("SUCCESS"))
            found.append((word, agent, f"{len(results)} of {len(names)}", passed, str(judged), met, wall_s))
    return found


def table(folder: Path) -> str:
    """Return the table of a run as Markdown, with the cost of each call."""
    matrix = json.loads((folder / "matrix.json").read_text(encoding="utf-8"))
    lines = ["| suite | agent | cases played | passed | judged | requirements met | wall time of its drives, s |"]
    lines += ["|---|---|---|---|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows(folder, matrix))]
    drives = [result for case in matrix["cases"] for result in case["results"].values()]
    simulated_s = sum(result["simulated_s"] for result in drives)
    lines.append(f"\n{len(matrix['cases'])} cases, {len(drives)} drives, {simulated_s:.0f} s simulated")
    calls = folder / CALLS
    for call in json.loads(calls.read_text(encoding="utf-8")) if calls.is_file() else []:
        lines.append(
            "{:.0f} s of wall time, {:.0f} s of processor time; load {:.1f} before, {:.1f} after, "
            "on {} processors".format(*call)
        )
    return "\n".join(lines)


def main() -> int:
    """Play everything, or a part, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", default=[ALL, *suite_names()])
    parser.add_argument("--agents", default=AGENTS)
    parser.add_argument("--workers", default=None)
    parser.add_argument("--output", type=Path, default=Path("scenario-runs"))
    parser.add_argument("--resume", type=Path, metavar="FOLDER")
    parser.add_argument("--table", type=Path, metavar="FOLDER")
    arguments = parser.parse_args()
    if arguments.table is not None:
        print(table(arguments.table.resolve()))
        return 0
    if arguments.resume is not None:
        words = ["--resume", str(arguments.resume)]
    else:
        words = [*arguments.what, *(word for agent in arguments.agents.split(",") for word in ("--agent", agent))]
        words += ["--output", str(arguments.output), "--timeout", TIMEOUT_S, "--step-limit", STEP_LIMIT_S]
        words += ["--workers", arguments.workers] if arguments.workers else []
    folder, call = play(words, arguments.output)
    calls = folder / CALLS
    earlier = json.loads(calls.read_text(encoding="utf-8")) if calls.is_file() else []
    calls.write_text(json.dumps([*earlier, call], indent=2), encoding="utf-8")
    print(table(folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
