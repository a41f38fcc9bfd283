"""Shows a recorder file of CARLA's in Rerun: vehicles and walkers, the hero as the vehicle under test."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.errors import UserError
from basu_carla_log.arrays import ActorArrays, actor_arrays, locations_m
from basu_carla_log.layouts import Kind
from basu_window.viewer import entities
from basu_window.viewer.entities import log_map
from basu_window.viewer.layout import Parts, Pose
from basu_window.viewer.stream import close_stream, open_stream

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import carla

    from basu_carla_log import Log


SHOWN_TYPES = ("vehicle.*", "walker.*")
CM_PER_M = 100.0


def show_log(
    log: Log, carla_map: carla.Map | None, rrd: Path, *, screen: bool, on_tick: Callable[[int], object]
) -> str:
    """Show a recorder file, keep it in ``rrd``; says where it was shown.

    Raises:
        UserError: there is no actor to show.
    """
    actors = [actor for kind in SHOWN_TYPES for actor in log.ids_of(type_id=kind)]
    if not actors:
        raise UserError(f"{log.path} has neither vehicles nor walkers; there is nothing to show")
    hero = next(iter(log.ids_of(role_name="hero")), actors[0])
    places = locations_m(log)
    runs = {actor: actor_arrays(log, places, actor) for actor in dict.fromkeys([hero, *actors])}
    run = runs[hero]
    parts = Parts(_pose(run, 0), cameras=False, judged=False)
    stream = open_stream(rrd, log.path.stem, parts, screen=screen)
    if carla_map is not None:
        log_map(stream.recording, carla_map)
    shower = entities.TickLogger(stream.recording)
    others = _others(log, {actor: run for actor, run in runs.items() if actor != hero})
    for index, frame in enumerate(run.frame):
        shower.tick(float(run.t_s[index]), _pose(run, index), _driving(run, index), others.get(int(frame), ()))
        on_tick(1)
    close_stream(stream)
    return stream.said


def _pose(run: ActorArrays, index: int) -> Pose:
    x_m, y_m, z_m = run.location_m[index].tolist()
    roll, pitch, yaw = np.radians(run.rotation_deg[index]).tolist()
    return Pose(x_m, y_m, z_m, roll, pitch, yaw)


def _driving(run: ActorArrays, index: int) -> entities.Driving:
    """Return the driving at a frame; a recorder file has no speed limits."""
    velocity, acceleration = run.velocity_mps[index].tolist(), run.acceleration_mps2[index].tolist()
    return entities.Driving(
        (velocity[0], velocity[1], velocity[2]),
        (acceleration[0], acceleration[1], acceleration[2]),
        math.nan,
        float(run.throttle[index]),
        float(run.steer[index]),
        float(run.brake[index]),
    )


def _others(log: Log, runs: dict[int, ActorArrays]) -> dict[int, list[entities.Other]]:
    """Return all actors but the hero, by frame."""
    types = {actor.id: actor.type_id for actor in log.created}
    found: dict[int, list[entities.Other]] = {}
    for actor, run in runs.items():
        box = log.table(Kind.BOXES).of(actor).rows["extent_cm"]
        half = (float(box[0, 0]) / CM_PER_M, float(box[0, 1]) / CM_PER_M) if len(box) else None
        for index, frame in enumerate(run.frame.tolist()):
            x_m, y_m, z_m, _, _, yaw = _pose(run, index)
            found.setdefault(frame, []).append(entities.Other(actor, types[actor], x_m, y_m, z_m, yaw, half))
    return found
