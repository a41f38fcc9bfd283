"""Draws a map as SVG: north up, one unit a metre, x and y as in CARLA, so a place can be read off with a pointer."""

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.signals import place
from linden.maps.opendrive.spawn_points import spawn_points
from linden_maps.drawing.labels import frame, street_names
from linden_maps.drawing.style import GRASS
from linden_maps.drawing.surfaces import marks, surfaces
from linden_maps.drawing.symbols import objects, signals, spawn_marks

_MARGIN = 0.04  # of the longer side
_LONGER_SIDE_PX = 1800
_LINES = 50.0  # as many lines of text would fill the longer side
_LEGEND_LINES = 9.0, 22.0  # width and height of title, legend and scale bar, which stand left of the map
_NAME_SIZE_M = 4.5  # street names stay within their street


def svg(opendrive: OpenDrive) -> str:
    """Return the text of an SVG file."""
    tables = tables_of(opendrive)
    vertices = road_mesh(opendrive).vertices
    low, high = (
        (vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)) if len(vertices) else ((0.0, 0.0), (1.0, 1.0))
    )
    side_m = max(float(high[0] - low[0]), float(high[1] - low[1]), 50.0)
    margin_m = _MARGIN * side_m
    unit_m = side_m / _LINES
    legend_width_m, legend_height_m = (lines * unit_m for lines in _LEGEND_LINES)
    left, top = float(low[0]) - margin_m - legend_width_m, float(low[1]) - margin_m
    width, height = float(high[0]) + margin_m - left, float(high[1]) + margin_m - top
    if height < legend_height_m:  # a single street: its middle stays in the middle
        top, height = top - (legend_height_m - height) / 2.0, legend_height_m
    scale = _LONGER_SIDE_PX / max(width, height)
    view_box = f"{left:.1f} {top:.1f} {width:.1f} {height:.1f}"
    size = f'width="{width * scale:.0f}" height="{height * scale:.0f}" viewBox="{view_box}"'
    ground = f'<rect x="{left:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{GRASS}"/>'
    layers = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif">',
        ground,
        *surfaces(tables),
        *marks(tables),
        *objects(tables),
        *spawn_marks(spawn_points(opendrive)),
        *signals(place(opendrive)),
        *street_names(tables, _NAME_SIZE_M),
        *frame(opendrive, (left, top, width, height), unit_m),
        "</svg>\n",
    ]
    return "\n".join(layers)
