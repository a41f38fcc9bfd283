"""The film of a case: every actor's place in the picture as key frames, which ``film.js`` plays and a slider moves.

A key frame is kept where straight motion between its neighbours would be off by more than the tolerances below.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes
from basu.metrics.red_lights import STATES
from basu.output.report.scenarios.drawing.actors import block, body
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX, Canvas
from basu.output.report.scenarios.drawing.encounter import thing_boxes
from basu.output.report.scenarios.drawing.labels import cross
from basu.output.report.templates import e, number
from basu.records.history.model import NO_LIGHT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.scenarios.drawing.encounter import CaseData

OFF_PX, OFF_RAD = 0.6, 0.03  # largest error of an interpolated place and heading
EDGE_PX = 30.0  # an actor moves on this far outside the picture
SPEED_EVERY_S = 0.5
SPEED_OFF_MPS = 0.15
PHASES = {"trigger": "before the conflict", "conflict": "conflict", "resolution": "resolution", "end": "after the case"}


class Seen(NamedTuple):
    """A time in which an actor is in the picture: its rows from above."""

    t_s: NDArray[np.float64]  # (N,)
    places: NDArray[np.float64]  # (N, 3) x and y in pixels, heading in rad without jumps
    box: NDArray[np.float64]  # (5,) at its first row


def film(story: CaseData, canvas: Canvas) -> Element | None:
    """Return the moving parts of a picture; None where the ego is never in it.

    Each part has its key frames as ``data-keys``: time in s, x and y in pixels, and heading in degrees.
    """
    history, span = story.history, story.span
    frames = history.frames[span.first : span.last + 1]
    own = list(_seen(frames["t_s"], own_boxes(history.facts, frames), canvas))
    if not own:
        return None
    begin_s, end_s = float(own[0].t_s[0]), float(own[-1].t_s[-1])
    parts = [*_things(story, canvas), *_others(story, canvas)]
    parts += [_moving(each, canvas, "own", "ego") for each in own]
    parts += _touches(story, canvas)
    return e(
        "g",
        *parts,
        class_="film",
        data_begin=number(begin_s),
        data_end=number(end_s),
        data_speed=_speeds(frames["t_s"], history.speed_mps()[span.first : span.last + 1]),
        data_words=_words(story),
    )


def key_frames(t_s: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which rows of ``places`` (N, 3) to keep: linear interpolation in time stays within the tolerances."""
    scaled = places / np.array([OFF_PX, OFF_PX, OFF_RAD])
    kept, open_parts = [0, len(t_s) - 1], [(0, len(t_s) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first < 2:
            continue
        part = (t_s[first + 1 : last] - t_s[first]) / (t_s[last] - t_s[first])
        between = scaled[first] + part[:, None] * (scaled[last] - scaled[first])
        off = np.abs(scaled[first + 1 : last] - between).max(axis=1)
        worst = int(off.argmax())
        if off[worst] > 1.0:
            kept.append(first + 1 + worst)
            open_parts += [(first, first + 1 + worst), (first + 1 + worst, last)]
    return np.unique(np.array(kept, dtype=np.int64))


def _seen(t_s: NDArray[np.float64], boxes: NDArray[np.float64], canvas: Canvas) -> Iterator[Seen]:
    """Yield the times in which boxes (N, 5) are in the picture; a gap in the record ends one."""
    x_px, y_px = canvas.at(boxes[:, 0], boxes[:, 1])
    reach_px = EDGE_PX + np.hypot(boxes[:, 3], boxes[:, 4]) * canvas.pixels_per_m
    is_in = (np.abs(x_px - WIDTH_PX / 2.0) < WIDTH_PX / 2.0 + reach_px) & (
        np.abs(y_px - canvas.height_px / 2.0) < canvas.height_px / 2.0 + reach_px
    )
    if len(t_s) < 2:
        return
    longest_s = 1.5 * float(np.diff(t_s).min())
    splits = np.flatnonzero((np.diff(is_in.astype(np.int8)) != 0) | (np.diff(t_s) > longest_s)) + 1
    for rows in np.split(np.arange(len(t_s)), splits):
        if len(rows) > 1 and is_in[rows[0]]:
            places = np.column_stack([x_px[rows], y_px[rows], np.unwrap(boxes[rows, 2])])
            yield Seen(t_s[rows], places, boxes[rows[0]])


def _others(story: CaseData, canvas: Canvas) -> Iterator[Element]:
    """Yield the other actors."""
    history, span = story.history, story.span
    first, last = history.frames["tick"][[span.first, span.last]]
    rows = history.others[(history.others["tick"] >= first) & (history.others["tick"] <= last)]
    boxes = other_boxes(history.facts, rows)
    t_s = history.frames["t_s"][rows["tick"].astype(np.int64) - int(history.frames["tick"][0])]
    for key in dict.fromkeys(rows["id"].tolist()):
        is_its = rows["id"] == key
        role = story.roles.get(key)
        title = role or history.facts.actor_types.get(key, "an actor")
        for each in _seen(t_s[is_its], boxes[is_its], canvas):
            yield _moving(each, canvas, "stranger" if role is None else "other", title)


def _moving(seen: Seen, canvas: Canvas, style: str, title: str) -> Element:
    """Return an actor around the origin of its own frame, with its key frames."""
    still = Canvas(0.0, 0.0, canvas.pixels_per_m, canvas.height_px)
    drawn = body(np.array([0.0, 0.0, 0.0, *seen.box[3:]]), still, style)
    drawn.append(e("title", title))
    kept = key_frames(seen.t_s, seen.places)
    drawn.set("data-keys", ";".join(_key(seen.t_s[row], *seen.places[row]) for row in kept.tolist()))
    return drawn


def _key(t_s: float, x_px: float, y_px: float, yaw_rad: float) -> str:
    """Return a key frame as text."""
    return f"{number(t_s)} {number(x_px, 1)} {number(y_px, 1)} {number(float(np.degrees(yaw_rad)), 0)}"


def _things(story: CaseData, canvas: Canvas) -> Iterator[Element]:
    """Yield what the scenario brought that is no actor of the record, with the time in which it is there."""
    for thing, (_, box) in zip(story.result["things"], thing_boxes(story.result), strict=True):
        drawn = block(box, canvas, "thing")
        drawn.append(e("title", str(thing["name"])))
        drawn.set("data-from", number(thing.get("from_s") or 0.0))
        if thing.get("until_s") is not None:
            drawn.set("data-until", number(thing["until_s"]))
        yield drawn


def _touches(story: CaseData, canvas: Canvas) -> Iterator[Element]:
    """Yield the contacts, each from its moment on."""
    for contact in story.touched:
        placed = canvas.at(*contact.at_m)
        if canvas.shows(*placed):
            yield e("g", cross(*placed), data_from=number(float(story.history.frames["t_s"][contact.tick])))


def _speeds(t_s: NDArray[np.float64], speed_mps: NDArray[np.float64]) -> str:
    """Return the ego's speed as key frames: time in s and speed in m/s."""
    at_s = np.append(np.arange(t_s[0], t_s[-1], SPEED_EVERY_S), t_s[-1])
    at_mps = np.interp(at_s, t_s, speed_mps)
    places = np.column_stack([at_mps * OFF_PX / SPEED_OFF_MPS, np.zeros((len(at_s), 2))])
    kept = key_frames(at_s, places)
    return ";".join(f"{number(at_s[row])} {number(at_mps[row], 1)}" for row in kept.tolist())


def _words(story: CaseData) -> str:
    """Return what is said beside the time, each with the moment from which it is true: phase and light ahead."""
    history, span = story.history, story.span
    frames = history.frames[span.first : span.last + 1]
    t_s, lights = frames["t_s"], frames["route_light"]
    phases = sorted((at_s, PHASES[name]) for name, at_s in story.result["phases_s"].items() if name in PHASES)
    changes = [float(t_s[row]) for row in np.flatnonzero(np.diff(lights, prepend=lights[0] - 1))]
    said: list[tuple[float, str]] = []
    for at_s in sorted({*changes, *(at_s for at_s, _ in phases), float(t_s[0])}):
        phase = next((words for begun_s, words in reversed(phases) if begun_s <= at_s + 1e-6), PHASES["trigger"])
        row = min(int(np.searchsorted(t_s, at_s - 1e-6)), len(t_s) - 1)
        light = int(lights[row])
        said.append((at_s, phase if light == NO_LIGHT else f"{phase}, light ahead {STATES[light]}"))
    return ";".join(f"{number(at_s)} {words}" for at_s, words in said)
