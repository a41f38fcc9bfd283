"""What the gate costs a whole drive: processor time of all processes of ``basu run``, through the gate and ``--open``.

    python benchmarks/drive_cost.py [--turns 5] [--agent basic] [--routes routes/linden_short.xml] [--stop-after S]

Turns alternate between both ways. A row has the medians of user and system time of the command and all processes that
it started, and of the wall time; the last line has the ratio of the medians and of each pair of turns.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

WAYS = {"gate": [], "open": ["--open"]}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--agent", default="basic")
    parser.add_argument("--routes", default="routes/linden_short.xml")
    parser.add_argument("--stop-after", type=float, help="simulated time of each drive, in s; the whole route without")
    arguments = parser.parse_args()
    shortened = [] if arguments.stop_after is None else ["--stop-after", str(arguments.stop_after)]
    words = ["run", arguments.agent, "--routes", arguments.routes, *shortened]
    costs: dict[str, list[tuple[float, float]]] = {name: [] for name in WAYS}
    with tempfile.TemporaryDirectory() as output:
        drive([*words, "--output", output])  # fills the caches
        for turn in range(arguments.turns):
            for name in list(WAYS)[:: 1 if turn % 2 == 0 else -1]:
                costs[name].append(drive([*words, *WAYS[name], "--output", output]))
    print(f"{'way':<8}{'processor, s':>14}{'wall, s':>10}")
    for name, measured in costs.items():
        cpu_s, wall_s = (statistics.median(column) for column in zip(*measured, strict=True))
        print(f"{name:<8}{cpu_s:>14.2f}{wall_s:>10.2f}")
    gate, without = ([cpu_s for cpu_s, _ in costs[name]] for name in ("gate", "open"))
    ratio = statistics.median(gate) / statistics.median(without)
    pairs = ", ".join(f"{one / other:.3f}" for one, other in zip(gate, without, strict=True))
    print(f"gate / open: {ratio:.3f} of the medians; in each turn {pairs}")


def drive(words: list[str]) -> tuple[float, float]:
    """Return the processor time of a drive with all its processes, and its wall time, both in s."""
    program = "from basu.cli import entry_point; entry_point()"
    began_s = time.perf_counter()
    started = subprocess.Popen([sys.executable, "-c", program, *words], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(started.pid, 0)  # with all descendants that were waited for
    started.returncode = os.waitstatus_to_exitcode(status)
    if started.returncode not in {0, 1}:  # 1: the agent did not complete the route
        raise SystemExit(f"the drive ended with exit status {started.returncode}")
    return used.ru_utime + used.ru_stime, time.perf_counter() - began_s


if __name__ == "__main__":
    main()
