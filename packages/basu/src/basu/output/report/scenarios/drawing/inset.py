"""A corner of a case's picture in which the moment of least distance is seen larger."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.output.report.scenarios.drawing.actors import block, body, outline
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX, Canvas
from basu.output.report.scenarios.drawing.encounter import boxes_at, thing_boxes
from basu.output.report.scenarios.drawing.labels import cross
from basu.output.report.streets import on_the_map
from basu.output.report.templates import e, extended, number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.drawing.encounter import Box, CaseData, Encounter, Point
    from basu.output.report.streets import Line

INSET_PX, CAPTION_PX = (176.0, 136.0), 16.0
EDGE_PX, HEAD_PX = 8.0, 26.0  # from the picture's edges; below its upper one is where north is written
SHOWN_M = 15.0  # across the inset
LARGE_ENOUGH = 9.0  # pixels a metre: a picture of this scale needs no inset
NEAR_M = 6.0  # an actor farther away would not be in it
LANE_M = 3.4


class Inset(NamedTuple):
    """What lies in it, and its upper left corner."""

    corner_px: Point
    drawn: Element


def inset(story: CaseData, canvas: Canvas, streets: Sequence[Line]) -> Inset | None:
    """The inset in the corner where it hides least; None where the picture is large enough, or no actor was near."""
    met = story.met
    if met is None or met.distance_m > NEAR_M or canvas.pixels_per_m >= LARGE_ENOUGH:
        return None
    middle_m = ((met.own_m[0] + met.theirs_m[0]) / 2.0, (met.own_m[1] + met.theirs_m[1]) / 2.0)
    scale = INSET_PX[0] / SHOWN_M
    seen_px = INSET_PX[1] - CAPTION_PX
    close = Canvas(middle_m[0] - SHOWN_M / 2.0, middle_m[1] - seen_px / scale / 2.0, scale, seen_px)
    corner = _corner(story, canvas, canvas.at(*middle_m))
    size = {"width": INSET_PX[0], "height": INSET_PX[1]}
    drawn = e("svg", e("rect", class_="paper", **size), x=number(corner[0], 1), y=number(corner[1], 1), **size)
    extended(drawn, [_lanes(close, streets), *_bodies(story, close, met)])
    drawn.append(e("rect", y=seen_px, width=INSET_PX[0], height=CAPTION_PX, class_="below"))
    drawn.append(e("rect", x=0.75, y=0.75, width=INSET_PX[0] - 1.5, height=INSET_PX[1] - 1.5, class_="lens"))
    scale_text = f"{scale / canvas.pixels_per_m:.1f} times as large"
    drawn.append(e("text", scale_text, x=6, y=INSET_PX[1] - 4.5, class_="small"))
    return Inset(corner, drawn)


def _lanes(close: Canvas, streets: Sequence[Line]) -> Element:
    """Return the lanes in the inset."""
    lines = [close.line(piece) for lane in streets if len(lane) > 1 for piece in close.pieces(np.array(lane), 2.0)]
    return e("path", d="".join(lines) or None, class_="lane", stroke_width=LANE_M * close.pixels_per_m)


def _bodies(story: CaseData, close: Canvas, met: Encounter) -> list[Element]:
    """Return all actors in it, and the distance between the two."""
    t_s = float(story.history.frames["t_s"][met.tick])
    things = [block(box, close, "thing") for _, box in thing_boxes(story.result, t_s) if _is_in(box, close)]
    others = [
        body(box, close, "near" if story.roles.get(key) == met.other else "other")
        for key, box in boxes_at(story.history, met.tick)
        if _is_in(box, close)
    ]
    own = body(story.own_box(met.tick), close, "own")
    if any(contact.tick == met.tick for contact in story.touched) or met.distance_m == 0.0:
        return [*things, own, *others, cross(*close.at(*met.own_m))]
    line = close.line([met.own_m, met.theirs_m])
    return [*things, own, *others, e("path", d=line, class_="gap under"), e("path", d=line, class_="gap")]


def _is_in(box: Box, close: Canvas) -> bool:
    """Return whether some of it can be seen."""
    across, down = zip(*outline(box, close, 1.0), strict=True)
    return bool(max(across) > 0.0 and min(across) < INSET_PX[0] and max(down) > 0.0 and min(down) < close.height_px)


def _corner(story: CaseData, canvas: Canvas, middle_px: Point) -> Point:
    """Upper left of the corner that hides least of the drive; among equals, the farthest from the encounter."""
    frames = story.history.frames[story.span.first : story.span.last + 1]
    way_m = on_the_map(np.column_stack([frames["x_m"], frames["y_m"]]))
    across, down = canvas.at(way_m[:, 0], way_m[:, 1])
    right, bottom = WIDTH_PX - EDGE_PX - INSET_PX[0], canvas.height_px - EDGE_PX - INSET_PX[1]
    corners = [(right, HEAD_PX), (EDGE_PX, EDGE_PX), (right, bottom), (EDGE_PX, bottom - HEAD_PX)]

    def hidden(corner: Point) -> tuple[int, float]:
        is_across = (across > corner[0]) & (across < corner[0] + INSET_PX[0])
        under = is_across & (down > corner[1]) & (down < corner[1] + INSET_PX[1])
        away = np.hypot(corner[0] + INSET_PX[0] / 2.0 - middle_px[0], corner[1] + INSET_PX[1] / 2.0 - middle_px[1])
        return int(under.sum()), -float(away)

    return min(corners, key=hidden)
