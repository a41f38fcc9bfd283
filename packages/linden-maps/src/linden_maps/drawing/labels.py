"""Draws the words: street names along their streets, title, scale bar, north arrow, and what the signs mean."""

import math
from collections import defaultdict
from xml.sax.saxutils import escape

import numpy as np

from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType
from linden_maps.drawing.style import (
    BUILDING,
    GREEN,
    INK,
    OTHER_SURFACE,
    PAINT,
    RAILROAD,
    RED,
    SPAWN,
    SURFACES,
    YELLOW,
    group,
)
from linden_maps.statistics import is_building, is_railroad

_NAME_SPACING_M = 350.0  # between two names of one street
_LETTER_M = 0.55  # of the font's size: mean width of a letter


def street_names(tables: Tables, size_m: float) -> list[str]:
    """Return each street's name along its longest roads, no two of one street near each other."""
    named = defaultdict(list)
    for index, road in enumerate(tables.roads):
        if road.name and not road.is_in_junction:
            named[road.name].append(index)
    texts = []
    for name, roads in named.items():
        taken: list[tuple[float, float]] = []
        if sum(tables.road_length_m[roads]) < _LETTER_M * size_m * len(name):
            continue  # it would reach far beyond its street
        for index in sorted(roads, key=lambda road: (-tables.road_length_m[road], road)):
            length_m = tables.road_length_m[index]
            pose = tables.curves.pose(np.array([index]), np.array([length_m / 2.0]))
            x, y = float(pose.x_m[0]), -float(pose.y_m[0])
            long_enough = length_m > _LETTER_M * size_m * len(name) or not taken
            if long_enough and all(math.dist((x, y), other) > _NAME_SPACING_M for other in taken):
                taken.append((x, y))
                angle = -math.degrees(float(pose.heading_rad[0]))
                upright = math.remainder(angle, 180.0)
                turn = f'transform="translate({x:.1f} {y:.1f}) rotate({upright:.1f})"'
                texts.append(f'<text {turn} dy="0.35em">{escape(name)}</text>')
    style = (
        f'fill="{INK}" font-size="{size_m:.1f}" text-anchor="middle" paint-order="stroke" '
        f'stroke="{PAINT}" stroke-width="{size_m / 6.0:.2f}" stroke-opacity="0.85"'
    )
    return group("street-names", style, texts)


def frame(opendrive: OpenDrive, box: tuple[float, float, float, float], unit_m: float) -> list[str]:
    """Return title, legend, scale bar, north arrow. ``box``: left, top, width, height; ``unit_m``: a line's height."""
    left, top, width, height = box
    title = f'<text x="{left + unit_m:.1f}" y="{top + 1.6 * unit_m:.1f}" font-size="{1.4 * unit_m:.1f}" '
    drawn = [f'{title}font-weight="bold">{escape(opendrive.name or "OpenDRIVE map")}</text>']
    drawn += _legend(opendrive, left + unit_m, top + 3.2 * unit_m, unit_m)
    drawn += _scale_bar(left + unit_m, top + height - unit_m, unit_m)
    x, y = left + width - 2.0 * unit_m, top + 3.5 * unit_m
    drawn.append(
        f'<path d="M{x:.1f},{y - 2.2 * unit_m:.1f} l{0.7 * unit_m:.1f},{2.2 * unit_m:.1f} '
        f'l{-0.7 * unit_m:.1f},{-0.5 * unit_m:.1f} l{-0.7 * unit_m:.1f},{0.5 * unit_m:.1f} Z"/>'
        f'<text x="{x:.1f}" y="{y + unit_m:.1f}" font-size="{unit_m:.1f}" text-anchor="middle">N</text>'
    )
    return group("frame", f'fill="{INK}"', drawn)


def _legend(opendrive: OpenDrive, x: float, y: float, unit_m: float) -> list[str]:
    present = {lane.type for road in opendrive.roads for section in road.sections for lane in section.lanes if lane.id}
    rows = [(name, colour) for kind, (name, colour) in SURFACES.items() if kind in present]
    if present - SURFACES.keys() - {LaneType.NONE}:
        rows.append(OTHER_SURFACE)
    things = [thing for road in opendrive.roads for thing in road.objects if len(thing.outline) > 2]
    rows += [("building", BUILDING)] if any(map(is_building, things)) else []
    rows += [("railroad", RAILROAD)] if any(map(is_railroad, things)) else []
    types = {signal.type for _, signal in opendrive.signals()}
    signs = [("stop sign", RED, "206"), ("yield sign", PAINT, "205"), ("speed limit", YELLOW, "274")]
    rows += [(name, colour) for name, colour, kind in signs if kind in types]
    if any(signal.is_light for _, signal in opendrive.signals()):
        rows.append(("traffic light", GREEN))
    rows.append(("spawn point", SPAWN))
    drawn = []
    for nth, (name, colour) in enumerate(rows):
        line = y + nth * 1.1 * unit_m
        drawn.append(
            f'<rect x="{x:.1f}" y="{line - 0.7 * unit_m:.1f}" width="{1.2 * unit_m:.1f}" height="{0.75 * unit_m:.1f}" '
            f'fill="{colour}" stroke="{INK}" stroke-width="{0.04 * unit_m:.2f}"/>'
            f'<text x="{x + 1.6 * unit_m:.1f}" y="{line:.1f}" font-size="{0.8 * unit_m:.1f}">{name}</text>'
        )
    return drawn


def _scale_bar(x: float, y: float, unit_m: float) -> list[str]:
    """Return a bar of 1, 2 or 5 times a power of ten metres, about eight lines long."""
    power = 10.0 ** math.floor(math.log10(8.0 * unit_m))
    length_m = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= 8.0 * unit_m)
    label = f"{length_m / 1000.0:g} km" if length_m >= 1000.0 else f"{length_m:g} m"
    thick = 0.25 * unit_m
    middle, half_m = x + length_m / 2.0, 0.49 * length_m
    inside = f'y="{y - 0.8 * thick:.2f}" width="{half_m:.1f}" height="{0.6 * thick:.2f}" fill="{PAINT}"'
    return [
        f'<rect x="{x:.1f}" y="{y - thick:.2f}" width="{length_m:.1f}" height="{thick:.2f}"/>',
        f'<rect x="{middle:.1f}" {inside}/>',
        f'<text x="{x:.1f}" y="{y - 0.6 * unit_m:.1f}" font-size="{0.8 * unit_m:.1f}">{label}</text>',
    ]
