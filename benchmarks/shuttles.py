"""What several vehicles under test cost a step, beside one.

    python benchmarks/shuttles.py [--rounds 3] [--seconds 60] [--counts 1,2,4]

Each run drives the same route in a world of its own. The agents are `basic`, or one that works for 20 ms a step. Each
has a process of its own. A row has the wall time of a step (median of the rounds, and the range, ms) and how many times
real time the run went. The limit of two slow agents is one of them: they work at the same time.
"""

import argparse
import statistics
import tempfile
from pathlib import Path

import basu
from basu.results import RunResult

SLOW = """
import time

class Slow(AutonomousAgent):
    def setup(self): pass

    def run_step(self, sensor_data):
        until_s = time.perf_counter() + 0.02
        while time.perf_counter() < until_s:
            pass
        return carla.VehicleControl(throttle=0.3)

    def config(self): return {}
"""
HEADWAY_M = 60.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0, help="of simulated time, in each run")
    parser.add_argument("--counts", default="1,2,4", help="numbers of vehicles, with commas")
    arguments = parser.parse_args()
    counts = [int(count) for count in arguments.counts.split(",")]
    with tempfile.TemporaryDirectory() as folder, basu.open_simulator() as simulator:
        slow = Path(folder) / "slow.py"
        slow.write_text(SLOW, encoding="utf-8")
        steps_ms: dict[tuple[str, int], list[float]] = {}
        for _ in range(arguments.rounds):
            for agent in ("basic", str(slow)):
                for count in counts:
                    run = basu.run(
                        agent,
                        routes="routes/linden_short.xml",
                        simulator=simulator,
                        output=Path(folder) / "runs",
                        shuttles=count,
                        headway_m=HEADWAY_M,
                        stop_after_s=arguments.seconds,
                    )
                    assert isinstance(run, RunResult), "one route is driven once"
                    meta = run.result.meta
                    steps_ms.setdefault((agent, count), []).append(1e3 * meta["wall_s"] / meta["ticks"])
    print(f"{'agent':<8}{'vehicles':>10}{'a step, ms':>28}{'x real time':>14}{'steps beside one':>18}")
    for (agent, count), times_ms in steps_ms.items():
        middle_ms = statistics.median(times_ms)
        beside = middle_ms / statistics.median(steps_ms[agent, counts[0]])
        spread = f"{middle_ms:.2f} ({min(times_ms):.2f} to {max(times_ms):.2f})"
        print(f"{Path(agent).stem:<8}{count:>10}{spread:>28}{50.0 / middle_ms:>14.1f}{beside:>18.2f}")


if __name__ == "__main__":
    main()
