"""Readers of positions, routes and trajectories."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.reading.catalogs import referred
from basu_openscenario.reading.positions import (
    ClothoidPiece,
    ClothoidSpec,
    ClothoidSplineSpec,
    ControlPoint,
    LanePosition,
    NurbsSpec,
    Orientation,
    PolylineSpec,
    Position,
    RelativeLanePosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoadPosition,
    RoutePosition,
    RouteSpec,
    TrajectoryPosition,
    TrajectorySpec,
    Waypoint,
    WorldPosition,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.xml_node import Node


def read_position(holder: Node, catalogs: Catalogs) -> Position:
    """Return the position inside an element such as ``Position``.

    Raises:
        ScenarioError: there is none, or it is of a kind that is not supported.
    """
    node = holder.only()
    if node.tag not in POSITIONS:
        raise node.fault(f"<{node.tag}> is not supported; use one of {', '.join(POSITIONS)}")
    return POSITIONS[node.tag](node, catalogs)


def _orientation(node: Node) -> Orientation:
    """Return the ``Orientation`` inside a position."""
    found = node.find("Orientation")
    if found is None:
        return Orientation()
    h_rad, p_rad, r_rad = (found.number(name) if found.has(name) else None for name in ("h", "p", "r"))
    is_relative = found.choice("type", ("absolute", "relative"), "absolute") == "relative"
    return Orientation(h_rad, p_rad, r_rad, is_relative)


def _world(node: Node, _: Catalogs) -> Position:
    """Return a ``WorldPosition``; its angles stand among its own attributes."""
    h, p, r = (node.number(name) if node.has(name) else None for name in ("h", "p", "r"))
    z = node.number("z") if node.has("z") else None
    return WorldPosition(node.number("x"), node.number("y"), z, Orientation(h, p, r))


def _lane(node: Node, _: Catalogs) -> Position:
    """Return a ``LanePosition``."""
    return LanePosition(
        node.text("roadId"), node.integer("laneId"), node.number("s"), node.number("offset", 0.0), _orientation(node)
    )


def _road(node: Node, _: Catalogs) -> Position:
    """Return a ``RoadPosition``."""
    return RoadPosition(node.text("roadId"), node.number("s"), node.number("t"), _orientation(node))


def _relative_lane(node: Node, _: Catalogs) -> Position:
    """Return a ``RelativeLanePosition``."""
    along_lane = not node.has("ds")
    if along_lane and not node.has("dsLane"):
        raise node.fault("<RelativeLanePosition> has neither 'ds' nor 'dsLane'; add one of them")
    return RelativeLanePosition(
        node.text("entityRef"),
        node.integer("dLane"),
        node.number("dsLane" if along_lane else "ds"),
        along_lane,
        node.number("offset", 0.0),
        _orientation(node),
    )


def _relative_road(node: Node, _: Catalogs) -> Position:
    """Return a ``RelativeRoadPosition``."""
    return RelativeRoadPosition(node.text("entityRef"), node.number("ds"), node.number("dt"), _orientation(node))


def _relative_world(node: Node, _: Catalogs) -> Position:
    """Return a ``RelativeWorldPosition``."""
    return RelativeWorldPosition(
        node.text("entityRef"),
        node.number("dx"),
        node.number("dy"),
        node.number("dz") if node.has("dz") else None,
        _orientation(node),
    )


def _relative_object(node: Node, _: Catalogs) -> Position:
    """Return a ``RelativeObjectPosition``."""
    return RelativeObjectPosition(
        node.text("entityRef"),
        node.number("dx"),
        node.number("dy"),
        node.number("dz") if node.has("dz") else None,
        _orientation(node),
    )


def _on_route(node: Node, catalogs: Catalogs) -> Position:
    """Return a ``RoutePosition``."""
    route = read_route(node.child("RouteRef"), catalogs)
    inside = node.child("InRoutePosition").only()
    orientation = _orientation(node)
    if inside.tag == "FromRoadCoordinates":
        return RoutePosition(route, inside.number("pathS"), inside.number("t"), None, 0.0, orientation)
    if inside.tag == "FromLaneCoordinates":
        lane, offset_m = inside.integer("laneId"), inside.number("laneOffset", 0.0)
        return RoutePosition(route, inside.number("pathS"), None, lane, offset_m, orientation)
    raise inside.fault(f"<{inside.tag}> is not supported; use FromRoadCoordinates or FromLaneCoordinates")


def _on_trajectory(node: Node, catalogs: Catalogs) -> Position:
    """Return a ``TrajectoryPosition``."""
    trajectory = read_trajectory(node.child("TrajectoryRef"), catalogs)
    return TrajectoryPosition(trajectory, node.number("s"), node.number("t", 0.0), _orientation(node))


def read_route(holder: Node, catalogs: Catalogs) -> RouteSpec:
    """Return the route inside ``holder``, written out or by reference.

    Raises:
        ScenarioError: there is none, or it has fewer than two places.
    """
    node = referred(holder, "Route", catalogs)
    points = [
        Waypoint(read_position(one.child("Position"), catalogs), one.text("routeStrategy", "shortest"))
        for one in node.children("Waypoint")
    ]
    if len(points) < 2:
        raise node.fault(f"the route has {len(points)} waypoints; it needs two or more")
    return RouteSpec(node.text("name"), node.boolean("closed"), tuple(points))


def read_trajectory(holder: Node, catalogs: Catalogs) -> TrajectorySpec:
    """Return the trajectory inside ``holder``, written out or by reference.

    Raises:
        ScenarioError: there is none, or its shape is not supported.
    """
    node = referred(holder, "Trajectory", catalogs)
    shape = node.child("Shape").only()
    if shape.tag not in SHAPES:
        raise shape.fault(f"<{shape.tag}> is not supported; use one of {', '.join(SHAPES)}")
    return TrajectorySpec(node.text("name"), node.boolean("closed", default=False), SHAPES[shape.tag](shape, catalogs))


def _time(node: Node, name: str = "time") -> float | None:
    """Return a time in s; None where the file gives none."""
    return node.number(name) if node.has(name) else None


def _polyline(node: Node, catalogs: Catalogs) -> PolylineSpec:
    """Return a ``Polyline``."""
    found = tuple((read_position(one.child("Position"), catalogs), _time(one)) for one in node.children("Vertex"))
    if len(found) < 2:
        raise node.fault(f"the polyline has {len(found)} vertices; it needs two or more")
    return PolylineSpec(found)


LONGEST_TRAJECTORY_M = 1e5
"""A trajectory above this is refused: it is cut into pieces of a metre."""


def _length(node: Node) -> float:
    """Return the length of a curve in m.

    Raises:
        ScenarioError: it is negative, or too large.
    """
    length_m = node.number("length")
    if not 0.0 <= length_m <= LONGEST_TRAJECTORY_M:
        raise node.fault(
            f"a curve of {length_m:g} m is not supported; its length must be from 0 to {LONGEST_TRAJECTORY_M:g} m"
        )
    return length_m


def _clothoid(node: Node, catalogs: Catalogs) -> ClothoidSpec:
    """Return a ``Clothoid``; version 1.0 calls the change of curvature ``curvatureDot``."""
    prime = "curvaturePrime" if node.has("curvaturePrime") else "curvatureDot"
    return ClothoidSpec(
        read_position(node.child("Position"), catalogs),
        node.number("curvature"),
        node.number(prime, 0.0),
        _length(node),
        _time(node, "startTime"),
        _time(node, "stopTime"),
    )


def _clothoid_spline(node: Node, catalogs: Catalogs) -> ClothoidSplineSpec:
    """Return a ``ClothoidSpline``; a curvature that is missing goes on from the piece before."""
    pieces: list[ClothoidPiece] = []
    for one in node.children("ClothoidSplineSegment", "Segment"):
        before = pieces[-1].end_per_m if pieces else 0.0
        start = one.number("curvatureStart", one.number("curvStart", before))
        position = one.find("PositionStart")
        pieces.append(
            ClothoidPiece(
                None if position is None else read_position(position, catalogs),
                start,
                one.number("curvatureEnd", one.number("curvEnd", start)),
                _length(one),
                one.number("hOffset", 0.0),
                _time(one, "timeStart"),
            )
        )
    if not pieces:
        raise node.fault("<ClothoidSpline> has no segment; add a <ClothoidSplineSegment>")
    return ClothoidSplineSpec(tuple(pieces), _time(node, "timeEnd"))


def _nurbs(node: Node, catalogs: Catalogs) -> NurbsSpec:
    """Return a ``Nurbs``."""
    order = node.integer("order")
    points = tuple(
        ControlPoint(read_position(one.child("Position"), catalogs), one.number("weight", 1.0), _time(one))
        for one in node.children("ControlPoint")
    )
    knots = tuple(one.number("value") for one in node.children("Knot"))
    if order < 2 or len(points) < order or len(knots) != len(points) + order:
        raise node.fault(
            f"order {order}, {len(points)} control points and {len(knots)} knots do not fit: "
            "knots are as many as control points and the order together, and no fewer points than the order"
        )
    if list(knots) != sorted(knots):
        raise node.fault("the knots do not go up; sort them")
    return NurbsSpec(order, points, knots)


POSITIONS: dict[str, Callable[[Node, Catalogs], Position]] = {
    "WorldPosition": _world,
    "LanePosition": _lane,
    "RoadPosition": _road,
    "RelativeLanePosition": _relative_lane,
    "RelativeRoadPosition": _relative_road,
    "RelativeWorldPosition": _relative_world,
    "RelativeObjectPosition": _relative_object,
    "RoutePosition": _on_route,
    "TrajectoryPosition": _on_trajectory,
}
"""The reader of each position, by its element."""

SHAPES: dict[str, Callable[[Node, Catalogs], PolylineSpec | ClothoidSpec | ClothoidSplineSpec | NurbsSpec]] = {
    "Polyline": _polyline,
    "Clothoid": _clothoid,
    "ClothoidSpline": _clothoid_spline,
    "Nurbs": _nurbs,
}
"""The reader of each shape of a trajectory, by its element."""
