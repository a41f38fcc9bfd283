"""How long it takes to play scenarios: every case with three agents and three control drivers, and the verdicts.

``python benchmarks/scenarios.py [--agents basic,blind] [--workers N] [WHAT …]``
"""

import argparse
import contextlib
import io
import json
import statistics
import tempfile
import time
from collections import Counter
from pathlib import Path

from basu.cli import main

AGENTS = "basic,behavioral,forward,blind,creeper,standing"
AIM_S = 900.0  # all 171 cases with the six agents, on two quiet cores


def played(words: list[str], output: Path) -> tuple[dict, float]:
    """One ``basu scenario run``: its matrix and wall time."""
    began_s = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()):
        main(["scenario", "run", *words, "--output", str(output)])
    wall_s = time.perf_counter() - began_s
    return json.loads((output / "latest" / "matrix.json").read_text(encoding="utf-8")), wall_s


def table(matrix: dict, wall_s: float) -> str:
    """A row an agent, and the whole."""
    heads = (
        ("drives", 8),
        ("passed", 8),
        ("failed", 8),
        ("absent", 8),
        ("at fault", 10),
        ("simulated s", 13),
        ("median s", 10),
        ("longest s", 11),
        ("x real time", 13),
    )
    lines = [f"{'agent':<24}" + "".join(f"{head:>{width}}" for head, width in heads)]
    for agent in matrix["agents"]:
        results = [case["results"][agent] for case in matrix["cases"]]
        walls_s = [result["wall_s"] for result in results]
        simulated_s = sum(result["simulated_s"] for result in results)
        verdicts = Counter(result["verdict"] for result in results)
        at_fault = sum(collision["at_fault"] for result in results for collision in result["collisions"])
        failed = verdicts["FAILURE"] + verdicts["AGENT_FAULT"]
        lines.append(
            f"{agent:<24}{len(results):>8}{verdicts['SUCCESS']:>8}{failed:>8}{verdicts['NOT_EXERCISED']:>8}{at_fault:>10}"
            f"{simulated_s:>13.0f}{statistics.median(walls_s):>10.2f}"
            f"{max(walls_s):>11.2f}{simulated_s / sum(walls_s):>13.1f}"
        )
    drives = sum(len(case["results"]) for case in matrix["cases"])
    lines.append(
        f"\n{len(matrix['cases'])} cases, {drives} drives, {matrix['workers']} workers: {wall_s:.0f} s of wall time, "
        f"{wall_s / drives:.2f} s a drive (aim for all: {AIM_S:.0f} s)"
    )
    return "\n".join(lines)


def run() -> None:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", default=["all"])
    parser.add_argument("--agents", default=AGENTS)
    parser.add_argument("--workers", default=None)
    arguments = parser.parse_args()
    words = [*arguments.what, *(word for agent in arguments.agents.split(",") for word in ("--agent", agent))]
    if arguments.workers is not None:
        words += ["--workers", arguments.workers]
    with tempfile.TemporaryDirectory() as folder:
        print(table(*played(words, Path(folder))))


if __name__ == "__main__":
    run()
