"""Rows of BASU's record as the frames and facts that the page shows; live drives and replays use the same functions."""

from __future__ import annotations

import gzip
import json
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.metrics.passengers.felt import STEP_MPS2
from basu.records.history.model import OTHER
from linden_window import poses
from linden_window.poses import POSE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.metrics.score import Scores
    from basu.records.history import Facts, History
    from basu.routing import Route

EGO_ID = 1
"""Id of the vehicle under test in the page; BASU's own numbering has no id for it."""
FIRST_OTHER = 1000
RUN_IDS = 1 << 24
"""Ids of each further run of a comparison begin so much higher."""
EGO_COLOUR = (236, 236, 228)
RUN_COLOURS = (
    EGO_COLOUR, (70, 130, 220), (230, 150, 40), (120, 190, 90), (200, 80, 140), (90, 190, 200), (170, 130, 220),
    (150, 120, 90),
)  # fmt: skip
OTHER_COLOURS = ((120, 124, 130), (150, 60, 55), (60, 88, 130), (196, 196, 190), (70, 100, 80), (166, 140, 90))
_HALF_HEIGHT_M = {"vehicle": 0.8, "walker": 0.93, "prop": 0.5}
MPS_TO_KMH = 3.6
LINE_EVERY_M = 2.0


def ego_rows(frames: NDArray[Any], run: int = 0) -> NDArray[Any]:
    """Return rows of the page (T,) from frames of the record (T,)."""
    out = np.zeros(len(frames), POSE)
    out["id"], out["ghost"] = EGO_ID + run * RUN_IDS, run
    _place(out, frames)
    angles = np.empty((len(frames), 3))
    for column, axis in enumerate(("pitch_rad", "yaw_rad", "roll_rad")):
        angles[:, column] = frames[axis]
    out["rotation"] = poses.turns(np.degrees(angles))
    speed = np.sqrt(frames["velocity_x_mps"] ** 2 + frames["velocity_y_mps"] ** 2 + frames["velocity_z_mps"] ** 2)
    out["speed"] = np.minimum(speed, 327.0) * 100.0
    out["steer"] = (frames["applied_steer"] * 70.0).clip(-127, 127)  # a full wheel turns some 40 degrees
    out["throttle"], out["brake"] = frames["applied_throttle"] * 255.0, frames["applied_brake"] * 255.0
    limit = frames["speed_limit_mps"] * MPS_TO_KMH
    out["limit"] = np.where(limit > 0.0, np.minimum(limit, 255.0), 0.0)  # 0 for none, which is nan in the record
    out["lights"] = np.where(frames["applied_brake"] > 0.02, 0x8, 0)
    reverses = frames["applied_reverse"].astype(bool)
    out["state"] = reverses * np.uint8(poses.REVERSES) + frames["manual"].astype(np.uint8) * np.uint8(poses.BY_HAND)
    return out


def other_rows(others: NDArray[Any], run: int = 0) -> NDArray[Any]:
    """Return rows of the page (M,) from the record's other actors (M,)."""
    out = np.zeros(len(others), POSE)
    out["id"], out["ghost"] = others["id"] + FIRST_OTHER + run * RUN_IDS, run
    _place(out, others)
    angles = np.zeros((len(others), 3))
    angles[:, 1] = np.degrees(others["yaw_rad"])
    out["rotation"] = poses.turns(angles)
    out["speed"] = np.minimum(np.hypot(others["velocity_x_mps"], others["velocity_y_mps"]), 327.0) * 100.0
    return out


def _place(out: NDArray[Any], rows: NDArray[Any]) -> None:
    """Write the places of the record's rows."""
    for column, axis in enumerate(("x_m", "y_m", "z_m")):
        out["place"][:, column] = rows[axis]


def as_others(rows: list[tuple[float, ...]]) -> NDArray[Any]:
    """Return rows of ``Neighbours.near`` as an array of the record's type."""
    return np.array(rows, OTHER) if rows else np.zeros(0, OTHER)


def actors_note(facts: Facts, names: str, run: int = 0) -> list[dict[str, Any]]:
    """Return what the page needs to know of the vehicle under test, called ``names``, and of all others."""
    vehicle = facts.vehicle
    half_m = (vehicle.front_m + vehicle.rear_m) / 2.0
    ego = _actor(
        EGO_ID + run * RUN_IDS, vehicle.type_id, (half_m, vehicle.width_m / 2.0), RUN_COLOURS[run % len(RUN_COLOURS)]
    )
    ego["role"] = names
    ego["box"][0] = (vehicle.front_m - vehicle.rear_m) / 2.0
    found = [ego]
    for number, type_id in facts.actor_types.items():
        size = facts.actor_sizes.get(number, (0.5, 0.5))
        found.append(other_actor(number, type_id, size, run))
    return found


def other_actor(number: int, type_id: str, size: tuple[float, float], run: int = 0) -> dict[str, Any]:
    """Return what the page needs to know of another actor; ``size`` is half its length and width, m."""
    return _actor(number + FIRST_OTHER + run * RUN_IDS, type_id, size, OTHER_COLOURS[number % len(OTHER_COLOURS)])


def _actor(number: int, type_id: str, size: tuple[float, float], colour: tuple[int, int, int]) -> dict[str, Any]:
    first = type_id.partition(".")[0]
    kind = {"vehicle": "vehicle", "walker": "walker"}.get(first, "prop")
    high = _HALF_HEIGHT_M[kind]
    middle = 0.0 if kind == "walker" else high
    return {
        "id": number, "type": type_id, "choice": "", "kind": kind, "parent": 0, "role": "", "fov": "",
        "colour": list(colour), "box": [0.0, 0.0, middle, size[0], size[1], high],
    }  # fmt: skip


