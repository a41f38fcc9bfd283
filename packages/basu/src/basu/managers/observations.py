"""Observations of one frame for the record: the lane below the vehicle, the next light, and actors nearby."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.records.history.model import NEAR_M, NEAREST, NO_LIGHT, Vehicle
from basu.records.placed_motion import PlacedMotion, own_motion
from basu.routing import ControlKind
from basu.thresholds import is_rolled_over

if TYPE_CHECKING:
    from basu.managers.base_manager import Ego, Frame
    from basu.routing import Route


def vehicle_of(actor: carla.Vehicle) -> Vehicle:
    """Return the box of the vehicle under test as records have it."""
    box = actor.bounding_box
    return Vehicle(
        type_id=actor.type_id,
        front_m=box.location.x + box.extent.x,
        rear_m=box.extent.x - box.location.x,
        width_m=2.0 * box.extent.y,
    )


class LaneUnder(NamedTuple):
    """One frame's lane, in the order of the columns of ``history.FRAME``."""

    road_id: int
    lane_id: int
    lane_type: int  # the value of carla.LaneType; 0 where there is no lane
    lane_offset_m: float  # of the vehicle's origin from the lane's middle, positive to the right; nan without a lane
    lane_heading_rad: float  # the vehicle's yaw less the lane's, in -pi..pi; nan without a lane
    lane_width_m: float  # nan without a lane
    in_junction: bool
    off_lane_m: float  # how far the origin is beyond the edge of the nearest driving or parking lane; 0 within one


FOR_VEHICLES = (carla.LaneType.Driving, carla.LaneType.Bidirectional, carla.LaneType.Parking)
NO_LANE = LaneUnder(0, 0, 0, math.nan, math.nan, math.nan, in_junction=False, off_lane_m=math.nan)


class LaneFinder:
    """Finds the lane under a vehicle; one that stands still is not looked for again."""

    def __init__(self, carla_map: carla.Map) -> None:
        self._map = carla_map
        self._pose: tuple[float, ...] = ()
        self._found = NO_LANE

    def under(self, ego: Ego) -> LaneUnder:
        """The lane, of whatever type, that the vehicle's origin lies on."""
        pose = (ego.x_m, ego.y_m, ego.z_m, ego.yaw_rad)
        if pose != self._pose:
            self._pose, self._found = pose, lane_under(self._map, ego)
        return self._found


def lane_under(carla_map: carla.Map, ego: Ego) -> LaneUnder:
    """The lane, of whatever type, that the vehicle's origin lies on."""
    place = carla.Location(ego.x_m, ego.y_m, ego.z_m)
    waypoint = carla_map.get_waypoint(place, project_to_road=False, lane_type=carla.LaneType.Any)
    if waypoint is None:
        return NO_LANE._replace(off_lane_m=_off_lane_m(carla_map, place))
    middle = waypoint.transform
    yaw_rad = math.radians(middle.rotation.yaw)
    to_x_m, to_y_m = ego.x_m - middle.location.x, ego.y_m - middle.location.y
    return LaneUnder(
        road_id=waypoint.road_id,
        lane_id=waypoint.lane_id,
        lane_type=int(waypoint.lane_type),
        lane_offset_m=to_y_m * math.cos(yaw_rad) - to_x_m * math.sin(yaw_rad),
        lane_heading_rad=math.remainder(ego.yaw_rad - yaw_rad, math.tau),
        lane_width_m=waypoint.lane_width,
        in_junction=waypoint.is_junction,
        off_lane_m=0.0 if waypoint.lane_type in FOR_VEHICLES else _off_lane_m(carla_map, place),
    )


def _off_lane_m(carla_map: carla.Map, place: carla.Location) -> float:
    """The distance to the edge of the nearest lane for vehicles, inf where the map has none; 0 within one."""
    nearest = (carla_map.get_waypoint(place, lane_type=lane_type) for lane_type in FOR_VEHICLES)
    beyond_m = (
        math.hypot(place.x - lane.transform.location.x, place.y - lane.transform.location.y) - lane.lane_width / 2.0
        for lane in nearest
        if lane is not None
    )
    return max(0.0, min(beyond_m, default=math.inf))


BEHIND_M = 1.0  # a light counts until its line is so far behind the rear: the leaderboard judges the tail out to there


class RouteLights:
    """The lights of a route, read once; their states come with every tick."""

    def __init__(self, world: carla.World, route: Route, rear_m: float) -> None:
        """Look them up; ``rear_m`` is how far the vehicle reaches behind its origin."""
        self._rear_m = rear_m
        on_route = [control for control in route.controls if control.kind is ControlKind.TRAFFIC_LIGHT]
        found = [(control.s_m, world.get_traffic_light_from_opendrive_id(control.landmark_id)) for control in on_route]
        self._lights = [(s_m, light) for s_m, light in found if light is not None]

    def next_state(self, route_s_m: float) -> int:
        """The carla.TrafficLightState of the next light, its line at most ``BEHIND_M`` behind the rear; or NO_LIGHT."""
        for line_s_m, light in self._lights:
            if line_s_m >= route_s_m - self._rear_m - BEHIND_M:
                return int(light.get_state())
        return NO_LIGHT


