"""The body of a car as a closed solid, from the silhouette of its blueprint.

The silhouettes are shares of the vehicles' boxes, in ``data/silhouettes.json``. The solid consists of rings across the
car from the rear to the front, with wheel arches and window panes.
"""

import json
from functools import lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.scenery.mesh import Mesh
from linden.structured import StructuredArray
from linden_maps.models.solids import GLASS, HEAD, PAINT, TAIL, TRIM, FaceLook, faces_of, loft

F64 = NDArray[np.float64]
Span = tuple[float, float]


class Silhouette(NamedTuple):
    """A body from the side and from above, as data/silhouettes.json explains; lines are (N, 2) of x and share."""

    top: F64
    waist: F64
    bottom: F64
    plan: F64
    tumblehome: float  # how much narrower the roof is than the waist, as a share of the half width
    side_glass: tuple[Span, ...]
    glass_doors: tuple[Span, ...]
    rear_window: Span
    windscreen: Span
    grille: Span
    wide_lamps: bool


@lru_cache(maxsize=1)
def silhouettes() -> dict[str, Silhouette]:
    """Return the silhouette of each blueprint that has one, by its id."""
    facts = json.loads(resources.files("linden_maps").joinpath("data/silhouettes.json").read_text("utf-8"))
    styles = {name: _silhouette(own) for name, own in facts["styles"].items()}
    return {blueprint_id: styles[style] for blueprint_id, style in facts["bodies"].items()}


def _silhouette(facts: dict[str, Any]) -> Silhouette:
    top, waist, bottom, plan = (np.array(facts[line], np.float64) for line in ("top", "waist", "bottom", "plan"))
    return Silhouette(
        top=top,
        waist=waist,
        bottom=bottom,
        plan=plan,
        tumblehome=facts["tumblehome"],
        side_glass=tuple((low, high) for low, high in facts["side_glass"]),
        glass_doors=tuple((low, high) for low, high in facts.get("glass_doors", ())),
        rear_window=(facts["rear_window"][0], facts["rear_window"][1]),
        windscreen=(facts["windscreen"][0], facts["windscreen"][1]),
        grille=(facts["grille"][0], facts["grille"][1]),
        wide_lamps=facts["wide_lamps"],
    )


PROUD_M = 0.012
"""How far what is mounted stands off a body; the body is that much shorter than its box at either end."""

_ARCH_GAP_M = 0.055
"""Between a tyre and the arch over it."""

_EDGE_M = 0.003
"""How far apart two rings are where the outline jumps."""

_SAME_M = 0.008
"""Rings closer than this are one."""

_BANDS = 8
"""Points of a ring on either side: sill, lip, flank, crease, waist, roof's edge, shoulder, roof."""

_LAMPS, _PANE, _SHOULDER, _ROOF = 3, 4, 6, 7
"""Bands by the point that they begin at: lamps, side window, the outer and the middle part of what is above."""

_LAMPS_ROUND_CORNER = 0.045
"""The share of the length that lamps reach back along the flank."""


class BodyFrame(NamedTuple):
    """Where a body lies in its vehicle's frame, m."""

    rear: float
    front: float
    half_width: float
    roof: float  # over the ground
    axles: tuple[float, ...]  # x of each
    wheel_radius: float

    def x(self, share: F64 | float) -> F64:
        """Return x of shares of the length."""
        return np.asarray(self.rear + np.asarray(share) * (self.front - self.rear))

    def at(self, line: F64, x: F64 | float) -> F64:
        """Return what a line of a silhouette says at x."""
        return np.interp((np.asarray(x) - self.rear) / (self.front - self.rear), line[:, 0], line[:, 1])


def hull(shape: Silhouette, frame: BodyFrame, *, is_cab: bool = False) -> Mesh:
    """Return the body of a car, or a truck's cab, which has no lamps behind, without what is put upon it."""
    x = _stations(shape, frame)
    rear, front = (_end(look) for look in (TAIL, HEAD))
    sides = _panes(shape, frame, x)
    if not shape.wide_lamps:
        front[_LAMPS] = faces_of(PAINT)
    if not shape.wide_lamps or is_cab:
        rear[_LAMPS] = faces_of(PAINT)
    if is_cab:
        sides[sides["lamp"] == TAIL.lamp] = faces_of(PAINT)
    return loft(_rings(shape, frame, x), sides, rear, front)


def _end(lamps: FaceLook) -> StructuredArray:
    """Return how the strips (8,) of an end look: bumper, lamps, body."""
    looks = faces_of(PAINT, _BANDS)
    looks[:2] = faces_of(TRIM)
    looks[_LAMPS] = faces_of(lamps)
    return looks


def half_width(shape: Silhouette, frame: BodyFrame, x: F64 | float) -> F64:
    """Return how far the flanks are from the middle at x, m."""
    return frame.half_width * frame.at(shape.plan, x)


def top(shape: Silhouette, frame: BodyFrame, x: F64 | float) -> F64:
    """Return the height of the middle line at x, m."""
    return frame.roof * frame.at(shape.top, x)


