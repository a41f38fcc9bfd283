"""Positions, routes and trajectories as a file writes them; each may be made of the others."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Orientation:
    """Angles in rad; None: not written."""

    h_rad: float | None = None
    p_rad: float | None = None
    r_rad: float | None = None
    relative: bool = False


@dataclass(frozen=True, slots=True)
class WorldPosition:
    """A place in the world; m and rad; None: on the road's surface, and along it."""

    x_m: float
    y_m: float
    z_m: float | None = None
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class LanePosition:
    """A place in a lane: s along the road, offset to the left of the lane's centre, in m."""

    road: str
    lane: int
    s_m: float
    offset_m: float
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RoadPosition:
    """A place on a road: s along it and t to the left of its reference line, in m."""

    road: str
    s_m: float
    t_m: float
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RelativeLanePosition:
    """A place by lanes and metres from an entity; ``along_lane`` counts in the direction of driving."""

    entity: str
    lanes: int
    ds_m: float
    along_lane: bool
    offset_m: float
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RelativeRoadPosition:
    """A place by s and t from an entity, in m."""

    entity: str
    ds_m: float
    dt_m: float
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RelativeWorldPosition:
    """A place by differences from an entity in the world's axes, in m."""

    entity: str
    dx_m: float
    dy_m: float
    dz_m: float | None
    """Above the entity; None: on the road."""
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RelativeObjectPosition:
    """A place by differences from an entity in the entity's axes, in m."""

    entity: str
    dx_m: float
    dy_m: float
    dz_m: float | None
    """Above the entity; None: on the road."""
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class RoutePosition:
    """A place on a route: s along it, and a lane offset, in m; ``lane`` is None where the route decides."""

    route: RouteSpec
    s_m: float
    t_m: float | None
    lane: int | None
    offset_m: float
    orientation: Orientation = Orientation()


@dataclass(frozen=True, slots=True)
class TrajectoryPosition:
    """A place on a trajectory: s along it and t to its left, in m."""

    trajectory: TrajectorySpec
    s_m: float
    t_m: float
    orientation: Orientation = Orientation()


Position = (
    WorldPosition
    | LanePosition
    | RoadPosition
    | RelativeLanePosition
    | RelativeRoadPosition
    | RelativeWorldPosition
    | RelativeObjectPosition
    | RoutePosition
    | TrajectoryPosition
)


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A place that a route passes, and the strategy that leads to it."""

    position: Position
    strategy: str


@dataclass(frozen=True, slots=True)
class RouteSpec:
    """A route: places to pass in their order."""

    name: str
    closed: bool
    waypoints: tuple[Waypoint, ...]


@dataclass(frozen=True, slots=True)
class PolylineSpec:
    """A trajectory of straight pieces: places with their times in s, None where the file gives none."""

    vertices: tuple[tuple[Position, float | None], ...]


@dataclass(frozen=True, slots=True)
class ClothoidSpec:
    """A piece of a clothoid: curvature in 1/m, its change in 1/m², length in m, times in s."""

    position: Position
    curvature_per_m: float
    curvature_prime_per_m2: float
    length_m: float
    start_s: float | None
    stop_s: float | None


@dataclass(frozen=True, slots=True)
class ClothoidPiece:
    """A piece of a spline: begins at ``position``, or where the piece before or the entity is; 1/m, m, rad and s."""

    position: Position | None
    start_per_m: float
    end_per_m: float
    length_m: float
    turn_rad: float
    start_s: float | None


@dataclass(frozen=True, slots=True)
class ClothoidSplineSpec:
    """A trajectory of clothoids one after the other, with its last time in s."""

    pieces: tuple[ClothoidPiece, ...]
    end_s: float | None


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """A control point of a NURBS curve: its place, its weight, and its time in s."""

    position: Position
    weight: float
    time_s: float | None


@dataclass(frozen=True, slots=True)
class NurbsSpec:
    """A rational B-spline: control points, knots, and the order, one above the degree."""

    order: int
    points: tuple[ControlPoint, ...]
    knots: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class TrajectorySpec:
    """A trajectory: a curve in the plane, with or without times."""

    name: str
    closed: bool
    shape: PolylineSpec | ClothoidSpec | ClothoidSplineSpec | NurbsSpec
