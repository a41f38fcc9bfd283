"""The pictures of the comparison with CARLA's recordings: speed over time, and how the errors grow."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from fidelity_replay import HORIZONS_S, Run, last_frame
from fidelity_tracks import Track
from matplotlib.axes import Axes

mpl.use("Agg")
from matplotlib import pyplot as plt

RECORDED, HERE = "#444444", "#c8102e"


def draw(found: list[tuple[Track, list[Run]]], path: Path) -> None:
    """Write one picture: a row a track, its speed on the left, its place errors after each horizon on the right."""
    figure, axes = plt.subplots(len(found), 2, figsize=(9.0, 2.1 * len(found)), width_ratios=(3, 1), squeeze=False)
    for (speed, error), (track, runs) in zip(axes, found, strict=True):
        _speeds(speed, track, runs)
        _errors(error, track, runs)
    axes[-1, 0].legend(loc="upper left", fontsize=7)
    axes[-1, 0].set_xlabel("time in the recording, s")
    axes[-1, 1].set_xlabel("after, s")
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def _speeds(axes: Axes, track: Track, runs: list[Run]) -> None:
    """Draw the recorded speed, and ours from every tenth start (5 s apart) on."""
    axes.plot(track.time_s, track.speed_mps, color=RECORDED, linewidth=2.5, label="CARLA, recorded")
    for n, run in enumerate(runs[::10]):
        time_s = track.time_s[run.start : run.start + len(run.speed_mps)]
        axes.plot(time_s, run.speed_mps, color=HERE, linewidth=0.9, label="here, same pedals" if n == 0 else None)
        axes.plot(time_s[0], run.speed_mps[0], "o", color=HERE, markersize=3)
    if runs:
        axes.set_xlim(track.time_s[runs[0].start] - 1.0, track.time_s[runs[-1].start + len(runs[-1].speed_mps) - 1] + 1)
    axes.set_ylabel("speed, m/s")
    axes.set_title(track.name, fontsize=8, loc="left")


def _errors(axes: Axes, track: Track, runs: list[Run]) -> None:
    """Draw the place error of every window, m, after each horizon."""
    columns = []
    for horizon_s in HORIZONS_S:
        ends = [(run, end) for run in runs if (end := last_frame(track, run.start, horizon_s)) is not None]
        off_m = [np.hypot(*(run.place_m[end - run.start, :2] - track.place_m[end, :2])) for run, end in ends]
        columns.append(off_m)
    axes.boxplot(columns, whis=(5, 95), showfliers=False, medianprops={"color": HERE})
    axes.set_xticks(range(1, len(HORIZONS_S) + 1), [f"{horizon_s:g}" for horizon_s in HORIZONS_S])
    axes.set_ylabel("place error, m")
