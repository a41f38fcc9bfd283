"""A series of runs killed at random moments and resumed, beside the same left alone: is anything lost or doubled?

    python benchmarks/series.py [--runs 20] [--kills 3] [--seed 1] [--steps 60]

Runs are short: an agent drives a piece of a street and ends. The series is broken off from outside, by SIGKILL and
SIGTERM in turn, at random moments of its first half, second half and so on; then it is resumed until it is whole.
"""

import argparse
import hashlib
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

AGENT = """
class Short(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > {steps}:
            raise ValueError("that was the run")
        return carla.VehicleControl(throttle=0.5)

    def config(self):
        return {{"routes": "routes/linden_short.xml"}}
"""


def command(agent: Path, output: Path, runs: int, *more: str) -> list[str]:
    basu = [sys.executable, "-c", "from basu.cli import entry_point; entry_point()"]
    return [*basu, "run", str(agent), "--repetitions", str(runs), "--series", "s", "--output", str(output), *more]


def done(folder: Path) -> int:
    path = folder / "s" / "series.json"
    return json.loads(path.read_text())["totals"]["done"] if path.exists() else 0


def broken_off(line: list[str], folder: Path, at_run: int, wait_s: float, with_signal: signal.Signals) -> int:
    """Start the series, let it come to a run, and break it off so much later; the runs that are listed then."""
    with subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while done(folder) < at_run and process.poll() is None:
            time.sleep(0.01)
        time.sleep(wait_s)
        process.send_signal(with_signal)
        process.wait()
    return done(folder)


def digests(folder: Path) -> list[str]:
    document = json.loads((folder / "s" / "series.json").read_text())
    return [
        hashlib.sha256((folder / "s" / run["folder"] / "history.parquet").read_bytes()).hexdigest()
        for run in document["runs"]
    ]


def scores(folder: Path) -> list[object]:
    document = json.loads((folder / "s" / "series.json").read_text())
    return [[run["number"], run["seed"], run["status"], run["scores"]] for run in document["runs"]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=60, help="of the agent in each run")
    options = parser.parse_args()
    dice = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as scratch:
        agent, killed, alone = Path(scratch, "short.py"), Path(scratch, "killed"), Path(scratch, "alone")
        agent.write_text(AGENT.format(steps=options.steps))
        began_s = time.monotonic()
        resume: list[str] = []
        for kill in range(options.kills):
            at_run = dice.randrange(options.runs * kill // options.kills, options.runs * (kill + 1) // options.kills)
            name = (signal.SIGKILL, signal.SIGTERM)[kill % 2]
            listed = broken_off(command(agent, killed, options.runs, *resume), killed, at_run, dice.uniform(0, 2), name)
            print(f"{name.name} after run {at_run}: {listed} runs are listed", flush=True)
            resume = ["--resume"] if (killed / "s" / "series.json").exists() else []
        last = subprocess.run(
            command(agent, killed, options.runs, *resume), capture_output=True, check=False, text=True
        )
        if done(killed) < options.runs:
            sys.exit(f"not whole: {done(killed)} of {options.runs} runs\n{last.stdout[-2000:]}\n{last.stderr[-2000:]}")
        killed_s = time.monotonic() - began_s
        print(f"whole after {killed_s:.0f} s: {done(killed)} of {options.runs} runs", flush=True)
        began_s = time.monotonic()
        subprocess.run(command(agent, alone, options.runs), capture_output=True, check=False)
        print(f"left alone: {time.monotonic() - began_s:.0f} s, {done(alone)} of {options.runs} runs")
        print("the same records, byte for byte:", digests(killed) == digests(alone))
        print("the same list of runs and scores:", scores(killed) == scores(alone))
        left = sorted(path.name for path in (killed / "s").glob(".*.part"))
        print("drafts left behind:", left or "none")
        print((killed / "s" / "series.txt").read_text())


if __name__ == "__main__":
    main()
