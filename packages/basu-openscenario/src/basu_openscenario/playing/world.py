"""`World`: the entities of a running scenario, its variables, signals and time, and the places that positions mean."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.playing.curves import lay
from basu_openscenario.playing.mover import Mover
from basu_openscenario.playing.routes import road_path, route_place
from basu_openscenario.playing.towing import connect
from basu_openscenario.playing.traffic import Traffic
from basu_openscenario.reading.positions import (
    LanePosition,
    Orientation,
    RelativeLanePosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoadPosition,
    RoutePosition,
    TrajectoryPosition,
    WorldPosition,
)
from basu_openscenario.roads.network import DRIVING, WALKING
from basu_openscenario.roads.place import Place, wrapped

if TYPE_CHECKING:
    from basu_openscenario.playing.running_action import RunningAction
    from basu_openscenario.reading.entities import Entity
    from basu_openscenario.reading.positions import Position, RouteSpec
    from basu_openscenario.reading.scenario_file import ScenarioFile, SignalController
    from basu_openscenario.roads.network import Network


@dataclass(slots=True)
class World:
    """All that actions change and conditions read."""

    network: Network
    movers: dict[str, Mover]
    variables: dict[str, str]
    controllers: tuple[SignalController, ...] = ()
    signals: dict[str, str] = field(default_factory=dict)
    phases: dict[str, tuple[str, float]] = field(default_factory=dict)
    """The phase of a controller that an action began, and when, in s."""
    environment: dict[str, str] = field(default_factory=dict)
    time_s: float = 0.0
    step_s: float = 0.0
    traffic: Traffic = field(default_factory=Traffic)
    acting: dict[str, list[RunningAction]] = field(default_factory=dict)
    """The actions of each entity that have begun, and perhaps ended."""

    def running(self, mover: Mover) -> list[RunningAction]:
        """Return the actions of an entity that run."""
        found = [one for one in self.acting.get(mover.name, []) if one.is_running]
        self.acting[mover.name] = found
        return list(found)

    def mover(self, name: str) -> Mover:
        """Return an entity by its name."""
        return self.movers[name]

    def place_of(self, position: Position, mover: Mover | None = None) -> Place:
        """Return the place that a position means now.

        Args:
            position: as the file has it.
            mover: the entity that it is for; its types of lanes count, and its route where the position has none.

        Raises:
            ScenarioError: there is no such road or lane.
        """
        place = Place(self.network, kinds=DRIVING if mover is None else mover.place.kinds)
        if isinstance(position, LanePosition):
            self._check_lane(position.road, position.lane, position.s_m)
            place.set_lane(position.road, position.lane, position.s_m, position.offset_m)
            turned = math.pi if place.driving_sign() < 0.0 else 0.0
            return self._orient(place, position.orientation, turned)
        if isinstance(position, RoadPosition):
            self._check_road(position.road)
            place.set_track(position.road, position.s_m, position.t_m)
            return self._orient(place, position.orientation, 0.0)
        if isinstance(position, WorldPosition):
            h_rad = position.orientation.h_rad
            place.set_world(position.x_m, position.y_m, h_rad or 0.0, position.z_m)
            return self._tilt(place, position.orientation)
        if isinstance(position, RoutePosition):
            return self._on_route(place, position)
        if isinstance(position, TrajectoryPosition):
            return self._on_trajectory(place, position)
        return self._beside(place, position)

    def _check_road(self, number: str) -> None:
        """Refuse a road that the network does not have."""
        if number not in self.network.roads:
            there = ", ".join(list(self.network.roads)[:8])
            raise ScenarioError(
                f"{self.network.path} has no road '{number}'; it has {there}, ...: correct the road's id"
            )

    def _check_lane(self, number: str, lane: int, s_m: float) -> None:
        """Raise ScenarioError if the road has no such lane at ``s_m``."""
        self._check_road(number)
        lanes = self.network.roads[number].section(s_m).lanes
        if lane not in lanes and lane != 0:
            there = ", ".join(str(one) for one in sorted(lanes))
            raise ScenarioError(
                f"the road '{number}' of {self.network.path} has no lane {lane} at {s_m:g} m; it has {there}"
            )

    def _orient(self, place: Place, orientation: Orientation, turned_rad: float) -> Place:
        """Give a place on the road its heading: along the traffic of its lane, unless the file says otherwise."""
        h_rad = orientation.h_rad
        if h_rad is None or orientation.relative:
            place.h_rel_rad = turned_rad + (h_rad or 0.0)
        else:
            place.h_rel_rad = wrapped(h_rad - place.lane_heading())
        assert place.road is not None, "it is on a road"
        place.set_lane(place.road.number, place.lane, place.s_m, place.offset_m)
        return self._tilt(place, orientation)

    def _tilt(self, place: Place, orientation: Orientation) -> Place:
        """Fix pitch and roll where the file gives them."""
        for name in ("p_rad", "r_rad"):
            value = getattr(orientation, name)
            if value is not None and not orientation.relative and value:
                setattr(place, name, value)
                place.on_surface = False
        return place

    def _on_route(self, place: Place, position: RoutePosition) -> Place:
        """Return a place on a route."""
        where = route_place(self.network, self.waypoints(position.route), position.s_m)
        if position.lane is None:
            place.set_track(where.road_number, where.s_m, position.t_m or 0.0)
            return self._orient(place, position.orientation, 0.0 if where.is_forward else math.pi)
        self._check_lane(where.road_number, position.lane, where.s_m)
        place.set_lane(where.road_number, position.lane, where.s_m, position.offset_m)
        return self._orient(place, position.orientation, math.pi if place.driving_sign() < 0.0 else 0.0)

    def waypoints(self, route: RouteSpec) -> list[Place]:
        """Return the places that a route passes."""
        return [self.place_of(one.position) for one in route.waypoints]

    def route_roads(self, places: list[Place]) -> list[str]:
        """Return the roads of the shortest way through places."""
        return road_path(self.network, places)

    def _on_trajectory(self, place: Place, position: TrajectoryPosition) -> Place:
        """Return a place on a trajectory."""
        curve = lay(position.trajectory, self.place_of, follows=False, speed_mps=0.0, here=place)
        vertex = curve.at(position.s_m)
        x_m = vertex.x_m - math.sin(vertex.h_rad) * position.t_m
        y_m = vertex.y_m + math.cos(vertex.h_rad) * position.t_m
        h_rad = vertex.h_rad + (position.orientation.h_rad or 0.0)
        if position.orientation.h_rad is not None and not position.orientation.relative:
            h_rad = position.orientation.h_rad
        place.set_world(x_m, y_m, h_rad)
        return place

    def _beside(
        self,
        place: Place,
        position: RelativeLanePosition | RelativeRoadPosition | RelativeWorldPosition | RelativeObjectPosition,
    ) -> Place:
        """Return a place that is given from an entity."""
        there = self.movers[position.entity].place
        if isinstance(position, RelativeLanePosition):
            return self._lanes_beside(there, position)
        if isinstance(position, RelativeRoadPosition):
            moved = there.copy()
            moved.move(position.ds_m, direction="road", actual=False)
            moved.set_track(moved.road_number, moved.s_m, moved.t_m + position.dt_m)
            return self._orient(moved, position.orientation, 0.0)
        dx, dy, dz = position.dx_m, position.dy_m, position.dz_m or 0.0
        if isinstance(position, RelativeObjectPosition):
            dx, dy, dz = there.rotated(dx, dy, dz)
        orientation = position.orientation
        absolute = orientation.h_rad is not None and not orientation.relative
        h_rad = (orientation.h_rad or 0.0) + (0.0 if absolute else there.h_rad)
        z_m = None if position.dz_m is None else there.z_m + dz
        place.set_world(there.x_m + dx, there.y_m + dy, h_rad, z_m)
        if orientation.p_rad or orientation.r_rad or not there.on_surface:
            place.on_surface = False
            place.p_rad = (orientation.p_rad or 0.0) + (0.0 if absolute else there.p_rad)
            place.r_rad = (orientation.r_rad or 0.0) + (0.0 if absolute else there.r_rad)
        return place

    def _lanes_beside(self, there: Place, position: RelativeLanePosition) -> Place:
        """Return a place by lanes and metres from an entity."""
        moved = there.copy()
        moved.offset_m = 0.0
        moved.t_m = moved.road.lane_t_m(moved.lane, moved.s_m) if moved.road is not None else 0.0
        moved.move(position.ds_m, direction="lane" if position.along_lane else "road", actual=False)
        left = moved.road is not None and moved.road.left_hand
        with_s = not position.along_lane or (there.is_forward and (there.lane < 0) != left)
        side = 1 if with_s else -1
        lane = lane_beside(there.lane, side * position.lanes)
        self._check_lane(moved.road_number, lane, moved.s_m)
        moved.set_lane(moved.road_number, lane, moved.s_m, side * position.offset_m)
        turned = math.pi if position.along_lane and moved.driving_sign() < 0.0 else 0.0
        return self._orient(moved, position.orientation, turned)


def lane_beside(lane: int, by: int) -> int:
    """Return the lane ``by`` lanes to the left (positive) of a lane; lane 0 has no width and does not count."""
    found = lane + by
    if found == 0 or (found < 0) != (lane < 0):
        found += 1 if by > 0 else -1
        if lane == 0:
            found -= 1 if by > 0 else -1
    return found


def make_world(scenario: ScenarioFile, network: Network) -> World:
    """Return the world of a scenario before anything has moved."""
    movers = {entity.name: _mover(entity, network) for entity in scenario.entities.values()}
    for mover in movers.values():
        if mover.entity.trailer:
            connect(mover, movers[mover.entity.trailer])
    variables = {**scenario.parameters, **scenario.variables}
    return World(network, movers, variables, scenario.signal_controllers)


def _mover(entity: Entity, network: Network) -> Mover:
    """Return an entity at the origin."""
    place = Place(network, kinds=WALKING if entity.kind == "pedestrian" else DRIVING)
    mover = Mover(entity, place)
    mover.controllers = {one.name: one for one in entity.controllers}
    return mover
