"""Vehicles both ways: SUMO's are shown in CARLA, CARLA's own drive in SUMO; one SUMO step and one batch a tick."""

from __future__ import annotations

import contextlib
import math
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.errors import SimulatorError
from basu.sumo.frames import Pose, from_sumo, to_sumo
from basu.sumo.lights import Lights
from basu.sumo.models import CLASSES, Models

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu.sumo.link import Link

ROLE = "sumo"  # role_name of what a bridge has spawned: what is left over is found by it
MIRROR = "carla"  # begins the ids of CARLA's actors in SUMO
RADIUS_SLACK_M = 10.0  # beyond the radius: a vehicle at its edge does not come and go
LEVEL_M = 1.0  # a network has no heights of its own where they differ from the map's by more

# SUMO's variables, TraCI protocol: libsumo/TraCIConstants.h
POSITION, ANGLE, SLOPE, SIGNALS = 0x39, 0x43, 0x36, 0x5B
VARIABLES = (POSITION, ANGLE, SLOPE, SIGNALS)

# SUMO's signals by CARLA's lamps: microsim/MSVehicle.h, enum Signalling
LAMPS = (
    (0b1, carla.VehicleLightState.RightBlinker),
    (0b10, carla.VehicleLightState.LeftBlinker),
    (0b1000, carla.VehicleLightState.Brake),
    (0b10000, carla.VehicleLightState.LowBeam),
)


class Kind(NamedTuple):
    """What is known of a SUMO vehicle from its departure on."""

    blueprint: str
    length_m: float
    colour: str | None


class Counts(NamedTuple):
    """What a bridge has seen so far."""

    departed: int  # vehicles that SUMO has put on the road
    shown: int  # actors that were spawned for them
    waiting: int  # vehicles that stand where an actor cannot be spawned yet
    most: int  # vehicles on SUMO's roads at a time


