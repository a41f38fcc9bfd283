"""`TrafficManager`: spawns background traffic from a seed: vehicles on autopilot, walkers with AI controllers."""

from __future__ import annotations

import contextlib
import math
import random
from typing import TYPE_CHECKING

import carla
import numpy as np

from basu import client_threads
from basu.errors import SimulatorError, UserError
from basu.managers.base_manager import BaseManager
from basu.traffic_ports import free_traffic_port

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from basu.conditions import Traffic
    from basu.managers.base_manager import Frame, Run


REACH_M = 300.0
"""Traffic begins within this of the route: about half a minute's drive, so that the vehicle under test can meet it."""

CLEAR_M = 30.0
"""No traffic begins nearer to the vehicle under test: a stop from 25 mph with time to see it coming."""

RESERVED_M = 12.0
"""No traffic begins nearer to a place that is reserved for an actor of a scenario: the length of a bus."""

COARSE_M = 10.0  # between the points of the route that distances are taken from; nothing next to REACH_M


def distance_m(places_m: NDArray[np.float64], route_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) how far each of the places (N, 2) lies from the nearest of a route's points (M, 2), a metre apart."""
    nearest = np.full(len(places_m), np.inf)
    for point in route_m[:: round(COARSE_M)]:
        np.minimum(nearest, np.hypot(places_m[:, 0] - point[0], places_m[:, 1] - point[1]), out=nearest)
    return nearest


def suitable(
    places_m: NDArray[np.float64], route_m: NDArray[np.float64], ego_m: tuple[float, float]
) -> NDArray[np.int64]:
    """The indices of the places (N, 2) within reach of the route and away from the vehicle under test."""
    away_m = np.hypot(places_m[:, 0] - ego_m[0], places_m[:, 1] - ego_m[1])
    return np.flatnonzero((distance_m(places_m, route_m) <= REACH_M) & (away_m >= CLEAR_M))


def vehicles_for(density_per_km: float, lane_km: float) -> int:
    """How many vehicles make up a density on so many km of driving lane."""
    return round(density_per_km * lane_km)


GAP_M = 2.5  # that vehicles keep to the one ahead; generate_traffic.py of CARLA has the same
CROSSING_SHARE = 0.1  # of the walkers may leave the pavement where there is no crosswalk
LANE_STEP_M = 10.0  # between the places that driving lanes are measured by
DROP_M = 1.0  # walkers are put above the pavement, as in CARLA's examples
ATTEMPTS_A_WALKER = 400  # places drawn from the whole town until one lies within reach
PARTING_TICKS = 2  # for the client to forget destroyed actors


