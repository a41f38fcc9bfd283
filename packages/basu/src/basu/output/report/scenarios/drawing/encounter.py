"""The moment of a case with the least distance between ego and another actor, and the two points it lies between."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.records.history import Collision, History

    Box = NDArray[np.float64]  # (5,) centre x, y in m, heading in rad, half length, half width in m

LEAST_DISTANCE = "least distance"  # how the names of the criteria begin that judged the moment
MOST_CONTACTS = 6  # marks of contacts in one picture
CORNERS = ((1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0))

Point = tuple[float, float]  # x, y in m, CARLA frame


class Span(NamedTuple):
    """The ticks of a record that belong to a case; the last is in it."""

    first: int
    last: int


class Encounter(NamedTuple):
    """The nearest actor, with time and place."""

    tick: int
    other: str  # a role, a thing's name or a blueprint id
    distance_m: float
    own_m: Point  # on the ego's box
    theirs_m: Point  # on the other's


class Contact(NamedTuple):
    """Where the ego touched something first."""

    tick: int
    other: str
    at_m: Point


def span_of(result: Mapping[str, Any], history: History) -> Span:
    """The case's part of a record: all of it where the case was the whole run, else from its trigger to its end."""
    t_s = history.frames["t_s"]
    phases_s = result["phases_s"]
    first = int(np.searchsorted(t_s, min(phases_s.values(), default=0.0) - 1e-6))
    last = int(np.searchsorted(t_s, phases_s["end"] + 1e-6)) - 1 if "end" in phases_s else len(t_s)
    return Span(min(first, len(t_s) - 1), max(0, min(last, len(t_s) - 1)))


def roles_of(result: Mapping[str, Any]) -> dict[int, str]:
    """Ids and roles of the scenario's actors."""
    return {int(actor["id"]): str(actor["role"]) for actor in result["actors"]}


def encounter_of(result: Mapping[str, Any], history: History, span: Span) -> Encounter | None:
    """The moment that the criteria judged; where none did, the nearest of the record. None without any actor.

    A deciding criterion comes before a reported one: it concerns the scenario's own actors.
    """
    judged = [
        j
        for j in result["judgements"]
        if j["criterion"].startswith(LEAST_DISTANCE) and j["measured"] is not None and j["t_s"] is not None
    ]
    if judged:
        found = min(judged, key=lambda j: (not j["deciding"], j["measured"]))
        tick = int(np.argmin(np.abs(history.frames["t_s"] - found["t_s"])))
        beside = _beside(result, history, tick)
        named = [party for party in beside if party[0] == found["other"]] or beside
        if named:
            own = own_boxes(history.facts, history.frames[tick : tick + 1])[0]
            nearest = min((_between(own, box) for _, box in named), key=lambda between: between[0])
            return Encounter(tick, str(found["other"] or named[0][0]), float(found["measured"]), *nearest[1:])
    return _searched(result, history, span)


def contacts_of(result: Mapping[str, Any], history: History, span: Span) -> list[Contact]:
    """The first touch of each party within the case."""
    seen: dict[int, Collision] = {}
    for collision in history.collisions:
        if span.first <= collision.tick <= span.last:
            seen.setdefault(collision.other_id, collision)
    roles = roles_of(result)
    return [
        Contact(c.tick, roles.get(c.other_id, c.other_type), _touch(history, c))
        for c in list(seen.values())[:MOST_CONTACTS]
    ]


def boxes_at(history: History, tick: int) -> list[tuple[int, Box]]:
    """Ids and boxes of all actors near in a tick."""
    rows = history.others[history.others["tick"] == history.frames["tick"][tick]]
    return list(zip(rows["id"].tolist(), other_boxes(history.facts, rows), strict=True))


def thing_boxes(result: Mapping[str, Any], t_s: float | None = None) -> list[tuple[str, Box]]:
    """What the scenario brought that is no actor of the record: wherever it stood, or where it stood at a time."""
    keys = ("x_m", "y_m", "yaw_rad", "half_length_m", "half_width_m")
    return [
        (str(thing["name"]), np.array([thing[key] for key in keys]))
        for thing in result["things"]
        if t_s is None or thing.get("from_s", 0.0) <= t_s + 1e-6 < (thing.get("until_s") or math.inf)
    ]


def _beside(result: Mapping[str, Any], history: History, tick: int) -> list[tuple[str, Box]]:
    """All actors and things near in a tick, by name."""
    roles, types = roles_of(result), history.facts.actor_types
    actors = [(roles.get(key, types.get(key, "an unknown type")), box) for key, box in boxes_at(history, tick)]
    return [*actors, *thing_boxes(result, float(history.frames["t_s"][tick]))]


