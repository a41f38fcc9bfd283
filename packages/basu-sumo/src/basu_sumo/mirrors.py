"""CARLA's own actors in SUMO: vehicles and people of their size at their places, which SUMO's drivers give way to.

SUMO's drivers see persons at crossings only: not on a lane that is closed to people. So a walker is in SUMO twice, as a
person and as a vehicle of a person's size. SUMO ignores a vehicle that stands beside the lanes for vehicles.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu_sumo.frames import to_sumo
from basu_sumo.models import CLASSES
from basu_sumo.road_users import MIRROR, for_people

if TYPE_CHECKING:
    from collections.abc import Collection

    import carla

    from basu_sumo.link import Link
    from basu_sumo.models import Models

ROLE = "sumo"  # role_name of what a bridge has spawned: what is left over is found by it
EXACT = 2  # keepRoute of moveToXY: the place is taken as it is, on a road or not (TraCI protocol)
AT_ONCE_MPS2 = 1000.0
"""Deceleration of a mirrored actor. SUMO's own driver for it knows no way beyond its street and would stop at the end.
SUMO reports that as emergency braking. The other drivers expect the apparent deceleration, which is SUMO's usual."""
TO_THE_END_M = -1.0  # arrival position of a walk, SUMO's word for the end of the edge


class _Seen(NamedTuple):
    """What was last seen of an actor, CARLA's frame."""

    t_s: float
    at_m: tuple[float, float]
    speed_mps: float


