"""`Bodies`: walkers at the stops for the persons that wait there, so that sensors, agents and films see them.

A person stands on the pavement beside its stop from its coming to its boarding, or until it gives up. The persons of a
stop stand in a row along the street, each at the place that became free first. They do not walk: the ways to and
from the stops are on paper only.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.managers.base_manager import BaseManager
from basu_service.persons import Kind
from basu_service.plan import stop_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers.base_manager import Frame, Run
    from basu_service.operation import Service

EVERY_TICKS = 10  # half a second between two looks at the persons
APART_M = 1.2  # from person to person: an assumption of this project, as are the other lengths
BESIDE_M = 3.0  # from the middle of the lane at a stop without a pavement
PAVEMENT_M = 8.0  # the farthest pavement that belongs to a stop
MOST_AT_A_STOP = 12  # more persons have no body
UP_M = 1.2  # of a walker's origin above the ground, where it appears


class _Place(NamedTuple):
    """A place of a person at a stop."""

    stop_id: str
    number: int


class Bodies(BaseManager):
    """Shows the persons that wait; one for a service."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._run: Run | None = None
        self._stops: dict[str, carla.Transform] = {}
        self._shown: dict[int, tuple[_Place, carla.Actor]] = {}  # by the person's number
        self.most = 0  # bodies at the same time

    def setup(self, run: Run) -> None:
        """Find the pavement beside each stop."""
        self._run = run
        self._walkers = _walkers(run.world)
        self._chairs = [each for each in self._walkers if _can_have_wheelchair(each)]
        for stop in run.route.stops:
            here = carla.Location(stop.x_m, stop.y_m, stop.z_m)
            self._stops.setdefault(stop_of(stop.id), pavement(run.carla_map, here))

    def tick(self, frame: Frame) -> None:
        """Let bodies come for persons that have come, and go for persons that wait no more."""
        if self._run is None or frame.tick % EVERY_TICKS:
            return
        t_s = frame.tick * self._run.step_s
        waiting = {each.person.number: each.person for each in self._service.journeys if each.stands_there(t_s)}
        for number in sorted(set(self._shown) - set(waiting)):
            _, actor = self._shown.pop(number)
            actor.destroy()
        taken = {place for place, _ in self._shown.values()}
        for number, person in sorted(waiting.items()):
            if number in self._shown or person.stop_id not in self._stops:
                continue
            free = next((n for n in range(MOST_AT_A_STOP) if _Place(person.stop_id, n) not in taken), None)
            if free is None:
                continue
            place = _Place(person.stop_id, free)
            actor = self._spawned(place, number, in_wheelchair=person.kind is Kind.WHEELCHAIR)
            if actor is not None:  # else something stands there; the next look tries again
                self._shown[number] = place, actor
                taken.add(place)
        self.most = max(self.most, len(self._shown))

    def close(self) -> None:
        """Destroy the walkers that stand for waiting persons."""
        if self._run is not None:
            commands = [carla.command.DestroyActor(actor.id) for _, actor in self._shown.values()]
            self._shown = {}
            with contextlib.suppress(RuntimeError):  # the simulator is gone, and the bodies with it
                self._run.client.apply_batch_sync(commands, False)

    def _spawned(self, place: _Place, number: int, *, in_wheelchair: bool) -> carla.Actor | None:
        """Return a new walker at a place; None where something stands there. The model follows from the number."""
        assert self._run is not None, "bodies come while a run lasts"
        kinds = self._chairs if in_wheelchair and self._chairs else self._walkers
        blueprint = kinds[number % len(kinds)]
        if _can_have_wheelchair(blueprint):
            blueprint.set_attribute("use_wheelchair", "true" if in_wheelchair else "false")
        return self._run.world.try_spawn_actor(blueprint, place_of(self._stops[place.stop_id], place.number))


def pavement(carla_map: carla.Map, stop: carla.Location) -> carla.Transform:
    """Return the pose of the first person at a stop: on the nearest pavement, or beside the lane; it faces the lane."""
    lane = carla_map.get_waypoint(stop)
    beside = carla_map.get_waypoint(stop, lane_type=carla.LaneType.Sidewalk)
    right = lane.transform.get_right_vector()
    facing = carla.Rotation(yaw=lane.transform.rotation.yaw - 90.0)
    if beside is not None and beside.transform.location.distance(stop) <= PAVEMENT_M:
        return carla.Transform(beside.transform.location, facing)
    at = lane.transform.location + carla.Location(BESIDE_M * right.x, BESIDE_M * right.y, 0.0)
    return carla.Transform(at, facing)


def place_of(first: carla.Transform, number: int) -> carla.Transform:
    """Return the pose of the person at a place in the row, which goes against the direction of the lane."""
    back = first.get_right_vector()
    return carla.Transform(
        carla.Location(
            first.location.x - APART_M * number * back.x,
            first.location.y - APART_M * number * back.y,
            first.location.z + UP_M,
        ),
        first.rotation,
    )


def _walkers(world: carla.World) -> Sequence[carla.ActorBlueprint]:
    """Return the blueprints of people, in the order of their names."""
    return sorted(world.get_blueprint_library().filter("walker.pedestrian.*"), key=lambda each: str(each.id))


def _can_have_wheelchair(blueprint: carla.ActorBlueprint) -> bool:
    """Return whether a walker may sit in a wheelchair."""
    return blueprint.has_attribute("can_use_wheelchair") and bool(
        blueprint.get_attribute("can_use_wheelchair").as_bool()
    )