def _searched(result: Mapping[str, Any], history: History, span: Span) -> Encounter | None:
    """The least distance of the record to the scenario's actors, or to any actor where it has none.

    Pairs are looked at in the order of a lower bound, centres less both radii, until no other can be nearer.
    """
    roles, facts = roles_of(result), history.facts
    others = history.others
    rows = others[
        (others["tick"] >= history.frames["tick"][span.first]) & (others["tick"] <= history.frames["tick"][span.last])
    ]
    if roles:
        rows = rows[np.isin(rows["id"], list(roles))]
    ticks = rows["tick"].astype(np.int64) - int(history.frames["tick"][0])
    theirs = other_boxes(facts, rows)
    names = [roles.get(key, facts.actor_types.get(key, "an unknown type")) for key in rows["id"].tolist()]
    all_ticks = np.arange(span.first, span.last + 1)
    for name, box in thing_boxes(result):
        ticks = np.concatenate([ticks, all_ticks])
        theirs = np.concatenate([theirs, np.broadcast_to(box, (len(all_ticks), 5))])
        names += [name] * len(all_ticks)
    own = own_boxes(facts, history.frames)[ticks]
    apart_m = np.hypot(*(own[:, :2] - theirs[:, :2]).T)
    bound_m = apart_m - np.hypot(own[:, 3], own[:, 4]) - np.hypot(theirs[:, 3], theirs[:, 4])
    best: Encounter | None = None
    for index in np.argsort(bound_m, kind="stable").tolist():
        if not np.isfinite(bound_m[index]) or (best is not None and bound_m[index] >= best.distance_m):
            break
        between = _between(own[index], theirs[index])
        if best is None or between[0] < best.distance_m:
            best = Encounter(int(ticks[index]), names[index], *between)
    return best


def _between(a: Box, b: Box) -> tuple[float, Point, Point]:
    """The distance of two boxes and the points on both between which it lies; 0 and one point where they overlap."""
    candidates = [(*_corner_to(corner, b), corner) for corner in _corners(a)]
    pairs = [(away_m, corner, on_box) for away_m, on_box, corner in candidates]
    pairs += [(away_m, on_box, corner) for corner in _corners(b) for away_m, on_box in [_corner_to(corner, a)]]
    return min(pairs, key=lambda pair: pair[0])


def _corners(box: Box) -> list[Point]:
    x_m, y_m, yaw_rad, half_length_m, half_width_m = box.tolist()
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return [
        (
            x_m + ahead * half_length_m * cos - right * half_width_m * sin,
            y_m + ahead * half_length_m * sin + right * half_width_m * cos,
        )
        for ahead, right in CORNERS
    ]


def _corner_to(point_m: Point, box: Box) -> tuple[float, Point]:
    """How far a point is from a box, and the nearest point of the box."""
    x_m, y_m, yaw_rad, half_length_m, half_width_m = box.tolist()
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    dx, dy = point_m[0] - x_m, point_m[1] - y_m
    ahead_m = min(max(dx * cos + dy * sin, -half_length_m), half_length_m)
    right_m = min(max(dy * cos - dx * sin, -half_width_m), half_width_m)
    on_box = (x_m + ahead_m * cos - right_m * sin, y_m + ahead_m * sin + right_m * cos)
    return math.hypot(point_m[0] - on_box[0], point_m[1] - on_box[1]), on_box


def _touch(history: History, collision: Collision) -> Point:
    """Where a contact was: nearest to the other's box, or on the side that the impulse came from."""
    tick = collision.tick
    own = own_boxes(history.facts, history.frames[tick : tick + 1])[0]
    rows = history.others[(history.others["tick"] == tick) & (history.others["id"] == collision.other_id)]
    if collision.other_id and len(rows):
        return _between(own, other_boxes(history.facts, rows)[0])[1]
    east, south, _ = collision.impulse_ns  # pushes the ego away from what it hit
    reach_m = math.hypot(own[3], own[4]) / max(math.hypot(east, south), 1e-9)
    return _corner_to((own[0] - east * reach_m, own[1] - south * reach_m), own)[1]


class CaseData(NamedTuple):
    """The data of a case that its picture shows."""

    result: Mapping[str, Any]
    history: History
    span: Span
    roles: dict[int, str]
    met: Encounter | None
    touched: list[Contact]

    @property
    def conflict_tick(self) -> int | None:
        """When the conflict began; None where it never did."""
        t_s = self.result["phases_s"].get("conflict")
        if t_s is None:
            return None
        return min(int(np.searchsorted(self.history.frames["t_s"], t_s - 1e-6)), len(self.history.frames) - 1)

    def own_box(self, tick: int) -> Box:
        """The ego's box in a tick."""
        box: Box = own_boxes(self.history.facts, self.history.frames[tick : tick + 1])[0]
        return box


def story_of(result: Mapping[str, Any], history: History) -> CaseData:
    """Find in a record what its picture is about."""
    span = span_of(result, history)
    return CaseData(
        result,
        history,
        span,
        roles_of(result),
        encounter_of(result, history, span),
        contacts_of(result, history, span),
    )