class TrafficManager(BaseManager):
    """Puts others on the road before the run and takes them away after it. ``count`` says how many there are."""

    def __init__(self, traffic: Traffic, reserved_m: Sequence[tuple[float, float]] = ()) -> None:
        """Describe the traffic; ``reserved_m`` are places (x, y) of actors that come later, which stay free."""
        self._traffic = traffic
        self._reserved_m = reserved_m
        self._manager: carla.TrafficManager | None = None
        self._leaders: list[carla.Actor] = []
        self._ids: list[int] = []
        self._timeout_s = 0.0
        self.count = {"vehicles": 0, "walkers": 0}

    def setup(self, run: Run) -> None:
        """Spawn all traffic and hand it over to Traffic Manager and crowd.

        Raises:
            UserError: there is no room for so many.
            SimulatorError: the simulator did not let us.
        """
        if self._traffic.is_empty:
            return
        self._run, self._timeout_s = run, run.timeout_s
        self._route_m = run.route.points_m[:, :2]
        at = run.vehicle.get_location()
        self._ego_m = (at.x, at.y)
        dice = random.Random(run.seed)  # noqa: S311 - to be had again by its seed, not to be a secret
        try:
            vehicles = self._spawn_vehicles(self._wanted_vehicles(), dice)
            walkers = self._spawn_walkers(self._traffic.walkers, dice)
            manager = self._synchronous_manager() if vehicles else None
            run.world.tick(run.timeout_s)
            if manager is not None:
                self._register(manager, vehicles)
            self._lead_walkers(walkers)
        except RuntimeError as error:
            raise SimulatorError(f"the simulator failed at getting the traffic ready: {error}") from error
        self.count = {"vehicles": len(vehicles), "walkers": len(walkers)}

    def tick(self, frame: Frame) -> None:
        """The client itself leads all traffic in each step."""

    def close(self) -> None:
        """Destroy all traffic, the walkers' controllers first, and end the Traffic Manager.

        Where the simulator is gone, so is the traffic; then the Traffic Manager is left as it is: its end asks the
        simulator, and the official client ends the whole process where no server answers there.
        """
        with contextlib.suppress(RuntimeError):
            self._destroy_all()
            if self._manager is not None:
                self._run.client.get_server_version()
                self._manager.shut_down()
        self._manager = None

    def _destroy_all(self) -> None:
        """Leaders, walkers and vehicles; and a moment for the client to forget them."""
        ids, self._ids = self._ids, []
        leaders, self._leaders = self._leaders, []
        if not ids:
            return
        for leader in leaders:
            leader.stop()
        commands = [carla.command.DestroyActor(actor_id) for actor_id in reversed(ids)]
        self._run.client.apply_batch_sync(commands, False)
        for _ in range(PARTING_TICKS):
            self._run.world.tick(self._timeout_s)

    def _wanted_vehicles(self) -> int:
        """The requested number, or the number that makes the requested density."""
        if self._traffic.density_per_km is None:
            return self._traffic.vehicles
        lanes = [w for w in self._run.carla_map.generate_waypoints(LANE_STEP_M) if not w.is_junction]
        near = suitable(_places_m([w.transform for w in lanes]), self._route_m, self._ego_m)
        return vehicles_for(self._traffic.density_per_km, len(near) * LANE_STEP_M / 1000.0)

    def _spawn_vehicles(self, count: int, dice: random.Random) -> list[int]:
        """So many cars at shuffled spawn points of the map, their models and colours drawn."""
        if count == 0:
            return []
        points = self._run.carla_map.get_spawn_points()
        near = self._free([points[index] for index in suitable(_places_m(points), self._route_m, self._ego_m)])
        dice.shuffle(near)
        models = [model for model in self._models("vehicle.*") if _is_car(model)]
        spawned: list[int] = []
        tried = 0
        while len(spawned) < count and tried < len(near):
            batch = near[tried : tried + count - len(spawned)]
            tried += len(batch)
            spawned += self._spawned([(_painted(dice.choice(models), dice), point, 0) for point in batch])
        if len(spawned) < count:
            raise UserError(
                f"{count} vehicles were requested, and {len(spawned)} found room on the {len(near)} spawn points "
                f"that lie within {REACH_M:.0f} m of the route and {CLEAR_M:.0f} m away from its start; ask for fewer"
            )
        return spawned

    def _spawn_walkers(self, count: int, dice: random.Random) -> list[int]:
        """So many walkers at random places of the pavements near the route."""
        if count == 0:
            return []
        self._run.world.set_pedestrians_seed(self._run.seed)
        models = self._models("walker.pedestrian.*")
        spawned: list[int] = []
        for _ in range(ATTEMPTS_A_WALKER):
            places = self._pavement(count - len(spawned))
            spawned += self._spawned([(dice.choice(models), place, 0) for place in places])
            if len(spawned) == count:
                return spawned
        raise UserError(
            f"{count} walkers were requested, and {len(spawned)} found room on the pavements within {REACH_M:.0f} m of "
            "the route; ask for fewer"
        )

    def _pavement(self, count: int) -> list[carla.Transform]:
        """At most so many places near the route, out of as many drawn from the whole town."""
        drawn = [self._run.world.get_random_location_from_navigation() for _ in range(max(count, 20))]
        if any(place is None for place in drawn):
            raise UserError(
                f"walkers were requested, and {self._run.route.town} has no mesh of pavements for them to walk on; "
                "run without --walkers"
            )
        poses = [carla.Transform(place + carla.Location(z=DROP_M)) for place in drawn]
        return self._free([poses[index] for index in suitable(_places_m(poses), self._route_m, self._ego_m)])[:count]

    def _free(self, poses: list[carla.Transform]) -> list[carla.Transform]:
        """Return the poses that are not reserved for other actors."""
        places_m = [(pose.location.x, pose.location.y) for pose in poses]
        return [
            pose
            for pose, place_m in zip(poses, places_m, strict=True)
            if all(math.dist(place_m, reserved_m) >= RESERVED_M for reserved_m in self._reserved_m)
        ]

    def _synchronous_manager(self) -> carla.TrafficManager:
        """Return a new Traffic Manager in synchronous mode. One tick must follow before vehicles are registered.

        The Traffic Manager's own thread begins in asynchronous mode. Its present step may outlast
        ``set_synchronous_mode`` and take in vehicles. They would have one step more than in another run of the seed.
        The next tick of the world waits for a synchronous step, and so ends the asynchronous one.
        """
        client_threads.hold()
        self._manager = self._run.client.get_trafficmanager(free_traffic_port())
        self._manager.set_synchronous_mode(True)
        self._manager.set_random_device_seed(self._run.seed)
        self._manager.set_global_distance_to_leading_vehicle(GAP_M)
        return self._manager

    def _register(self, manager: carla.TrafficManager, vehicles: list[int]) -> None:
        """Hand vehicles over to the Traffic Manager."""
        for vehicle in self._actors(vehicles):
            vehicle.set_autopilot(True, manager.get_port())

    def _lead_walkers(self, walkers: list[int]) -> None:
        """Give each walker a leader that sends it to places of the pavements, one after the other."""
        if not walkers:
            return
        world = self._run.world
        leader = world.get_blueprint_library().find("controller.ai.walker")
        leaders = self._spawned([(leader, carla.Transform(), walker) for walker in walkers])
        world.tick(self._timeout_s)
        self._leaders = self._actors(leaders)
        world.set_pedestrians_cross_factor(CROSSING_SHARE)
        for each, walker in zip(self._leaders, self._actors(walkers), strict=True):
            each.start()
            each.go_to_location(world.get_random_location_from_navigation())
            each.set_max_speed(float(walker.attributes["speed"]))

    def _models(self, pattern: str) -> list[carla.ActorBlueprint]:
        """The simulator's blueprints of a kind, in an order that does not depend on it."""
        return sorted(self._run.world.get_blueprint_library().filter(pattern), key=lambda model: str(model.id))

    def _spawned(self, wanted: Sequence[tuple[carla.ActorBlueprint, carla.Transform, int]]) -> list[int]:
        """Spawn by blueprint, pose and parent (0: none); the ids of the actors that found room."""
        spawn: Callable[..., object] = carla.command.SpawnActor
        commands = [spawn(model, pose, parent) if parent else spawn(model, pose) for model, pose, parent in wanted]
        answers = self._run.client.apply_batch_sync(commands, False)
        ids = [int(answer.actor_id) for answer in answers if not answer.has_error()]
        self._ids += ids
        return ids

    def _actors(self, ids: list[int]) -> list[carla.Actor]:
        """The actors of these ids, in their order."""
        found = {actor.id: actor for actor in self._run.world.get_actors(ids)}
        return [found[actor_id] for actor_id in ids]


def _places_m(poses: Sequence[carla.Transform]) -> NDArray[np.float64]:
    """(N, 2) where poses stand in the plane."""
    return np.array([(pose.location.x, pose.location.y) for pose in poses], dtype=np.float64).reshape(-1, 2)


def _is_car(model: carla.ActorBlueprint) -> bool:
    """Neither lorry nor bus nor two wheels: what generate_traffic.py calls safe."""
    return bool(model.has_attribute("base_type") and model.get_attribute("base_type").as_str() == "car")


def _painted(model: carla.ActorBlueprint, dice: random.Random) -> carla.ActorBlueprint:
    """A car of a colour that is drawn, for the Traffic Manager to drive."""
    if model.has_attribute("color"):
        model.set_attribute("color", dice.choice(list(model.get_attribute("color").recommended_values)))
    model.set_attribute("role_name", "autopilot")
    return model
