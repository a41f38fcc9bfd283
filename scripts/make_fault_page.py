"""Write docs/reference/fault.md and its ten pictures: `make_fault_page.py [--check]`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree.ElementTree import tostring

import numpy as np
from generated_page import write_or_check

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from basu.metrics.boxes import other_boxes, own_boxes
from basu.metrics.fault import responsibility
from basu.output.report.scenarios.drawing.canvas import WIDTH_PX, Canvas
from basu.output.report.templates import e, number
from fakes.encounters import Encounter, Road, by_nuplan, encounters

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

DOCS = Path(__file__).parent.parent / "docs"
PAGE = DOCS / "reference" / "fault.md"
HEAD = """# Fault: ten encounters

<!-- written by scripts/make_fault_page.py -->

One function, `responsibility` in `basu.metrics.fault`, decides from the record alone whether the ego is at fault for a
collision, with the reason in words. Reports, campaigns, cases and the rule of success ask it.
[Metrics](metrics.md#responsibility-for-a-collision) has its clauses, [0107](../decisions/0107-fault.md) the reasons.

nuPlan classifies by the contact alone, and what led to it does not count. An ego that stands is not at fault. An ego
that drives into something at rest is. An ego that is struck from behind is not at fault. An ego that meets the other
with its front is. A contact of the ego's side is its fault unless the ego is within one lane.

The pictures show the way of the last five seconds. The ego is blue, the other is orange. Both are solid at the moment
of the contact, and paler one and two seconds before it. North is up. The verdicts are checked by
`packages/basu/tests/metrics/test_fault.py`.

"""
EGO, THEM = "#1f5fa8", "#d9690f"
GROUND, ASPHALT, MARKING, PAPER = "#e9efe4", "#b9bdc2", "#f7f7f7", "#ffffff"
HEIGHT_PX, SHOWN_M = 220.0, 52.0
LAST_S, GHOST_S = 5.0, 1.0


def page(found: tuple[Encounter, ...]) -> str:
    """Return the page of faults as Markdown."""
    lines = [HEAD + "| | encounter | BASU | nuPlan |", "|---|---|---|---|"]
    sections = []
    for index, one in enumerate(found, 1):
        said = responsibility(one.history, one.history.collisions[0])
        nuplan = "at fault" if by_nuplan(one.history) else "not at fault"
        ours = "at fault" if said.at_fault else "not at fault"
        lines.append(f"| {index} | {one.title} | {ours} | {nuplan} |")
        sections.append(
            f"\n## {index}. {one.title}\n\n![{one.title}](../images/{picture_file(index).name})\n\n"
            f"- BASU: {said.sentence}.\n- nuPlan: {nuplan} (`{said.kind.value}`).\n"
        )
    return "\n".join(lines) + "\n" + "".join(sections)


def picture_file(index: int) -> Path:
    """Return the file of a picture."""
    return DOCS / "images" / f"fault-{index}.svg"


def picture(one: Encounter) -> str:
    """Return an encounter from above as SVG."""
    history = one.history
    frames = history.frames
    own = own_boxes(history.facts, frames)
    others = history.others
    theirs = other_boxes(history.facts, others)
    middle_m = (own[-1, :2] + theirs[-1, :2]) / 2.0
    scale = WIDTH_PX / SHOWN_M
    canvas = Canvas(float(middle_m[0]) - SHOWN_M / 2.0, float(middle_m[1]) - HEIGHT_PX / scale / 2.0, scale, HEIGHT_PX)
    step_s = history.facts.step_s
    ghosts = [back for back in (2, 1) if round(back * GHOST_S / step_s) < len(frames)]
    trail = max(0, len(frames) - 1 - round(LAST_S / step_s))
    drawn = e(
        "svg",
        e("title", one.title),
        e("rect", width=WIDTH_PX, height=HEIGHT_PX, fill=GROUND),
        *(_road(canvas, road) for road in one.roads),
        *(_trail(canvas, boxes[trail:], colour) for boxes, colour in ((own, EGO), (theirs, THEM))),
        *(
            _box(canvas, boxes[-1 - round(back * GHOST_S / step_s)], colour, 0.6 / (1 + back))
            for back in ghosts
            for boxes, colour in ((own, EGO), (theirs, THEM))
        ),
        *(_box(canvas, boxes[-1], colour, 0.9) for boxes, colour in ((theirs, THEM), (own, EGO))),
        *_lines_of_route(canvas, one),
        *_scale(canvas),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {number(WIDTH_PX)} {number(HEIGHT_PX)}",
        width=WIDTH_PX,
        height=HEIGHT_PX,
        font_family="sans-serif",
        font_size=12,
    )
    return tostring(drawn, encoding="unicode") + "\n"


def _road(canvas: Canvas, road: Road) -> Element:
    """A band of asphalt, or a dashed line between lanes."""
    return e(
        "path",
        d=canvas.line(road.ends_m),
        stroke=MARKING if road.is_lane_line else ASPHALT,
        stroke_width=road.width_m * canvas.pixels_per_m,
        stroke_dasharray="18 18" if road.is_lane_line else None,
        fill="none",
    )


def _trail(canvas: Canvas, boxes: NDArray[np.float64], colour: str) -> Element:
    """The way of a box's middle."""
    points = [(float(x_m), float(y_m)) for x_m, y_m in boxes[:, :2]]
    return e("path", d=canvas.line(points), stroke=colour, stroke_width=1.5, stroke_dasharray="4 3", fill="none")


def _box(canvas: Canvas, box: NDArray[np.float64], colour: str, opacity: float) -> Element:
    """A box from above with a mark at its front."""
    x_m, y_m, yaw_rad, half_length_m, half_width_m = box.tolist()
    turn = np.array([[np.cos(yaw_rad), -np.sin(yaw_rad)], [np.sin(yaw_rad), np.cos(yaw_rad)]])
    shape = [(1.0, -0.55), (1.0, 0.55), (0.7, 1.0), (-1.0, 1.0), (-1.0, -1.0), (0.7, -1.0)]
    corners = [
        (np.array([x_m, y_m]) + turn @ np.array([ahead * half_length_m, side * half_width_m])) for ahead, side in shape
    ]
    placed = [(float(x), float(y)) for x, y in corners]
    return e("path", d=canvas.line(placed) + "Z", fill=colour, fill_opacity=opacity, stroke=PAPER, stroke_width=0.7)


def _lines_of_route(canvas: Canvas, one: Encounter) -> Iterator[Element]:
    """Stop lines of the ego's route, with what stands at them."""
    for control in one.history.facts.route.controls:
        ends = [(control.x_m, control.y_m - 1.75), (control.x_m, control.y_m + 1.75)]
        red = control.kind.value == "traffic_light" and one.history.frames["route_light"][-1] == 0
        colour = "#c62828" if red or control.kind.value == "stop_sign" else "#2e7d32"
        yield e("path", d=canvas.line(ends), stroke=colour, stroke_width=4.0)
        x_px, y_px = canvas.at(control.x_m, control.y_m + 3.6)
        word = "stop" if control.kind.value == "stop_sign" else "red" if red else "green"
        yield e("text", word, x=x_px, y=y_px, fill=colour, text_anchor="middle")


def _scale(canvas: Canvas) -> Iterator[Element]:
    """A bar of 5 m."""
    y_px = HEIGHT_PX - 10.0
    yield e("path", d=f"M10 {number(y_px)}h{number(5.0 * canvas.pixels_per_m)}", stroke="#333", stroke_width=2)
    yield e("text", "5 m", x=10, y=y_px - 5.0, fill="#333")


def files() -> dict[Path, str]:
    """Return the page and its pictures."""
    found = encounters()
    return {PAGE: page(found), **{picture_file(index): picture(one) for index, one in enumerate(found, 1)}}


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, files))
