"""``picture.svg`` of a case: the place from above, every trail, and the moment of least distance."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import tostring

from basu.output.report.scenarios.drawing.canvas import WIDTH_PX, canvas_for, what_matters
from basu.output.report.scenarios.drawing.encounter import story_of
from basu.output.report.scenarios.drawing.film import film
from basu.output.report.scenarios.drawing.labels import HEIGHT_PX, legend, scale
from basu.output.report.scenarios.drawing.scene import Scene
from basu.output.report.scenarios.tally import LOOKS
from basu.output.report.templates import e, extended, number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.drawing.encounter import CaseData
    from basu.output.report.streets import Line
    from basu.records.history import History


PICTURE_FILE = "picture.svg"
STYLE_FILE = Path(__file__).parent / "picture.css"
SCRIPT_FILE = Path(__file__).parent / "film.js"
HEAD_PX = 26.0  # of the line above a picture that stands by itself


@functools.lru_cache
def picture_style() -> str:
    """The style that a page with such pictures needs."""
    return STYLE_FILE.read_text(encoding="utf-8")


@functools.lru_cache
def film_script() -> str:
    """Return the script that plays the films of a page."""
    return SCRIPT_FILE.read_text(encoding="utf-8")


def case_picture(result: Mapping[str, Any], history: History, streets: Sequence[Line]) -> str:
    """A file of its own: SVG with a headline and its style in it."""
    picture = case_drawing(result, history, streets, head_px=HEAD_PX)
    picture.set("xmlns", "http://www.w3.org/2000/svg")
    picture.insert(0, e("style", picture_style()))
    look = LOOKS[result["verdict"]]
    picture.append(
        e("text", f"{result['id']}, {result['agent']}: {look.sign} {look.word}", x=8, y=18 - HEAD_PX, class_="strong")
    )
    return tostring(picture, encoding="unicode") + "\n"


def case_drawing(
    result: Mapping[str, Any], history: History, streets: Sequence[Line], head_px: float = 0.0, *, moves: bool = False
) -> Element:
    """The picture as a part of a page that has ``picture_style()``; ``head_px`` are left free above it.

    If ``moves``, the film of the case is in it as well, which `film_script` shows.
    """
    story = story_of(result, history)
    canvas = canvas_for(what_matters(story))
    scene = Scene(story, canvas)
    height_px = canvas.height_px
    view = " ".join(number(v, 1) for v in (0.0, -head_px, WIDTH_PX, height_px + HEIGHT_PX + head_px))
    inside = e("svg", e("rect", width=WIDTH_PX, height=height_px, class_="paper"), width=WIDTH_PX, height=height_px)
    extended(inside, [*scene.draw(streets), film(story, canvas) if moves else None, *scale(canvas)])
    return e(
        "svg",
        e("title", _title(story)),
        e("rect", y=-head_px, width=WIDTH_PX, height=height_px + HEIGHT_PX + head_px, class_="below"),
        inside,
        e("rect", x=0.5, y=0.5, width=WIDTH_PX - 1.0, height=height_px - 1.0, class_="frame"),
        legend(height_px, scene.shown),
        class_="case-picture",
        viewBox=view,
        role="img",
    )


def _title(story: CaseData) -> str:
    """The picture in a sentence, for screen readers."""
    met, result = story.met, story.result
    what = f"{result['id']} with {result['agent']} from above, north is up"
    if met is None:
        return f"{what}; no actor was near"
    t_s = float(story.history.frames["t_s"][met.tick])
    return f"{what}; least distance {met.distance_m:.2f} m to {met.other} at {t_s:.1f} s"
