"""Everybody at one moment from above: boxes with their fronts, the ego filled, the nearest with a heavy outline."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.output.report.markup import e, number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.drawing.canvas import Canvas
    from basu.output.report.scenarios.drawing.encounter import Box, Point

LEAST_HALF_PX = 3.5  # half of the shorter side: a walker is small, and is to be seen
NOSE = 0.55  # from there on a box narrows to its front
ROUND_HALF_M = 0.6  # who is not longer than twice this has no front that could be seen


def body(box: Box, canvas: Canvas, style: str) -> Element:
    """A vehicle, pointed at its front; a circle for somebody on foot."""
    x_m, y_m, _, half_length_m, half_width_m = box.tolist()
    if max(half_length_m, half_width_m) <= ROUND_HALF_M:
        x, y = canvas.at(x_m, y_m)
        radius = max(LEAST_HALF_PX + 1.0, (half_length_m + half_width_m) / 2.0 * canvas.pixels_per_m)
        return e("circle", cx=number(x, 1), cy=number(y, 1), r=number(radius, 1), class_=style)
    return e("polygon", points=_written(outline(box, canvas, nose=NOSE)), class_=style)


def block(box: Box, canvas: Canvas, style: str) -> Element:
    """Something that has no front."""
    return e("polygon", points=_written(outline(box, canvas, nose=1.0)), class_=style)


def outline(box: Box, canvas: Canvas, nose: float) -> list[Point]:
    """The corners in pixels, front left first; ``nose`` is where on its half length a box begins to narrow."""
    x_m, y_m, yaw_rad, half_length_m, half_width_m = box.tolist()
    least_m = LEAST_HALF_PX / canvas.pixels_per_m
    long_m, wide_m = max(half_length_m, least_m), max(half_width_m, least_m)
    corners: Sequence[Point] = [
        (long_m * nose, -wide_m),
        (long_m * nose, wide_m),
        (-long_m, wide_m),
        (-long_m, -wide_m),
    ]
    if nose < 1.0:
        corners = [(long_m, -wide_m * 0.35), (long_m, wide_m * 0.35), *corners[1:], corners[0]]
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return [
        canvas.at(x_m + ahead_m * cos - right_m * sin, y_m + ahead_m * sin + right_m * cos)
        for ahead_m, right_m in corners
    ]


def _written(points_px: Sequence[Point]) -> str:
    return " ".join(f"{number(x, 1)},{number(y, 1)}" for x, y in points_px)
