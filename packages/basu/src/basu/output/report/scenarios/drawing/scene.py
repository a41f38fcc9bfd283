"""All that lies in a case's picture, from the ground up: lanes, plan, trails, boxes at the moment, marks, words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.output.report.plots.decimate import path
from basu.output.report.scenarios.drawing import actors
from basu.output.report.scenarios.drawing.actors import NOSE, block, body, outline
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX
from basu.output.report.scenarios.drawing.encounter import (
    boxes_at,
    thing_boxes,
)
from basu.output.report.scenarios.drawing.inset import INSET_PX, inset
from basu.output.report.scenarios.drawing.labels import Labels, cross
from basu.output.report.streets import on_the_map
from basu.output.report.templates import e

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.drawing.canvas import Canvas
    from basu.output.report.scenarios.drawing.encounter import CaseData, Encounter
    from basu.output.report.streets import Line

LANE_M = 3.4  # how wide a lane is drawn
PLAN_M = 1.6  # and the plan
TOLERANCE_M = 0.1  # which the plan may be off
APART_PX = 40.0  # times on a trail are written no nearer to each other
CONTACT_M = 0.005  # a distance below this is a contact
SMALL_PX, STRONG_PX, ALARM_PX = 11.5, 13.0, 14.0


class Scene:
    """The picture's contents as they are drawn; ``shown`` names the signs that its legend has to explain."""

    def __init__(self, story: CaseData, canvas: Canvas) -> None:
        self._story, self._canvas = story, canvas
        self._labels = Labels(canvas)
        self._timed: list[tuple[actors.Dot, str]] = []
        self.shown: set[str] = set()

    def draw(self, streets: Sequence[Line]) -> list[Element]:
        """Everything, the lowest first."""
        larger = inset(self._story, self._canvas, streets)
        if larger is not None:
            left, top = larger.corner_px
            self._labels.keep_free([(left, top), (left + INSET_PX[0], top + INSET_PX[1])], 2.0)
        self._labels.keep_free([(WIDTH_PX - 44.0, 0.0), (WIDTH_PX, 24.0)])  # where north is
        self._labels.keep_free([(0.0, self._canvas.height_px - 30.0), (180.0, self._canvas.height_px)])  # the scale
        ground, ways = self._ground(streets), self._ways()
        moment, contacts = self._moment(), self._contacts()
        self._write_times()
        times = [each for each in self._labels.drawn if "alarm" not in each.get("class", "")]
        said = [each for each in self._labels.drawn if "alarm" in each.get("class", "")]
        still = e("g", *moment, *contacts, *said, None if larger is None else larger.drawn, class_="moment")
        return [*ground, *ways, *times, still]

    def _ground(self, streets: Sequence[Line]) -> list[Element]:
        """Lanes and the ego's plan."""
        canvas = self._canvas
        lanes = "".join(
            canvas.line(piece) for lane in streets if len(lane) > 1 for piece in canvas.pieces(np.array(lane))
        )
        plan = np.array(path(self._story.history.facts.route.points_m, TOLERANCE_M))
        planned = "".join(canvas.line(piece) for piece in canvas.pieces(plan)) if len(plan) > 1 else ""
        return [
            e("path", d=lanes or None, class_="lane", stroke_width=LANE_M * canvas.pixels_per_m),
            e("path", d=planned or None, class_="plan", stroke_width=PLAN_M * canvas.pixels_per_m),
        ]

    def _ways(self) -> list[Element]:
        """Return the trails of the ego and of the scenario's actors."""
        story, canvas = self._story, self._canvas
        history, span = story.history, story.span
        drawn: list[Element] = []
        rows = history.others[(history.others["tick"] >= span.first) & (history.others["tick"] <= span.last)]
        for key in story.roles:
            theirs = rows[rows["id"] == key]
            if len(theirs) > 1:
                drawn.append(actors.other_trail(theirs["x_m"], theirs["y_m"], canvas))
                t_s = history.frames["t_s"][theirs["tick"] - history.frames["tick"][0]]
                found = actors.dots(t_s, theirs["x_m"], theirs["y_m"], canvas)
                drawn += actors.drawn(found, "spot", 2.2)
                self._timed += [(dot, "small halo") for dot in found]
        frames = history.frames[span.first : span.last + 1]
        for piece in canvas.pieces(on_the_map(np.column_stack([frames["x_m"], frames["y_m"]]))):
            self._labels.keep_line_free(np.array([canvas.at(x_m, y_m) for x_m, y_m in piece]))
        found = actors.dots(frames["t_s"], frames["x_m"], frames["y_m"], canvas)
        self._timed = [(dot, "small halo") for dot in found] + self._timed
        return [*drawn, *actors.own_trail(history, span, canvas), *actors.drawn(found, "dot", 2.6)]

    def _moment(self) -> list[Element]:
        """Return all actors at the moment of the least distance, and the distance as a line."""
        story, canvas, labels = self._story, self._canvas, self._labels
        begun = [] if story.conflict_tick is None else [self._ghost(story.conflict_tick)]
        met = story.met
        tick = story.span.last if met is None else met.tick
        t_s = float(story.history.frames["t_s"][tick])
        things = [block(box, canvas, "thing") for _, box in thing_boxes(story.result, t_s)]
        if things:
            self.shown.add("thing")
        own = story.own_box(tick)
        drawn = [body(own, canvas, "own")]
        labels.keep_free(outline(own, canvas, NOSE))
        for key, box in boxes_at(story.history, tick):
            is_near = met is not None and story.roles.get(key) == met.other
            style = "stranger" if key not in story.roles else "near" if is_near else "other"
            drawn.append(body(box, canvas, style))
            labels.keep_free(outline(box, canvas, NOSE))
        return [*begun, *things, *drawn, *([] if met is None else self._gap(met))]

    def _ghost(self, tick: int) -> Element:
        """Return where the ego was when the conflict began."""
        box = self._story.own_box(tick)
        placed = self._canvas.at(float(box[0]), float(box[1]))
        if self._canvas.shows(*placed):
            self.shown.add("ghost")
        return body(box, self._canvas, "ghost")

    def _gap(self, met: Encounter) -> list[Element]:
        """Return the least distance, as a line and in words."""
        canvas = self._canvas
        ends = [canvas.at(*met.own_m), canvas.at(*met.theirs_m)]
        t_s = float(self._story.history.frames["t_s"][met.tick])
        middle = ((ends[0][0] + ends[1][0]) / 2.0, (ends[0][1] + ends[1][1]) / 2.0)
        if met.distance_m < CONTACT_M:
            if not self._story.touched:
                self._labels.put(
                    f"touches {met.other} at {t_s:.1f} s",
                    middle,
                    "alarm halo",
                    size_px=ALARM_PX,
                    gap_px=12.0,
                    needed=True,
                )
            return []
        self.shown.add("gap")
        text = f"{met.distance_m:.2f} m to {met.other} at {t_s:.1f} s"
        self._labels.keep_free(ends, 3.0)
        self._labels.put(text, middle, "alarm halo", size_px=ALARM_PX, gap_px=14.0, needed=True)
        line = canvas.line([met.own_m, met.theirs_m])
        return [e("path", d=line, class_="gap under"), e("path", d=line, class_="gap")]

    def _contacts(self) -> list[Element]:
        """Return a cross at each first touch, the first with its words."""
        drawn = []
        for number_, contact in enumerate(self._story.touched):
            placed = self._canvas.at(*contact.at_m)
            if not self._canvas.shows(*placed):
                continue
            self.shown.add("hit")
            drawn.append(cross(*placed))
            self._labels.keep_free([placed], 8.0)
            t_s = float(self._story.history.frames["t_s"][contact.tick])
            text = f"hits {contact.other} at {t_s:.1f} s"
            self._labels.put(text, placed, "alarm halo", size_px=ALARM_PX, gap_px=14.0, needed=number_ == 0)
        return drawn

    def _write_times(self) -> None:
        """Seconds beside dots, every one, second or fifth, as there is room."""
        written: list[tuple[float, float]] = []
        for dot, style in self._timed:
            away = min((float(np.hypot(dot.at_px[0] - x, dot.at_px[1] - y)) for x, y in written), default=np.inf)
            if away >= APART_PX:
                before = len(self._labels.drawn)
                self._labels.put(dot.label, dot.at_px, style, size_px=SMALL_PX, gap_px=6.0)
                if len(self._labels.drawn) > before:
                    written.append(dot.at_px)
