"""Shows a run again from its folder: history, facts and, where it was kept, the map; no simulator is asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.history.files import read_history
from basu.metrics.score import Scoring, infractions, score
from basu.recording.sources import MAP_FILE, read_map
from basu.viewer import moment, scenery
from basu.viewer.frames import Pose
from basu.viewer.stream import close_stream, open_stream

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy as np

    from basu.history import History

XYZ = "xyz"


def show_run(folder: Path, rrd: Path, scoring: Scoring, *, screen: bool, on_tick: Callable[[int], object]) -> str:
    """Show a run's folder, keep it in ``rrd``; says where it was shown.

    Raises:
        UserError: Rerun is missing, or the folder has no record.
    """
    history = read_history(folder)
    stream = open_stream(rrd, folder.name, screen=screen)
    recording = stream.recording
    if (folder / MAP_FILE).is_file():
        scenery.log_map(recording, read_map(folder / MAP_FILE, history.facts.route.town))
    scenery.log_route(recording, history.facts.route)
    scenery.log_vehicle(recording, history.facts.vehicle)
    shower = moment.Shower(recording)
    others = _others(history)
    for tick, row in enumerate(history.frames):
        shower.tick(float(row["t_s"]), _pose(row), _driving(row), others.get(tick, ()))
        on_tick(1)
    shower.scores(score(history, scoring))
    shower.infractions(infractions(history, scoring))
    close_stream(stream)
    return stream.said


def _pose(row: np.void) -> Pose:
    return Pose(*(float(row[name]) for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")))


def _driving(row: np.void) -> moment.Driving:
    velocity = [float(row[f"velocity_{axis}_mps"]) for axis in XYZ]
    acceleration = [float(row[f"acceleration_{axis}_mps2"]) for axis in XYZ]
    return moment.Driving(
        (velocity[0], velocity[1], velocity[2]),
        (acceleration[0], acceleration[1], acceleration[2]),
        *(float(row[name]) for name in ("speed_limit_mps", "throttle", "steer", "brake")),
    )


def _others(history: History) -> dict[int, list[moment.Other]]:
    """Who was near, by tick."""
    facts = history.facts
    found: dict[int, list[moment.Other]] = {}
    for row in history.others:
        actor = int(row["id"])
        x_m, y_m, z_m, yaw_rad = (float(row[name]) for name in ("x_m", "y_m", "z_m", "yaw_rad"))
        found.setdefault(int(row["tick"]), []).append(
            moment.Other(actor, facts.actor_types[actor], x_m, y_m, z_m, yaw_rad, facts.actor_sizes.get(actor))
        )
    return found
