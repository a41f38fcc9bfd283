"""A place made from points alone, for rehearsals without a map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.routing import Route
from basu.scenarios.paths import Path
from basu.scenarios.place import Place

if TYPE_CHECKING:
    from collections.abc import Sequence


def paper_place(
    points: Sequence[Sequence[float]],
    *,
    trigger_s_m: float = 0.0,
    lane_width_m: float = 3.5,
    junctions_m: Sequence[tuple[float, float]] = (),
) -> Place:
    """The ego's route through points (x, y), sampled each metre, with junctions from and to so far along it.

    Nothing that asks the map can be had there: ``place.carla_map`` is None.
    """
    path = Path.through(points)
    s_m = np.unique(np.append(np.arange(0.0, path.length_m, 1.0), path.length_m))
    poses = np.array([path.at(float(s)) for s in s_m])
    is_junction = np.zeros(len(s_m), dtype=np.bool_)
    for from_m, to_m in junctions_m:
        is_junction |= (s_m >= from_m) & (s_m <= to_m)
    route = Route(
        id="paper",
        town="paper",
        points_m=poses[:, :3],
        s_m=s_m,
        yaw_rad=poses[:, 3],
        lane_width_m=np.full(len(s_m), lane_width_m),
        speed_limit_mps=np.full(len(s_m), np.nan),
        is_junction=is_junction,
        road_id=np.zeros(len(s_m), dtype=np.int64),
        lane_id=np.full(len(s_m), -1, dtype=np.int64),
    )
    return Place(route=route, trigger_s_m=trigger_s_m, carla_map=None)