def _stations(shape: Silhouette, frame: BodyFrame) -> F64:
    """Return where the rings are, from the rear to the front, m."""
    shares = [line[:, 0] for line in (shape.top, shape.plan)]
    edges = [shape.rear_window, shape.windscreen, *shape.side_glass]
    needed = [frame.x(np.concatenate([*shares, *map(np.asarray, edges)]))]
    arch_m = frame.wheel_radius + _ARCH_GAP_M
    for axle in frame.axles:
        around = axle + arch_m * np.cos(np.linspace(0.0, np.pi, 9))
        needed += [around, np.array([axle - arch_m - _EDGE_M, axle + arch_m + _EDGE_M])]
    ends_first = np.concatenate([*needed[1:], needed[0]])
    kept: list[float] = []
    for x in np.concatenate([[frame.rear, frame.front], ends_first]):
        apart = _EDGE_M * 0.5 if len(kept) < 2 + sum(map(len, needed[1:])) else _SAME_M
        if all(abs(x - other) > apart for other in kept) and frame.rear <= x <= frame.front:
            kept.append(float(x))
    return np.sort(kept)


def ring_heights(shape: Silhouette, frame: BodyFrame, x: float) -> tuple[float, float, float]:
    """Return the heights of flank, crease and waist at x, m; there are lamps between the last two at either end."""
    _, flank, crease, waist, _ = (float(line[0]) for line in _lines(shape, frame, np.array([x])))
    return flank, crease, waist


def _lines(shape: Silhouette, frame: BodyFrame, x: F64) -> tuple[F64, F64, F64, F64, F64]:
    """Return the heights (S,) of bottom, flank, crease, waist and top."""
    top_m = top(shape, frame, x)
    waist_m = np.minimum(frame.roof * frame.at(shape.waist, x), top_m - 0.03)
    bottom_m = np.minimum(_bottom(shape, frame, x), waist_m - 0.06)
    flank_m = np.maximum(frame.wheel_radius * 1.05, bottom_m + 0.25 * (waist_m - bottom_m))
    return bottom_m, flank_m, flank_m + 0.7 * (waist_m - flank_m), waist_m, top_m


def _rings(shape: Silhouette, frame: BodyFrame, x: F64) -> F64:
    """Return the rings (S, 16, 3), each from the right sill over the roof to the left one."""
    bottom_m, flank_m, crease_m, waist_m, top_m = _lines(shape, frame, x)
    wide_m = half_width(shape, frame, x)
    edge_m = waist_m + (top_m - waist_m) * 0.88  # roof's edge or bonnet's
    above = (top_m - waist_m) / (frame.roof * (1.0 - float(frame.at(shape.waist, frame.x(0.5)))))
    roof_m = wide_m * (0.965 - shape.tumblehome * np.clip(above, 0.0, 1.0))
    heights = (bottom_m, bottom_m + 0.015, flank_m, crease_m, waist_m, edge_m, edge_m + 0.6 * (top_m - edge_m), top_m)
    widths = (0.93 * wide_m, 0.985 * wide_m, wide_m, 0.99 * wide_m, 0.965 * wide_m, roof_m, 0.93 * roof_m, 0.5 * roof_m)
    right = np.stack([np.stack(widths, 1), np.stack(heights, 1)], 2)
    across = np.concatenate([right, right[:, ::-1] * (-1.0, 1.0)], 1)
    return np.concatenate([np.broadcast_to(x[:, None, None], (len(x), 2 * _BANDS, 1)), across], 2)


def _bottom(shape: Silhouette, frame: BodyFrame, x: F64) -> F64:
    """Return how low the flanks reach: to the sills, and over the wheels."""
    bottom_m = frame.roof * frame.at(shape.bottom, x)
    arch_m = frame.wheel_radius + _ARCH_GAP_M
    for axle in frame.axles:
        inside = np.abs(x - axle) <= arch_m + 1e-6
        over_m = frame.wheel_radius + np.sqrt(np.maximum(arch_m**2 - (x - axle) ** 2, 0.0))
        bottom_m = np.where(inside, np.maximum(bottom_m, over_m), bottom_m)
    return bottom_m


def _panes(shape: Silhouette, frame: BodyFrame, x: F64) -> StructuredArray:
    """Return how the sides (S - 1, 16) of a hull look: painted, with windows; dark below."""
    middle = 0.5 * (x[1:] + x[:-1])
    looks = faces_of(PAINT, len(middle), 2 * _BANDS)
    looks[:, 2 * _BANDS - 1] = faces_of(TRIM)
    looks[:, [0, 2 * _BANDS - 2]] = faces_of(TRIM)
    sides, ahead = (
        _within(frame, middle, shape.side_glass),
        _within(frame, middle, (shape.rear_window, shape.windscreen)),
    )
    if shape.wide_lamps:
        _set(looks, middle > frame.x(1.0 - _LAMPS_ROUND_CORNER), _LAMPS, HEAD)
        _set(looks, middle < frame.x(0.7 * _LAMPS_ROUND_CORNER), _LAMPS, TAIL)
    for band in range(1, _PANE):
        _set(looks, _within(frame, middle, shape.glass_doors), band, GLASS)
    _set(looks, sides, _PANE, GLASS)
    _set(looks, ahead, _SHOULDER, GLASS)
    looks[ahead, _ROOF] = faces_of(GLASS)
    return looks


def _set(looks: StructuredArray, where: NDArray[np.bool_], band: int, look: FaceLook) -> None:
    """Give a band of either side a look."""
    for row in (band, 2 * _BANDS - 2 - band):
        looks[where, row] = faces_of(look)


def _within(frame: BodyFrame, x: F64, spans: tuple[tuple[float, float], ...]) -> NDArray[np.bool_]:
    inside = np.zeros(len(x), np.bool_)
    for low, high in spans:
        inside |= (x > frame.x(low)) & (x < frame.x(high))
    return inside
