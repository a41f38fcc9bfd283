"""SUMO's road users in CARLA: one batch a tick spawns, moves, lights and destroys their actors."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu_sumo.mirrors import ROLE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from basu_sumo.frames import Pose
    from basu_sumo.road_users import Look, RoadUser

RADIUS_SLACK_M = 10.0  # beyond the radius: a road user at its edge does not come and go
WALKER_DROP_M = 1.0  # a walker's place is its middle, some 0.9 m above its feet: simulator and blueprints differ


class _Batch(NamedTuple):
    """Commands with what their answers are of: the name that was spawned or moved, None for other commands."""

    commands: list[Any]
    spawned: dict[int, str]
    moved: dict[int, str]


class Display:
    """The actors that show SUMO's road users.

    ``actors`` has the actors by name. ``waiting`` says why some could not be spawned yet. ``shown`` counts the spawned.
    """

    def __init__(self, client: carla.Client, world: carla.World, carla_map: carla.Map, radius_m: float | None) -> None:
        """Take away what the display of a dead process has left in this world, and show nothing yet."""
        self._client, self._world, self._map, self._radius_m = client, world, carla_map, radius_m
        self._library = world.get_blueprint_library()
        self._lamps: dict[str, int] = {}
        self.actors: dict[str, int] = {}
        self.waiting: dict[str, str] = {}
        self.shown = 0
        self.is_level = True  # whether SUMO's heights are the map's
        self._destroy(actor.id for actor in world.get_actors() if actor.attributes.get("role_name") == ROLE)

    def show(self, users: Mapping[str, RoadUser], centre: carla.Location | None) -> list[int]:
        """Bring the actors to where SUMO's road users are, all by one batch; return the ids of the new actors.

        With a ``centre`` and a radius, only road users within the radius are shown.
        """
        batch = _Batch([], {}, {})
        wanted = {name for name, user in users.items() if centre is None or self._is_near(name, user.pose, centre)}
        for name in [name for name in self.actors if name not in wanted]:
            self._lamps.pop(name, None)
            batch.commands.append(carla.command.DestroyActor(self.actors.pop(name)))
        for name, user in users.items():
            if name in wanted:
                self._add(batch, name, user)
        self.waiting = {name: why for name, why in self.waiting.items() if name in wanted}
        return self._take_in(batch, self._client.apply_batch_sync(batch.commands, False))

    def _add(self, batch: _Batch, name: str, user: RoadUser) -> None:
        """Add the commands of one road user."""
        command, commands, actor_id = carla.command, batch.commands, self.actors.get(name)
        transform = self._transform(user.pose)
        if actor_id is None:
            batch.spawned[len(commands)] = name
            if user.look.is_person:
                transform.location.z += WALKER_DROP_M
                commands.append(command.SpawnActor(self._blueprint(user.look), transform))
            else:
                spawn = command.SpawnActor(self._blueprint(user.look), transform)
                commands.append(spawn.then(command.SetSimulatePhysics(command.FutureActor, False)))
            return
        batch.moved[len(commands)] = name
        if user.look.is_person:
            commands.append(command.ApplyWalkerState(actor_id, transform, user.speed_mps))
            return
        commands.append(command.ApplyTransform(actor_id, transform))
        if self._lamps.get(name, 0) != user.lamps:
            self._lamps[name] = user.lamps
            commands.append(command.SetVehicleLightState(actor_id, carla.VehicleLightState(user.lamps)))

    def _take_in(self, batch: _Batch, answers: Any) -> list[int]:  # noqa: ANN401 - Response of the client
        """Note the new actors. One without room, or that another client destroyed, is spawned in a later tick."""
        new = []
        for place, name in batch.spawned.items():
            if answers[place].has_error():
                self.waiting[name] = str(answers[place].error)
                continue
            self.waiting.pop(name, None)
            self.actors[name] = int(answers[place].actor_id)
            new.append(self.actors[name])
        for place, name in batch.moved.items():
            if answers[place].has_error():
                del self.actors[name]
                self._lamps.pop(name, None)
                self.waiting[name] = str(answers[place].error)
        self.shown += len(new)
        return new

    def _transform(self, pose: Pose) -> carla.Transform:
        """Return the pose on the ground: SUMO's heights where its network has the map's, else the map's own."""
        location = carla.Location(pose.x_m, pose.y_m, pose.z_m)
        if not self.is_level:
            below = self._map.get_waypoint(location, lane_type=carla.LaneType.Any)
            location.z = below.transform.location.z
        return carla.Transform(location, carla.Rotation(pose.pitch_deg, pose.yaw_deg, 0.0))

    def _is_near(self, name: str, pose: Pose, centre: carla.Location) -> bool:
        assert self._radius_m is not None, "there is a centre"
        limit_m = self._radius_m + (RADIUS_SLACK_M if name in self.actors else 0.0)
        return math.hypot(pose.x_m - centre.x, pose.y_m - centre.y) <= limit_m

    def _blueprint(self, look: Look) -> carla.ActorBlueprint:
        blueprint = self._library.find(look.blueprint)
        blueprint.set_attribute("role_name", ROLE)
        if look.colour is not None:
            blueprint.set_attribute("color", look.colour)
        return blueprint

    def close(self) -> None:
        """Take all actors out of the world; a simulator that is gone has none."""
        ids, self.actors = list(self.actors.values()), {}
        with contextlib.suppress(RuntimeError):
            self._destroy(ids)

    def _destroy(self, ids: Iterable[int]) -> None:
        commands = [carla.command.DestroyActor(actor_id) for actor_id in ids]
        if commands:
            self._client.apply_batch_sync(commands, False)