def route_note(route: Route, *, drives: bool) -> dict[str, Any]:
    """Return the planned path, thinned, with its stops and lines of signs and lights, and the actor to follow."""
    step = max(1, round(LINE_EVERY_M * len(route.points_m) / max(1.0, route.length_m)))
    points = np.round(route.points_m[::step], 2).tolist()
    half_m = 0.5 * float(np.median(route.lane_width_m))
    controls = [
        {
            "kind": control.kind.value,
            "id": control.landmark_id,
            "x": control.x_m,
            "y": control.y_m,
            "z": control.z_m,
            "yaw": control.yaw_rad,
        }
        for control in route.controls
    ]
    stops = [{"name": stop.name, "x": stop.x_m, "y": stop.y_m} for stop in route.stops]
    path = {"points": points, "controls": controls, "half": half_m, "stops": stops}
    return {"type": "route", "ego": EGO_ID, "drives": drives, **path}


def words_of(evidence: Evidence) -> str:
    """Return an infraction in words."""
    return f"{evidence.kind.value.replace('_', ' ')}: {evidence.detail}"


def mark_of(evidence: Evidence, run: int = 0) -> dict[str, Any]:
    """Return an infraction as a mark on the slider."""
    place = {"x": evidence.x_m, "y": evidence.y_m}
    return {"t": evidence.t_s, "text": words_of(evidence), "bad": True, "run": run, **place}


class Moment(NamedTuple):
    """Figures of one frame for the panel."""

    t_s: float
    speed_mps: float
    limit_mps: float
    route_s_m: float
    hardest_mps2: float  # the largest acceleration in the plane in the last second
    manual: bool


def panel_note(
    title: str, route: Route, moment: Moment, scores: Scores | None, found: tuple[Evidence, ...]
) -> dict[str, Any]:
    """Return the panel at a moment: score so far, infractions, comfort, next stop."""
    ahead = [stop for stop in route.stops if stop.s_m > moment.route_s_m + 1.0]
    lines: list[dict[str, Any]] = [
        {"name": "driver", "value": "a person" if moment.manual else "agent"},
        {
            "name": "speed, limit",
            "value": f"{moment.speed_mps * MPS_TO_KMH:.0f}, {_limit(moment.limit_mps)}",
            "bad": 0.0 < moment.limit_mps < moment.speed_mps - 0.5,
        },
        {
            "name": "route",
            "value": f"{moment.route_s_m:.0f} of {route.length_m:.0f} m",
        },
        {
            "name": "next stop",
            "value": f"{ahead[0].name}, {ahead[0].s_m - moment.route_s_m:.0f} m" if ahead else "none ahead",
        },
        {
            "name": "comfort",
            "value": f"{moment.hardest_mps2:.1f} m/s²"
            + (", a balancing step" if moment.hardest_mps2 > STEP_MPS2 else ""),
            "bad": moment.hardest_mps2 > STEP_MPS2,
        },
    ]
    if scores is not None:
        lines += [
            {"name": "rules", "value": f"{scores.infraction:.2f}"},
            {"name": "path", "value": f"{scores.path_following:.2f}"},
        ]
    return {
        "type": "panel",
        "t": moment.t_s,
        "title": title,
        "large": "" if scores is None else f"{scores.driving:.3f}",
        "lines": lines,
        "found": [{"text": words_of(each)} for each in found[-8:]],
    }


def moment_of(frames: NDArray[Any], tick: int, step_s: float) -> Moment:
    """Return the figures of a frame of the record."""
    row = frames[tick]
    last = frames[max(0, tick - round(1.0 / step_s)) : tick + 1]
    hardest = float(np.hypot(last["acceleration_x_mps2"], last["acceleration_y_mps2"]).max())
    speed = math.hypot(row["velocity_x_mps"], row["velocity_y_mps"], row["velocity_z_mps"])
    limit = float(row["speed_limit_mps"])
    return Moment(float(row["t_s"]), speed, limit, float(row["route_s_m"]), hardest, bool(row["manual"]))


def _limit(limit_mps: float) -> str:
    return f"{limit_mps * MPS_TO_KMH:.0f} km/h" if limit_mps > 0.0 else "none posted"


def record_frames(histories: list[History]) -> bytes:
    """Return the compressed frames of several runs, with runs shown together at equal simulated times."""
    egos = [ego_rows(history.frames, run) for run, history in enumerate(histories)]
    others = [other_rows(history.others, run) for run, history in enumerate(histories)]
    starts = [np.searchsorted(h.others["tick"], np.arange(len(h.frames) + 1)) for h in histories]
    longest = max(histories, key=lambda history: len(history.frames))
    step_s = longest.facts.step_s
    parts = []
    for tick in range(len(longest.frames)):
        rows = []
        for run, history in enumerate(histories):
            at = min(round(tick * step_s / history.facts.step_s), len(history.frames) - 1)
            rows += [egos[run][at : at + 1], others[run][starts[run][at] : starts[run][at + 1]]]
        parts.append(poses.message(tick, float(longest.frames["t_s"][tick]), *rows))
    return gzip.compress(b"".join(parts), 6, mtime=0)


def packed(document: Mapping[str, Any]) -> bytes:
    """Return a document as compressed JSON."""
    return gzip.compress(json.dumps(document, separators=(",", ":")).encode(), 6, mtime=0)
