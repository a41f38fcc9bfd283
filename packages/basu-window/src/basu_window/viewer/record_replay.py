"""Shows a finished run in Rerun from its folder, without a simulator."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from basu.metrics.incremental import SoFar
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring
from basu.records.history.files import read_history
from basu.records.recording_files import MAP_FILE, read_map
from basu_window.viewer import entities
from basu_window.viewer.entities import log_map, log_route, log_vehicle
from basu_window.viewer.layout import Parts, Pose
from basu_window.viewer.stream import close_stream, open_stream

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import numpy as np

    from basu.records.history import History


XYZ = "xyz"
SCORE_EVERY_S = 1.0  # of simulated time


def show_run(
    folder: Path,
    map_file: Path | None,
    rrd: Path,
    scoring: Scoring,
    *,
    screen: bool,
    on_tick: Callable[[int], object],
) -> str:
    """Show a run's folder, keep it in ``rrd``; ``map_file`` goes before the map in it. Says where it was shown.

    Raises:
        UserError: the folder has no record.
    """
    history = read_history(folder)
    kept = folder / MAP_FILE
    chosen = map_file or (kept if kept.is_file() else None)
    town = None if chosen is None else read_map(chosen, history.facts.route.town)
    parts = Parts(_pose(history.frames[0]), cameras=False, judged=True)
    stream = open_stream(rrd, folder.resolve().name, parts, screen=screen)
    recording = stream.recording
    if town is not None:
        log_map(recording, town)
    log_route(recording, history.facts.route)
    log_vehicle(recording, history.facts.vehicle)
    shower = entities.TickLogger(recording)
    others = _others(history)
    so_far, every = SoFar(scoring), max(1, round(SCORE_EVERY_S / history.facts.step_s))
    for tick, row in enumerate(history.frames):
        shower.tick(float(row["t_s"]), _pose(row), _driving(row), others.get(tick, ()))
        if tick % every == 0:
            so_far.advance(partial(history.window, end=tick + 1))
            shower.scores(so_far.scores)
            shower.infractions(so_far.infractions)
        on_tick(1)
    shower.scores(score(history, scoring))
    shower.infractions(infractions(history, scoring))
    close_stream(stream)
    return stream.said


def _pose(row: np.void) -> Pose:
    return Pose(*(float(row[name]) for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")))


def _driving(row: np.void) -> entities.Driving:
    velocity = [float(row[f"velocity_{axis}_mps"]) for axis in XYZ]
    acceleration = [float(row[f"acceleration_{axis}_mps2"]) for axis in XYZ]
    return entities.Driving(
        (velocity[0], velocity[1], velocity[2]),
        (acceleration[0], acceleration[1], acceleration[2]),
        *(float(row[name]) for name in ("speed_limit_mps", "throttle", "steer", "brake")),
    )


def _others(history: History) -> dict[int, list[entities.Other]]:
    """Return the actors nearby, by tick."""
    facts = history.facts
    found: dict[int, list[entities.Other]] = {}
    for row in history.others:
        actor = int(row["id"])
        x_m, y_m, z_m, yaw_rad = (float(row[name]) for name in ("x_m", "y_m", "z_m", "yaw_rad"))
        found.setdefault(int(row["tick"]), []).append(
            entities.Other(actor, facts.actor_types[actor], x_m, y_m, z_m, yaw_rad, facts.actor_sizes.get(actor))
        )
    return found