class Bridge:
    """SUMO and a world of CARLA in step.

    The caller ticks the world: ``step`` once before each tick.
    """

    def __init__(
        self,
        link: Link,
        client: carla.Client,
        world: carla.World,
        carla_map: carla.Map,
        *,
        radius_m: float | None = None,
        lights: str = "carla",
    ) -> None:
        """Join both.

        ``radius_m`` shows vehicles only so near to the first mirrored actor. ``lights`` says which side has the lights:
        "carla", "sumo" or "none".
        """
        self.link, self._client, self._world, self._map = link, client, world, carla_map
        self._radius_m, self._who_has_lights = radius_m, lights
        self._library = world.get_blueprint_library()
        self._models = Models(self._library)
        self._kinds: dict[str, Kind] = {}
        self._actors: dict[str, int] = {}  # CARLA's actor by SUMO's vehicle
        self._lamps: dict[str, int] = {}
        self._mirrored: dict[int, float] = {}  # half length of CARLA's actors that drive in SUMO
        self._known: set[int] = set()  # actors of CARLA that were looked at
        self._waiting: set[str] = set()
        self._stand_ins: set[str] = set()
        self._departed = self._shown = self._most = 0
        self.is_level = True  # whether SUMO's heights are the map's
        self._remove_left_overs()
        self._lights = None
        if lights != "none":
            self._lights = Lights(link, world.get_actors().filter("traffic.traffic_light"))
        if lights == "sumo":
            world.freeze_all_traffic_lights(True)

    @property
    def counts(self) -> Counts:
        """What has been seen so far."""
        return Counts(self._departed, self._shown, len(self._waiting), self._most)

    @property
    def actor_ids(self) -> dict[str, int]:
        """CARLA's actors by SUMO's vehicles."""
        return dict(self._actors)

    # -- does it fit?

    def misfit_m(self, places_m: Iterable[tuple[float, float, float]]) -> float:
        """How far the network's lanes lie from places in the middle of lanes: the median, inf where none is near.

        Notes as well whether the network has the map's heights.
        """
        away_m, rises_m = [], []
        api = self.link.api.simulation
        for x_m, y_m, z_m in places_m:
            at = (x_m + self.link.offset_m[0], -y_m + self.link.offset_m[1])
            try:
                edge, along_m, lane = api.convertRoad(*at, isGeo=False, vClass="passenger")
                near = api.convert3D(edge, along_m, lane)
            except Exception:  # noqa: BLE001 - SUMO's error where no road is near; its type differs by link
                away_m.append(math.inf)
                continue
            away_m.append(math.dist(at, near[:2]))
            rises_m.append(abs(near[2] - z_m))
        self.is_level = not rises_m or sorted(rises_m)[len(rises_m) // 2] < LEVEL_M
        return sorted(away_m)[len(away_m) // 2] if away_m else math.inf

    # -- a tick

    def step(self, snapshot: carla.WorldSnapshot) -> None:
        """Move CARLA's actors in SUMO, let SUMO make a step, and show in CARLA where its vehicles are now.

        Raises:
            SimulatorError: SUMO or the simulator failed.
            UserError: a vehicle type cannot be shown.
        """
        with self.link.answering("moving CARLA's actors"):
            self._mirror(snapshot)
        if self._lights is not None and self._who_has_lights == "carla":
            self._lights.to_sumo()
        self.link.step()
        with self.link.answering("naming its vehicles"):
            states = self._states()
        self._most = max(self._most, len(states))
        try:
            self._show(states, self._centre(snapshot))
        except RuntimeError as error:
            raise SimulatorError(f"the simulator failed at showing SUMO's vehicles: {error}") from error

    def _centre(self, snapshot: carla.WorldSnapshot) -> carla.Location | None:
        """Where the circle of what is shown has its middle."""
        if self._radius_m is None or not self._mirrored:
            return None
        first = snapshot.find(min(self._mirrored))
        return None if first is None else first.get_transform().location

    # -- CARLA's actors in SUMO

    def _mirror(self, snapshot: carla.WorldSnapshot) -> None:
        """Move CARLA's own vehicles in SUMO to their poses, add new vehicles, and remove destroyed vehicles."""
        ids = {actor.id for actor in snapshot}
        fresh = ids - self._known
        if fresh:
            self._known |= fresh
            own = set(self._actors.values())
            for actor in sorted(self._world.get_actors(sorted(fresh - own)), key=lambda actor: int(actor.id)):
                if actor.type_id.startswith("vehicle.") and actor.attributes.get("role_name") != ROLE:
                    self._add_mirror(actor)
        vehicle = self.link.api.vehicle
        for actor_id in [actor_id for actor_id in self._mirrored if actor_id not in ids]:
            del self._mirrored[actor_id]
            if f"{MIRROR}{actor_id}" in vehicle.getIDList():
                vehicle.remove(f"{MIRROR}{actor_id}")
        for actor_id, half_m in self._mirrored.items():
            pose = snapshot.find(actor_id).get_transform()
            x_m, y_m, angle_deg = to_sumo(
                pose.location.x, pose.location.y, pose.rotation.yaw, half_m, self.link.offset_m
            )
            vehicle.moveToXY(f"{MIRROR}{actor_id}", "", -1, x_m, y_m, angle_deg, keepRoute=2)

    def _add_mirror(self, actor: carla.Actor) -> None:
        """Add a vehicle of CARLA to SUMO: one of its size, that SUMO does not drive."""
        api, name, extent = self.link.api, f"{MIRROR}{actor.id}", actor.bounding_box.extent
        base = self._models.base_types.get(str(actor.type_id), "car")
        api.vehicletype.copy("DEFAULT_VEHTYPE", name)
        api.vehicletype.setVehicleClass(name, CLASSES.get(base, "passenger"))
        api.vehicletype.setLength(name, 2.0 * extent.x)
        api.vehicletype.setWidth(name, 2.0 * extent.y)
        api.vehicletype.setHeight(name, 2.0 * extent.z)
        edge = next(edge for edge in api.edge.getIDList() if not edge.startswith(":"))
        api.route.add(name, [edge])
        api.vehicle.add(name, name, typeID=name)
        self._mirrored[int(actor.id)] = float(extent.x)

    # -- SUMO's vehicles in CARLA

    def _states(self) -> dict[str, dict[int, Any]]:
        """The variables of all vehicles that SUMO drives, by their names, in the order of the names."""
        api = self.link.api
        for name in sorted(api.simulation.getDepartedIDList()):
            if not name.startswith(MIRROR):
                self._departed += 1
                self._kinds[name] = self._kind(name)
                api.vehicle.subscribe(name, VARIABLES)
        states = api.vehicle.getAllSubscriptionResults()
        return {name: states[name] for name in sorted(states) if not name.startswith(MIRROR)}

    def _kind(self, name: str) -> Kind:
        """What is known of a vehicle; says once of each type that a stand-in shows it."""
        vehicle = self.link.api.vehicle
        kind, length_m = vehicle.getTypeID(name), vehicle.getLength(name)
        model = self._models.of(kind, vehicle.getVehicleClass(name), length_m)
        if not model.is_exact and kind not in self._stand_ins:
            self._stand_ins.add(kind)
            print(f"basu: note: SUMO's vehicle type '{kind}' is shown as {model.blueprint}", file=sys.stderr)  # noqa: T201
        colours = []
        blueprint = self._library.find(model.blueprint)
        if blueprint.has_attribute("color"):
            colours = list(blueprint.get_attribute("color").recommended_values)
        colour = colours[self._departed % len(colours)] if colours else None
        return Kind(model.blueprint, length_m, colour)

    def _show(self, states: dict[str, dict[int, Any]], centre: carla.Location | None) -> None:
        """Bring CARLA's actors to where SUMO's vehicles are, all by one batch."""
        command = carla.command
        commands: list[Any] = []
        spawned: dict[int, str] = {}  # by place in the batch
        wanted: set[str] = set()
        for name, state in states.items():
            pose = self._pose(name, state)
            if centre is not None and not self._is_near(name, pose, centre):
                continue
            wanted.add(name)
            actor_id = self._actors.get(name)
            transform = self._transform(pose)
            if actor_id is None:
                spawned[len(commands)] = name
                spawn = command.SpawnActor(self._blueprint(name), transform)
                commands.append(spawn.then(command.SetSimulatePhysics(command.FutureActor, False)))
                continue
            commands.append(command.ApplyTransform(actor_id, transform))
            lamps = _lamps(state[SIGNALS])
            if self._lamps.get(name, 0) != lamps:
                self._lamps[name] = lamps
                commands.append(command.SetVehicleLightState(actor_id, carla.VehicleLightState(lamps)))
        gone = [name for name in self._actors if name not in wanted]
        commands[:0] = [command.DestroyActor(self._actors.pop(name)) for name in gone]
        for name in gone:
            self._lamps.pop(name, None)
            if name not in states:
                self._kinds.pop(name, None)
        if self._lights is not None and self._who_has_lights == "sumo":
            self._lights.to_carla()
        self._take_in(self._client.apply_batch_sync(commands, False), spawned, len(gone), wanted)

    def _take_in(self, answers: Any, spawned: dict[int, str], before: int, wanted: set[str]) -> None:  # noqa: ANN401
        """Note the new actors; a vehicle without room is tried again in the next tick."""
        self._waiting &= wanted
        for place, name in spawned.items():
            answer = answers[before + place]
            if answer.has_error():
                self._waiting.add(name)
            else:
                self._waiting.discard(name)
                self._actors[name] = int(answer.actor_id)
                self._known.add(int(answer.actor_id))
                self._shown += 1

    def _pose(self, name: str, state: dict[int, Any]) -> Pose:
        kind = self._kinds[name]
        return from_sumo(state[POSITION], state[ANGLE], state[SLOPE], kind.length_m, self.link.offset_m)

    def _transform(self, pose: Pose) -> carla.Transform:
        """The pose on the ground: SUMO's heights where its network has the map's, else the map's own."""
        location = carla.Location(pose.x_m, pose.y_m, pose.z_m)
        if not self.is_level:
            below = self._map.get_waypoint(location, lane_type=carla.LaneType.Any)
            location.z = below.transform.location.z
        return carla.Transform(location, carla.Rotation(pose.pitch_deg, pose.yaw_deg, 0.0))

    def _is_near(self, name: str, pose: Pose, centre: carla.Location) -> bool:
        assert self._radius_m is not None, "there is a centre"
        limit_m = self._radius_m + (RADIUS_SLACK_M if name in self._actors else 0.0)
        return math.hypot(pose.x_m - centre.x, pose.y_m - centre.y) <= limit_m

    def _blueprint(self, name: str) -> carla.ActorBlueprint:
        kind = self._kinds[name]
        blueprint = self._library.find(kind.blueprint)
        blueprint.set_attribute("role_name", ROLE)
        if kind.colour is not None:
            blueprint.set_attribute("color", kind.colour)
        return blueprint

    # -- the end

    def _remove_left_overs(self) -> None:
        """Destroy what a dead bridge's process has left in this world."""
        left = [actor.id for actor in self._world.get_actors().filter("vehicle.*")
                if actor.attributes.get("role_name") == ROLE]  # fmt: skip
        if left:
            self._client.apply_batch_sync([carla.command.DestroyActor(actor_id) for actor_id in left], False)

    def close(self) -> None:
        """Take SUMO's vehicles out of the world, give its lights back, and end SUMO; what is gone already is fine."""
        ids, self._actors = list(self._actors.values()), {}
        with contextlib.suppress(RuntimeError):
            if ids:
                self._client.apply_batch_sync([carla.command.DestroyActor(actor_id) for actor_id in ids], False)
            if self._who_has_lights == "sumo":
                self._world.freeze_all_traffic_lights(False)
        self.link.close()


def _lamps(signals: int) -> int:
    """CARLA's lamps of SUMO's signals."""
    return sum(int(lamp) for bit, lamp in LAMPS if signals & bit)
