"""Draws what stands and lies on the road: crosswalks, stop lines, signs, lights, spawn points."""

import math
from collections.abc import Sequence
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.outlines import outline_of
from linden.maps.opendrive.roadside import SPEED_LIMIT_TYPE, STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.maps.records import PlacedSignal
from linden.protocol.values.space import Transform
from linden_maps.drawing.style import BUILDING, GREEN, INK, PAINT, RAILROAD, RED, SPAWN, YELLOW, group, points
from linden_maps.statistics import is_building, is_railroad

_PLACE_NAME_M = 5.0
_SIGN_M = 1.1  # half a sign's size on the picture; true ones would be specks


def objects(tables: Tables) -> list[str]:
    """Return crosswalks as stripes, stop and yield lines as paint, and the outlines of railroads and all else."""
    crosswalks, lines, railroads, others, names = [], [], [], [], []
    for index, road in enumerate(tables.roads):
        for thing in road.objects:
            if len(thing.outline) < 3:
                continue
            outline = outline_of(tables, index, thing)
            shape = f'<polygon points="{points(outline)}"/>'
            if thing.is_crosswalk:
                crosswalks.append(shape)
            elif thing.type.lower() == "roadmark":
                lines.append(shape)
            elif is_railroad(thing):
                railroads.append(shape)
            else:
                others.append(shape)
            if is_building(thing) and " " in thing.name:
                x, y = outline.mean(axis=0)
                names.append(f'<text x="{x:.1f}" y="{y:.1f}">{escape(thing.name)}</text>')
    edge = f'stroke="{PAINT}" stroke-width="0.3"'
    return [
        *group("railroads", f'fill="{RAILROAD}"', railroads),
        *group("objects", f'fill="{BUILDING}" stroke="{INK}" stroke-width="0.1"', others),
        *group("crosswalks", f'fill="{PAINT}" fill-opacity="0.45" stroke-dasharray="0.6 0.6" {edge}', crosswalks),
        *group("lines", f'fill="{PAINT}"', lines),
        *group("places", f'fill="{INK}" font-size="{_PLACE_NAME_M}" text-anchor="middle"', names),
    ]


def signals(placed: Sequence[PlacedSignal]) -> list[str]:
    """Return a sign or light for each signal, and the boxes in which stop signs and lights take effect."""
    boxes = [f'<polygon points="{points(_box(signal, nth))}"/>' for signal in placed for nth in _boxes(signal)]
    return [
        *group("triggers", f'fill="{SPAWN}" fill-opacity="0.25"', boxes),
        *group("signals", 'stroke-linejoin="round"', [_sign(signal) for signal in placed]),
    ]


def _boxes(signal: PlacedSignal) -> range:
    return range(len(signal.trigger_volumes) if signal.is_light or signal.type == STOP_SIGN_TYPE else 0)


def _box(signal: PlacedSignal, nth: int) -> NDArray[np.float64]:
    box, (location, rotation) = signal.trigger_volumes[nth], signal.transform
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * box.extent[:2]
    in_signal = _turned(corners, box.rotation.yaw) + np.array(box.location[:2])
    in_world: NDArray[np.float64] = _turned(in_signal, rotation.yaw) + np.array(location[:2])
    return in_world


def _turned(corners: NDArray[np.float64], yaw_deg: float) -> NDArray[np.float64]:
    cos, sin = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    turned: NDArray[np.float64] = corners @ np.array([[cos, sin], [-sin, cos]])
    return turned


def _sign(signal: PlacedSignal) -> str:
    x, y, _ = signal.transform.location
    size = _SIGN_M
    if signal.is_light:
        lamps = "".join(
            f'<circle cx="{x:.2f}" cy="{y + offset * size:.2f}" r="{0.28 * size:.2f}" fill="{colour}"/>'
            for offset, colour in ((-0.75, RED), (0.0, YELLOW), (0.75, GREEN))
        )
        corner = f'x="{x - 0.45 * size:.2f}" y="{y - 1.2 * size:.2f}"'
        return f'<rect {corner} width="{0.9 * size:.2f}" height="{2.4 * size:.2f}" rx="0.3" fill="{INK}"/>{lamps}'
    if signal.type == STOP_SIGN_TYPE:
        return _polygon(x, y, 8, 22.5, f'fill="{RED}" stroke="{PAINT}" stroke-width="0.2"')
    if signal.type == YIELD_SIGN_TYPE:
        return _polygon(x, y, 3, 90.0, f'fill="{PAINT}" stroke="{RED}" stroke-width="0.35"')
    ring = f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{0.8 * size:.2f}" fill="{PAINT}" stroke="{RED}" stroke-width="0.25"/>'
    if signal.type != SPEED_LIMIT_TYPE or signal.value is None:
        return ring
    text = f'<text x="{x:.2f}" y="{y + 0.3:.2f}" font-size="0.9" text-anchor="middle">{signal.value:g}</text>'
    return ring + text


def _polygon(x: float, y: float, corners: int, first_deg: float, style: str) -> str:
    angles = np.radians(first_deg + 360.0 / corners * np.arange(corners))
    ring = np.stack([x + _SIGN_M * np.cos(angles), y + _SIGN_M * np.sin(angles)], axis=1)
    return f'<polygon points="{points(ring)}" {style}/>'


def spawn_marks(spawn_points: Sequence[Transform]) -> list[str]:
    """Return an arrow head for each spawn point, pointing the way of the traffic."""
    head = np.array([(1.5, 0.0), (-0.9, -0.8), (-0.4, 0.0), (-0.9, 0.8)])
    arrows = [
        f'<polygon points="{points(_turned(head, rotation.yaw) + np.array(location[:2]))}"/>'
        for location, rotation in spawn_points
    ]
    return group("spawn-points", f'fill="{SPAWN}" fill-opacity="0.8"', arrows)
