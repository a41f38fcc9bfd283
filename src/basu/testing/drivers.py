"""Simple drivers for the ego of a rehearsal: each says the speed of the next frame."""

from __future__ import annotations

import math
from collections.abc import Callable

from basu.scenarios.actions.puppet import gap_ahead
from basu.scenarios.paths import Path
from basu.scenarios.stage import EGO
from basu.testing.paper_stage import PaperStage

Driver = Callable[[PaperStage], float]
START_MPS2 = 2.0  # how hard they accelerate


def steady(speed_mps: float) -> Driver:
    """One speed from the first frame on, whoever is in the way."""
    return lambda _stage: speed_mps


def waiting_at(
    s_m: float, seconds: float, speed_mps: float, brake_mps2: float = 2.0, start_mps2: float = START_MPS2
) -> Driver:
    """A speed, a lawful stop before ``s_m`` of the route for so long, and on."""
    stood_s = 0.0

    def drive(stage: PaperStage) -> float:
        nonlocal stood_s
        now_mps, left_m = stage.ego.forward_mps, s_m - stage.ego_s_m
        if stood_s >= seconds or left_m < -0.5:
            return min(speed_mps, now_mps + start_mps2 * stage.step_s)
        wanted_mps = min(speed_mps, math.sqrt(2.0 * brake_mps2 * max(left_m - 0.3, 0.0)))
        if wanted_mps < 0.3:
            stood_s += stage.step_s
            return 0.0
        return min(wanted_mps, now_mps + start_mps2 * stage.step_s)

    return drive


def careful(speed_mps: float, brake_mps2: float = 5.0, keeps_m: float = 3.0) -> Driver:
    """A speed, and brakes for whoever is on its way as far as it needs to stand ``keeps_m`` before."""
    way: Path | None = None

    def drive(stage: PaperStage) -> float:
        nonlocal way
        way = way or Path.through(stage.route.points_m)
        now_mps, allowed_mps = stage.ego.forward_mps, speed_mps
        for name in stage.names:
            ahead = None if name == EGO else gap_ahead(way, stage.ego_s_m, stage.ego, stage.body(name))
            if ahead is not None:
                room_m = max(0.0, ahead.gap_m - keeps_m)
                allowed_mps = min(allowed_mps, math.sqrt(ahead.speed_mps**2 + 2.0 * 0.6 * brake_mps2 * room_m))
        lowest_mps = now_mps - brake_mps2 * stage.step_s
        return max(0.0, lowest_mps, min(allowed_mps, now_mps + START_MPS2 * stage.step_s))

    return drive
