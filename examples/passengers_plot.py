"""Draws what standing passengers felt in one or more runs: `python examples/passengers_plot.py RUN … --to felt.png`.

A run's folder is all it needs. The grey bands are what volunteers answered without a step, and with one
(docs/reference/passengers.md). A time with --around draws 10 s about it.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from basu.metrics.passengers import felt
from basu.metrics.passengers.felt import GRIP_MPS2, STEP_MPS2
from basu.records.history.files import read_history


def draw(runs, to, around_s=None):
    """One row a run: speed above, acceleration along and across below."""
    figure = Figure(figsize=(10.0, 3.0 * len(runs)), layout="constrained")
    axes = figure.subplots(len(runs), 2, squeeze=False, sharex="col" if around_s is None else False)
    for (speed, push), folder in zip(axes, runs, strict=True):
        sensed = felt(read_history(folder))
        speed.plot(sensed.t_s, sensed.speed_mps, color="black")
        speed.set(title=folder.absolute().name, xlabel="t in s", ylabel="speed in m/s")
        push.axhspan(-GRIP_MPS2, GRIP_MPS2, color="0.93", label="with a step")
        push.axhspan(-STEP_MPS2, STEP_MPS2, color="0.85", label="without a step")
        push.plot(sensed.t_s, sensed.filtered_along_mps2, color="black", label="along")
        push.plot(sensed.t_s, sensed.filtered_across_mps2, color="tab:orange", linestyle="--", label="across")
        push.set(title="felt, filtered", xlabel="t in s", ylabel="m/s²", ylim=(-4.5, 4.5))
        push.legend(loc="upper right", ncols=2, fontsize=8)
        if around_s is not None:
            for axis in (speed, push):
                axis.set_xlim(around_s - 5.0, around_s + 5.0)
    with mpl.rc_context({"svg.hashsalt": "basu"}):
        figure.savefig(to, dpi=110)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="+", type=Path, metavar="RUN", help="folders of runs, such as runs/latest")
    parser.add_argument("--to", type=Path, default=Path("felt.png"), help="the picture (default: %(default)s)")
    parser.add_argument("--around", type=float, metavar="T", help="only 10 s around this time")
    arguments = parser.parse_args()
    draw(arguments.runs, arguments.to, arguments.around)
    print(f"what was felt is drawn in {arguments.to}")
