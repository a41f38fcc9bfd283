"""What ``sensor.camera.cosmos_visualization`` draws: lane lines, kerbs, crosswalks, poles, and boxes of actors.

Source: ``CosmosControlSensor.cpp`` of carla-simulator/carla (commit 084fe059) for colours, widths and which things are
boxes, areas or lines. That sensor draws splines of Unreal's roads; here edges of the map's lanes take their place. A
lane line lies between two driving lanes. A boundary lies beside a pavement or a median, and at the outer edge of a
road. Stop lines are the painted ones of the map. Arrows and other stencils are left out.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive, rotation_matrix
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.outlines import outline_of
from linden.maps.opendrive.parse import parse
from linden.protocol.values.enums import LaneType, SemanticTag
from linden.protocol.values.space import BoundingBox
from linden.sensors.camera.strokes import Strokes, joined
from linden.simulation.queries import body_boxes

if TYPE_CHECKING:
    from linden.maps.ground import Ground
    from linden.scenery.scene.objects import Scene
    from linden.simulation.episode import Episode

F64 = NDArray[np.float64]
Colour = tuple[int, int, int]

LANE_LINE, BOUNDARY, POLE = (98, 183, 249), (200, 36, 35), (66, 40, 144)
WAIT_LINE, CROSSWALK = (185, 63, 34), (206, 131, 63)
SIGN, LIGHT, CAR, PEDESTRIAN = (131, 175, 155), (252, 157, 155), (255, 0, 0), (0, 255, 0)
LINE_M, BOX_M = 0.2, 0.1  # widths, 20 and 10 cm
FRAMED: dict[SemanticTag, Colour] = {
    **dict.fromkeys(
        (
            SemanticTag.CAR,
            SemanticTag.TRUCK,
            SemanticTag.BUS,
            SemanticTag.TRAIN,
            SemanticTag.MOTORCYCLE,
            SemanticTag.BICYCLE,
        ),
        CAR,
    ),
    SemanticTag.PEDESTRIANS: PEDESTRIAN,
}
"""Tags of which the boxes' edges are drawn."""
FILLED: dict[SemanticTag, Colour] = {SemanticTag.TRAFFIC_LIGHT: LIGHT, SemanticTag.TRAFFIC_SIGNS: SIGN}
"""Tags of which the boxes are drawn solid."""
OWN_ROLES = ("hero", "ego_vehicle")  # the first actor with one of these in its role is not drawn

_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1])
_SIDES = np.array([(0, 1, 3), (0, 3, 2), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 3, 7), (2, 7, 6),
                   (0, 2, 6), (0, 6, 4), (1, 3, 7), (1, 7, 5)])  # fmt: skip
_ABOVE_ROAD_M = 0.02  # areas on the road lie above it


def map_strokes(text: str, ground: "Ground") -> Strokes:
    """Return the lines and areas of a map from its OpenDRIVE text."""
    opendrive = parse(text)
    tables = tables_of(opendrive)
    return joined([*_lane_lines(tables), *_areas(tables, ground)])


def scenery_strokes(scene: "Scene", present: NDArray[np.bool_]) -> Strokes:
    """Return the strokes of parked vehicles, poles, signs and lights; ``present`` are the boxes that are there."""
    rows = np.flatnonzero(present & np.isin(scene.boxes["tag"], [*FRAMED, *FILLED, SemanticTag.POLES])).tolist()
    return joined([_of_box(int(scene.boxes["tag"][row]), scene.world_boxes[row]) for row in rows])


def actor_strokes(episode: "Episode", ignored: frozenset[int]) -> Strokes:
    """Return the strokes of vehicles and walkers, without the ego and the ``ignored`` actors."""
    hidden = ignored | _ego(episode)
    return joined([_of_box(tag, box) for tag, box in body_boxes(episode) if box.actor_id not in hidden])


def _of_box(tag: int, box: BoundingBox) -> Strokes:
    """Return the strokes of a box by its tag; none where it is not drawn."""
    if tag in FRAMED:
        return _frame(box, FRAMED[SemanticTag(tag)])
    if tag in FILLED:
        return _solid(box, FILLED[SemanticTag(tag)])
    return _pole(box) if tag == SemanticTag.POLES else Strokes.none()


def _ego(episode: "Episode") -> frozenset[int]:
    """Return the id of the first actor with an ego's role; none where there is none."""
    for record in episode.actors:
        role = record.description.attribute("role_name", "")
        if any(own in role for own in OWN_ROLES):
            return frozenset({record.id})
    return frozenset()


def _corners(box: BoundingBox) -> F64:
    """Return the corners (8, 3) of a box in the world, m."""
    corners: F64 = (_CORNERS * np.asarray(box.extent)) @ rotation_matrix(box.rotation).T + np.asarray(box.location)
    return corners


