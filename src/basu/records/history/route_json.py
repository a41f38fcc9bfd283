"""A planned route as JSON values and back, exactly: the part of a record that says what was to be driven."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from basu.routing import Control, ControlKind, Route, Stop
from basu.routing.timetable import timetable_from_json, timetable_to_json

ARRAYS = ("points_m", "s_m", "yaw_rad", "lane_width_m", "speed_limit_mps", "is_junction", "road_id", "lane_id")


def route_to_json(route: Route) -> dict[str, Any]:
    """The route without its client handles; a limit that is not posted (nan) becomes null."""
    document: dict[str, Any] = {"id": route.id, "town": route.town}
    for name in ARRAYS:
        document[name] = getattr(route, name).tolist()
    document["speed_limit_mps"] = [None if math.isnan(limit) else limit for limit in document["speed_limit_mps"]]
    document["stops"] = [asdict(stop) for stop in route.stops]
    if route.timetable is not None:
        document["timetable"] = timetable_to_json(route.timetable)
    document["controls"] = [{**asdict(control), "kind": control.kind.value} for control in route.controls]
    return document


def route_from_json(document: dict[str, Any]) -> Route:
    """Read what :func:`route_to_json` wrote."""
    limits = [math.nan if limit is None else limit for limit in document["speed_limit_mps"]]
    arrays: dict[str, Any] = {name: np.array(document[name]) for name in ARRAYS if name != "speed_limit_mps"}
    return Route(
        id=document["id"],
        town=document["town"],
        speed_limit_mps=np.array(limits, dtype=np.float64),
        stops=tuple(Stop(**stop) for stop in document["stops"]),
        timetable=timetable_from_json(document["timetable"]) if "timetable" in document else None,
        controls=tuple(Control(**{**c, "kind": ControlKind(c["kind"])}) for c in document["controls"]),
        **arrays,
    )