LOOK_AGAIN_TICKS = 20  # the list of actors is compared at least so often, and whenever the number of actors changes
MOVING_KINDS = ("vehicle.", "walker.")
THING_KINDS = ("static.prop.",)  # scenery is no actor; sensors, signs and friction triggers stand in no vehicle's way
SMALLEST_M = 0.15  # half size of a body with an empty box from the simulator
OVERHEAD_M = 3.0  # a thing that begins so far above the road is driven under


class _ActorShape(NamedTuple):
    """What stays the same about an actor; its box's middle and half sizes in its own frame, m."""

    type_id: str
    x_m: float
    y_m: float
    bottom_m: float
    top_m: float
    half_length_m: float
    half_width_m: float

    @property
    def moves(self) -> bool:
        """Whether it is a vehicle or a walker."""
        return self.type_id.startswith(MOVING_KINDS)

    @property
    def is_rolled_over(self) -> bool:
        """Return whether it is a thing so low that wheels roll over it."""
        return not self.moves and is_rolled_over(self.top_m - self.bottom_m)


class Neighbours:
    """Actors other than the ego. ``met`` holds the type of each that was ever near, ``sizes`` its box."""

    def __init__(self, world: carla.World, ego_id: int) -> None:
        self._world, self._ego_id = world, ego_id
        self._shapes: dict[int, _ActorShape] = {}
        self._motion = PlacedMotion()
        self._count = -1
        self._last: tuple[Frame | None, list[tuple[float, ...]]] = (None, [])
        self.met: dict[int, str] = {}
        self.sizes: dict[int, tuple[float, float]] = {}  # half the length and half the width, m

    def near(self, frame: Frame) -> list[tuple[float, ...]]:
        """Rows of ``history.OTHER``: vehicles and walkers, then things, the nearest of each first, ties by id."""
        if self._last[0] is not frame:
            self._last = (frame, self._found(frame))
        return self._last[1]

    def _found(self, frame: Frame) -> list[tuple[float, ...]]:
        """The rows of a new frame."""
        if len(frame.snapshot) != self._count or frame.tick % LOOK_AGAIN_TICKS == 0:
            self._look_again(len(frame.snapshot))
        moving: list[tuple[float, int, carla.ActorSnapshot]] = []
        things: list[tuple[float, int, carla.ActorSnapshot]] = []
        for actor_id, shape in self._shapes.items():
            actor = frame.snapshot.find(actor_id)
            if actor is None:
                continue
            at = actor.get_transform().location
            away_m = math.hypot(at.x - frame.ego.x_m, at.y - frame.ego.y_m)
            if away_m > NEAR_M:
                continue
            if shape.moves:
                moving.append((away_m, actor_id, actor))
            elif at.z + shape.bottom_m < frame.ego.z_m + OVERHEAD_M and not shape.is_rolled_over:
                things.append((away_m, actor_id, actor))
        chosen = [*sorted(moving)[:NEAREST], *sorted(things)[:NEAREST]]
        t_s = frame.snapshot.timestamp.elapsed_seconds
        return [self._row(frame.tick, t_s, actor_id, actor) for _, actor_id, actor in chosen]

    def counts(self) -> tuple[int, int]:
        """Return how many other vehicles and how many walkers the world has, as of the last look."""
        kinds = [shape.type_id.partition(".")[0] for shape in self._shapes.values()]
        return kinds.count("vehicle"), kinds.count("walker")

    def _look_again(self, count: int) -> None:
        """Take vehicles, walkers and things out of the world's list; only new actors cost a call to the server."""
        self._count = count
        self._shapes = {
            actor.id: self._shapes.get(actor.id) or _shape(actor)
            for actor in self._world.get_actors()
            if actor.id != self._ego_id and actor.type_id.startswith((*MOVING_KINDS, *THING_KINDS))
        }

    def _row(self, tick: int, t_s: float, actor_id: int, actor: carla.ActorSnapshot) -> tuple[float, ...]:
        """One row, in the order of ``history.OTHER``: the place is that of the middle of the box."""
        shape = self._shapes[actor_id]
        if actor_id not in self.met:
            self.met[actor_id] = shape.type_id
            self.sizes[actor_id] = (shape.half_length_m, shape.half_width_m)
        transform = actor.get_transform()
        is_vehicle = shape.type_id.startswith("vehicle.")
        motion = self._motion.of(actor, transform, t_s) if is_vehicle else own_motion(actor)
        at, yaw_rad = transform.location, math.radians(transform.rotation.yaw)
        cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
        x_m = at.x + shape.x_m * cos - shape.y_m * sin
        y_m = at.y + shape.x_m * sin + shape.y_m * cos
        return (tick, actor_id, x_m, y_m, at.z, yaw_rad, motion.velocity_x_mps, motion.velocity_y_mps)


def _shape(actor: carla.Actor) -> _ActorShape:
    """The box of an actor."""
    box = actor.bounding_box
    return _ActorShape(
        type_id=actor.type_id,
        x_m=box.location.x,
        y_m=box.location.y,
        bottom_m=box.location.z - box.extent.z,
        top_m=box.location.z + box.extent.z,
        half_length_m=max(box.extent.x, SMALLEST_M),
        half_width_m=max(box.extent.y, SMALLEST_M),
    )
