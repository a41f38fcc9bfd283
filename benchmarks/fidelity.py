"""How far our vehicles are from CARLA's: its own recordings replayed here with the recorded pedals and steering.

    python benchmarks/fidelity.py FOLDER [--picture FILE]

FOLDER holds CARLA recorder logs (*.log) with additional data. Every half second of each vehicle's drive, the same
vehicle starts here from the recorded moment and gets the recorded controls frame by frame. The table tells how far
speed and place are off after 1, 5 and 10 s; what docs/explanation/fidelity.md says of it was made by this command.
"""

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fidelity_pictures import draw
from fidelity_replay import HORIZONS_S, Run, last_frame, moments, replay, starts
from fidelity_tracks import F64, Track, read_tracks


class Errors(NamedTuple):
    """Of one horizon, one entry a window; here less recorded."""

    speed_mps: F64
    along_m: F64  # of the recorded heading
    across_m: F64  # to its right
    yaw_rad: F64
    held_m: F64  # place error of a vehicle that holds speed and heading: what knowing nothing would give

    @property
    def place_m(self) -> F64:
        return np.hypot(self.along_m, self.across_m)


def compare(track: Track, runs: list[Run], horizon_s: float) -> Errors:
    """Return the errors at a horizon of all windows that reach it."""
    rows = []
    for run in runs:
        end = last_frame(track, run.start, horizon_s)
        if end is None:
            continue
        here = end - run.start
        rows.append(_error(track, run, end, here))
    return Errors(*np.array(rows).T) if rows else Errors(*np.zeros((5, 0)))


def _error(track: Track, run: Run, end: int, here: int) -> tuple[float, ...]:
    yaw_rad = track.rotation_rad[end, 2]
    off_m = run.place_m[here, :2] - track.place_m[end, :2]
    cosine, sine = np.cos(yaw_rad), np.sin(yaw_rad)
    held_m = track.place_m[run.start, :2] - track.place_m[end, :2]
    held_m = held_m + track.velocity_mps[run.start, :2] * (track.time_s[end] - track.time_s[run.start])
    turned = run.yaw_rad[here] - yaw_rad
    return (
        run.speed_mps[here] - track.speed_mps[end],
        off_m[0] * cosine + off_m[1] * sine,
        off_m[1] * cosine - off_m[0] * sine,
        (turned + np.pi) % (2.0 * np.pi) - np.pi,
        float(np.hypot(*held_m)),
    )


def drive(track: Track) -> list[Run]:
    """Replay every window as long as the track and the longest horizon let it."""
    runs, begun = [], moments(track)
    for start in starts(track):
        ends = [end for h in HORIZONS_S if (end := last_frame(track, start, h)) is not None]
        if ends:
            runs.append(replay(track, start, max(ends), begun[start]))
    return runs


def table(found: list[tuple[Track, list[Run]]]) -> str:
    """Return mean and 95th percentile of the absolute errors, a row a track and horizon, then all together."""
    lines = [
        "after s  windows   speed m/s     place m       along m       across m      yaw deg       held m",
        "                   mean   95 %   mean   95 %   mean   95 %   mean   95 %   mean   95 %   mean",
    ]
    for track, runs in found:
        lines.append(track.name)
        lines += [_line(h, compare(track, runs, h)) for h in HORIZONS_S]
    lines.append("all")
    for h in HORIZONS_S:
        parts = [compare(track, runs, h) for track, runs in found]
        lines.append(_line(h, Errors(*(np.concatenate(column) for column in zip(*parts, strict=True)))))
    return "\n".join(lines)


def _line(horizon_s: float, errors: Errors) -> str:
    if not len(errors.speed_mps):
        return f"{horizon_s:7.0f}        0"
    figures = []
    for column in (errors.speed_mps, errors.place_m, errors.along_m, errors.across_m, np.degrees(errors.yaw_rad)):
        figures += [np.abs(column).mean(), np.percentile(np.abs(column), 95.0)]
    figures.append(errors.held_m.mean())
    return f"{horizon_s:7.0f}  {len(errors.speed_mps):7d} " + " ".join(f"{figure:6.2f}" for figure in figures)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="CARLA recorder logs")
    parser.add_argument("--picture", type=Path, help="draw speeds and errors into this PNG")
    options = parser.parse_args()
    paths = sorted(options.folder.glob("*.log"))
    tracks = [track for path in paths if path.stat().st_size for track in read_tracks(path)]
    found = [(track, drive(track)) for track in tracks]
    found = [(track, runs) for track, runs in found if runs]
    if not found:
        raise SystemExit(f"{options.folder} holds no recording with a vehicle that drives")
    print(table(found))
    if options.picture:
        draw(found, options.picture)


if __name__ == "__main__":
    main()