class Mirrors:
    """The vehicles and walkers of a world that SUMO does not drive."""

    def __init__(self, link: Link, world: carla.World, models: Models) -> None:
        """Mirror nothing yet."""
        self._link, self._world, self._models = link, world, models
        self._half_m: dict[int, float] = {}  # half length of vehicles and walkers
        self._last: dict[int, _Seen] = {}
        self._walkers: set[int] = set()
        self._beginning: str | None = None  # of people: an edge that they may use
        self._has_looked = False
        self.places_m: tuple[tuple[float, float], ...] = ()  # of the vehicles, after the last move
        self.known: set[int] = set()  # actors that were looked at, or that a bridge has spawned

    @property
    def first_id(self) -> int | None:
        """The vehicle that was spawned first."""
        return min(self._half_m.keys() - self._walkers, default=None)

    def move(self, snapshot: carla.WorldSnapshot, own: Collection[int]) -> None:
        """Move CARLA's own actors in SUMO to their poses, add new ones, and remove the destroyed.

        ``own`` are the actors of the bridge, which SUMO has already.
        """
        ids = {actor.id for actor in snapshot}
        fresh = ids - self.known
        if fresh:
            self.known |= fresh
            found = self._world.get_actors(sorted(fresh.difference(own)))
            for actor in sorted(found, key=lambda actor: int(actor.id)):
                is_road_user = actor.type_id.startswith(("vehicle.", "walker."))
                if is_road_user and actor.attributes.get("role_name") != ROLE:
                    self._add(actor)
        self._remove(ids)
        t_s, vehicle, places_m = float(snapshot.timestamp.elapsed_seconds), self._link.api.vehicle, []
        for actor_id, half_m in self._half_m.items():
            pose = snapshot.find(actor_id).get_transform()
            at = to_sumo(pose.location.x, pose.location.y, pose.rotation.yaw, half_m, self._link.offset_m)
            vehicle.moveToXY(_name(actor_id), "", -1, *at, keepRoute=EXACT)
            self._set_speed(actor_id, (float(pose.location.x), float(pose.location.y)), t_s)
            if actor_id in self._walkers:
                self._move_person(_name(actor_id), *at)
            else:
                places_m.append((float(pose.location.x), float(pose.location.y)))
        self.places_m = tuple(places_m)

    def _set_speed(self, actor_id: int, at_m: tuple[float, float], t_s: float) -> None:
        """Tell SUMO how fast an actor is.

        SUMO's own figure is the distance along its lanes. Within junctions, a mirrored actor changes to lanes that
        begin elsewhere. Then SUMO's figure is 0 for some steps, and the drivers behind brake as hard as they can.
        """
        last = self._last.get(actor_id)
        if last is None or t_s <= last.t_s:  # several steps of SUMO in one tick keep the speed
            speed_mps = 0.0 if last is None else last.speed_mps
            t_s = t_s if last is None else last.t_s
        else:
            speed_mps = math.dist(at_m, last.at_m) / (t_s - last.t_s)
        self._last[actor_id] = _Seen(t_s, at_m, speed_mps)
        if last is not None:  # SUMO takes a speed of what is on the road: not before the first step
            self._link.api.vehicle.setPreviousSpeed(_name(actor_id), speed_mps)

    def _move_person(self, name: str, x_m: float, y_m: float, angle_deg: float) -> None:
        """Move a person; SUMO refuses a place far from any lane for people, and the person stays where it was."""
        person = self._link.api.person
        if self._pavement() is None:
            return
        try:
            person.moveToXY(name, "", x_m, y_m, angle_deg, keepRoute=EXACT)
        except self._link.errors:
            if name not in person.getIDList():  # its walk has ended
                self._add_person(name)

    def _add(self, actor: carla.Actor) -> None:
        """Add an actor to SUMO: a vehicle of its size that SUMO does not drive, and a person for a walker."""
        api, name, extent = self._link.api, _name(int(actor.id)), actor.bounding_box.extent
        is_walker = actor.type_id.startswith("walker.")
        base = self._models.base_types.get(str(actor.type_id), "car")
        api.vehicletype.copy("DEFAULT_VEHTYPE", name)
        api.vehicletype.setVehicleClass(name, CLASSES.get(base, "passenger"))
        api.vehicletype.setLength(name, 2.0 * extent.x)
        api.vehicletype.setWidth(name, 2.0 * extent.y)
        api.vehicletype.setHeight(name, 2.0 * extent.z)
        expected_mps2 = api.vehicletype.getDecel(name)
        api.vehicletype.setEmergencyDecel(name, AT_ONCE_MPS2)
        api.vehicletype.setDecel(name, AT_ONCE_MPS2)
        api.vehicletype.setApparentDecel(name, expected_mps2)
        api.route.add(name, [self._street()])
        api.vehicle.add(name, name, typeID=name)
        self._half_m[int(actor.id)] = float(extent.x)
        if is_walker:
            self._walkers.add(int(actor.id))
            if self._pavement() is not None:
                self._add_person(name)

    def _add_person(self, name: str) -> None:
        """Add a person to SUMO, which walks for as long as it is moved."""
        person, edge = self._link.api.person, self._pavement()
        assert edge is not None, "the caller has seen to it"
        person.add(name, edge, 0.0)
        person.appendWalkingStage(name, [edge], TO_THE_END_M)

    def _remove(self, ids: Collection[int]) -> None:
        """Remove from SUMO what the world has no more."""
        vehicle, person = self._link.api.vehicle, self._link.api.person
        for actor_id in [actor_id for actor_id in self._half_m if actor_id not in ids]:
            name = _name(actor_id)
            del self._half_m[actor_id]
            self._last.pop(actor_id, None)
            if name in vehicle.getIDList():
                vehicle.remove(name)
            if actor_id in self._walkers:
                self._walkers.remove(actor_id)
                if name in person.getIDList():
                    person.remove(name)

    def _street(self) -> str:
        """Return an edge to begin on; the first move takes the actor away from it."""
        edges: tuple[str, ...] = self._link.api.edge.getIDList()
        return next(edge for edge in edges if not edge.startswith(":"))

    def _pavement(self) -> str | None:
        """Return an edge that people may use; None in a network without any."""
        if not self._has_looked:
            self._has_looked = True
            api = self._link.api
            edges = (edge for edge in sorted(api.edge.getIDList()) if not edge.startswith(":"))
            lanes = (f"{edge}_{nth}" for edge in edges for nth in range(api.edge.getLaneNumber(edge)))
            found = (lane for lane in lanes if for_people(api.lane.getAllowed(lane), api.lane.getDisallowed(lane)))
            lane = next(found, None)
            self._beginning = None if lane is None else lane.rpartition("_")[0]
        return self._beginning


def _name(actor_id: int) -> str:
    """Return the id of an actor of CARLA in SUMO."""
    return f"{MIRROR}{actor_id}"