def _frame(box: BoundingBox, colour: Colour) -> Strokes:
    """Return the twelve edges of a box."""
    corners = _corners(box)
    return _lines(corners[_EDGES[:, 0]], corners[_EDGES[:, 1]], BOX_M, colour)


def _solid(box: BoundingBox, colour: Colour) -> Strokes:
    """Return the six sides of a box."""
    return _triangles(_corners(box)[_SIDES], colour)


def _pole(box: BoundingBox) -> Strokes:
    """Return the middle line of an upright pole; nothing for one that lies, as arms of signals do."""
    x_m, y_m, half_m = box.extent
    if half_m < max(x_m, y_m):
        return Strokes.none()
    middle = np.asarray(box.location)
    up = np.array([0.0, 0.0, half_m])
    return _lines((middle - up)[None], (middle + up)[None], LINE_M, POLE)


def _lane_lines(tables: Tables) -> Iterator[Strokes]:
    """Yield lane lines and boundaries: edges of lanes, by the types of the lanes on both sides."""
    lanes = tables.lanes
    kind = lanes["type_bits"]
    driving = kind == LaneType.DRIVING
    beside = (kind == LaneType.SIDEWALK) | (kind == LaneType.MEDIAN)
    inside = lanes["inside"]
    in_junction = np.array([road.is_in_junction for road in tables.roads], bool)[lanes["road"]]
    outermost = np.ones(len(lanes), bool)
    outermost[inside[inside >= 0]] = False
    of_driving = driving & (inside >= 0) & driving[inside] & ~in_junction
    middle = _middle_rows(tables, driving & ~in_junction)
    yield _edges(tables, np.flatnonzero(of_driving | middle), LANE_LINE, outer=False)
    yield _edges(tables, np.flatnonzero(beside), BOUNDARY, outer=False)
    yield _edges(tables, np.flatnonzero(driving & outermost & ~in_junction), BOUNDARY, outer=True)


def _middle_rows(tables: Tables, driving: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return for each lane whether it is the first to the right of a middle line with driving lanes on both sides."""
    lanes = tables.lanes
    found = np.zeros(len(lanes), bool)
    for row in np.flatnonzero(driving & (lanes["lane_id"] == -1)).tolist():
        other = tables.lane_row.get((int(lanes["road"][row]), int(lanes["section"][row]), 1))
        found[row] = other is not None and bool(driving[other])
    return found


def _edges(tables: Tables, rows: NDArray[np.intp], colour: Colour, *, outer: bool) -> Strokes:
    """Return the edges of lanes as lines."""
    if len(rows) == 0:
        return Strokes.none()
    strips = strips_of(tables, rows)
    edges = edges_of(tables, strips)
    points_m = points_from_opendrive(edges.outer if outer else edges.inner)
    starts = np.flatnonzero(strips.continues)
    return _lines(points_m[starts], points_m[starts + 1], LINE_M, colour)


def _areas(tables: Tables, ground: "Ground") -> Iterator[Strokes]:
    """Yield crosswalks and painted stop lines."""
    for index, road in enumerate(tables.roads):
        for thing in road.objects:
            painted = thing.type.lower() == "roadmark" and "yield" not in thing.name.lower()
            if not (thing.is_crosswalk or painted):
                continue
            outline = outline_of(tables, index, thing)
            if len(outline) >= 3:
                yield _flat(outline[:, :2], ground, CROSSWALK if thing.is_crosswalk else WAIT_LINE)


def _flat(outline: F64, ground: "Ground", colour: Colour) -> Strokes:
    """Return an area on the ground as a fan of triangles, as CARLA's sensor makes it."""
    high = np.column_stack([outline, np.full(len(outline), 1e6)])
    heights_m, _ = ground.surfaces_under(high)
    points_m = np.column_stack([outline, heights_m + _ABOVE_ROAD_M])
    fan = np.array([(0, k, k + 1) for k in range(1, len(points_m) - 1)])
    return _triangles(points_m[fan], colour)


def _lines(start_m: F64, end_m: F64, width_m: float, colour: Colour) -> Strokes:
    """Return lines of one colour."""
    count = len(start_m)
    return Strokes.none()._replace(
        start_m=start_m,
        end_m=end_m,
        width_m=np.full(count, width_m),
        line_colour=np.full((count, 3), colour, np.uint8),
    )


def _triangles(corners_m: F64, colour: Colour) -> Strokes:
    """Return triangles of one colour."""
    return Strokes.none()._replace(corners_m=corners_m, area_colour=np.full((len(corners_m), 3), colour, np.uint8))
