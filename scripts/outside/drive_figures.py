"""The figures of a drive that other programs steer, from its run folder."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from basu.records.history.model import History


def figures_of(folder: Path, history: History) -> dict[str, Any]:
    """Return status, ways in m, distances from the route in m, scores, stops, collisions and times of a drive.

    Args:
        folder: of the run.
        history: the record in that folder.
    """
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    lateral_m = np.abs(history.frames["lateral_m"])
    signs, meta = result["stop_signs"], result["meta"]
    return {
        "status": result["status"],
        "message": result.get("message"),
        "frames": len(history.frames),
        "driven_m": round(float(history.frames["route_s_m"].max()), 1),
        "route_m": round(float(history.facts.route.s_m[-1]), 1),
        "cross_track_mean_m": round(float(lateral_m.mean()), 3),
        "cross_track_max_m": round(float(lateral_m.max()), 3),
        "scores": result.get("scores"),
        "stops_kept": f"{sum(sign['stopped'] for sign in signs)} of {len(signs)}",
        "collisions": result["collisions"],
        "infractions": [each["kind"] for each in result["infractions"]],
        "simulated_s": meta["simulated_s"],
        "times_real_time": round(meta["simulated_s"] / meta["wall_s"], 2),
    }
