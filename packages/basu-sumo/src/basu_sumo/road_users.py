"""SUMO's road users as they are to be shown: vehicles and people of one step, each with blueprint, pose and lamps."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu_sumo.frames import Pose, from_sumo
from basu_sumo.sideways import Sideways

if TYPE_CHECKING:
    from collections.abc import Collection

    from basu_sumo.link import Link
    from basu_sumo.models import Models

MIRROR = "carla"  # begins the ids of CARLA's actors in SUMO

# SUMO's variables, TraCI protocol: libsumo/TraCIConstants.h
POSITION, ANGLE, SLOPE, SIGNALS, SPEED, VEHICLE = 0x39, 0x43, 0x36, 0x5B, 0x40, 0xC3
VEHICLE_VARIABLES = (POSITION, ANGLE, SLOPE, SIGNALS)
STAGE_DRIVING = 3
LOOK_STEPS = 20  # between two looks at what a person does that stands
PERSON_VARIABLES = (POSITION, ANGLE, SPEED, VEHICLE)

# SUMO's signals by CARLA's lamps: microsim/MSVehicle.h, enum Signalling
LAMPS = (
    (0b1, carla.VehicleLightState.RightBlinker),
    (0b10, carla.VehicleLightState.LeftBlinker),
    (0b1000, carla.VehicleLightState.Brake),
    (0b10000, carla.VehicleLightState.LowBeam),
)


class Look(NamedTuple):
    """What is known of a road user from its departure on."""

    blueprint: str
    length_m: float
    colour: str | None
    is_person: bool


class RoadUser(NamedTuple):
    """One of SUMO's road users after a step."""

    look: Look
    pose: Pose
    lamps: int  # CARLA's, of a vehicle
    speed_mps: float  # of a person; a vehicle is put to its pose and needs none


class Vehicles:
    """SUMO's own vehicles, step by step."""

    def __init__(self, link: Link, models: Models) -> None:
        """Look at no vehicle yet."""
        self._link, self._models = link, models
        self._looks: dict[str, Look] = {}
        self._stand_ins: set[str] = set()
        self._sideways = Sideways(float(link.api.simulation.getDeltaT()))
        self.departed = self.most = self.present = 0

    def read(self, held: Collection[str] = ()) -> dict[str, RoadUser]:
        """All vehicles that SUMO drives, by their names, in the order of the names; ``held`` have not departed yet."""
        api = self._link.api
        for name in sorted(api.simulation.getDepartedIDList()):
            if not name.startswith(MIRROR) and name not in held:
                self.depart(name)
        states = api.vehicle.getAllSubscriptionResults()
        found = {name: self._user(name, states[name]) for name in sorted(states) if not name.startswith(MIRROR)}
        for name in self._looks.keys() - found.keys():
            del self._looks[name]
            self._sideways.forget(name)
        self.present, self.most = len(found), max(self.most, len(found))
        return found

    def depart(self, name: str) -> None:
        """Take in a vehicle that SUMO has put on the road."""
        self.departed += 1
        self._looks[name] = self._look(name)
        self._link.api.vehicle.subscribe(name, VEHICLE_VARIABLES)

    def _user(self, name: str, state: dict[int, Any]) -> RoadUser:
        look = self._looks[name]
        pose = from_sumo(state[POSITION], state[ANGLE], state[SLOPE], look.length_m, self._link.offset_m)
        return RoadUser(look, self._sideways.shown(name, pose), _lamps(state[SIGNALS]), 0.0)

    def _look(self, name: str) -> Look:
        """Return what is known of a vehicle; says once of each type that a stand-in shows it."""
        vehicle = self._link.api.vehicle
        kind, length_m = vehicle.getTypeID(name), vehicle.getLength(name)
        model = self._models.of(kind, vehicle.getVehicleClass(name), length_m)
        if not model.is_exact and kind not in self._stand_ins:
            self._stand_ins.add(kind)
            print(f"basu: note: SUMO's vehicle type '{kind}' is shown as {model.blueprint}", file=sys.stderr)  # noqa: T201
        colours = self._models.colours_of(model.blueprint)
        colour = colours[self.departed % len(colours)] if colours else None
        return Look(model.blueprint, length_m, colour, is_person=False)


class People:
    """SUMO's own persons, step by step; a person in a vehicle is not seen."""

    def __init__(self, link: Link, models: Models) -> None:
        """Look at no person yet."""
        self._link, self._models = link, models
        self._looks: dict[str, Look] = {}
        self._beside: dict[str, tuple[float, float, float] | None] = {}  # where people stand that wait for a ride
        self._steps = 0
        self.departed = self.most = self.present = 0

    def read(self) -> dict[str, RoadUser]:
        """Return all persons on foot, by their names, in the order of the names."""
        api = self._link.api
        for name in sorted(api.simulation.getDepartedPersonIDList()):
            if not name.startswith(MIRROR):
                self.departed += 1
                self._looks[name] = Look(self._models.walker(self.departed), 0.0, None, is_person=True)
                api.person.subscribe(name, PERSON_VARIABLES)
        states = api.person.getAllSubscriptionResults()
        found = {
            name: self._user(name, states[name])
            for name in sorted(states)
            if name in self._looks and not states[name][VEHICLE]
        }
        for name in self._looks.keys() - states.keys():
            del self._looks[name]
            self._beside.pop(name, None)
        self._steps += 1
        self.present, self.most = len(found), max(self.most, len(found))
        return found

    def _user(self, name: str, state: dict[int, Any]) -> RoadUser:
        speed_mps = float(state[SPEED])
        if speed_mps > 0.0:
            self._beside.pop(name, None)
        elif name not in self._beside or self._steps % LOOK_STEPS == 0:
            self._beside[name] = self._place_beside(name, state[POSITION])
        at = self._beside.get(name) or state[POSITION]
        pose = from_sumo(at, state[ANGLE], 0.0, 0.0, self._link.offset_m)
        return RoadUser(self._looks[name], pose, 0, speed_mps)

    def _place_beside(self, name: str, at: tuple[float, float, float]) -> tuple[float, float, float] | None:
        """Return where a person that waits for a ride stands on the pavement; None for any other person.

        SUMO's own place for it, ``at``, is the edge of the lane that it waits at, in the way of what drives there. The
        place on the pavement lies as far along the street.
        """
        api = self._link.api
        if api.person.getStage(name, 0).type != STAGE_DRIVING:
            return None
        edge, at_m = api.person.getRoadID(name), api.person.getLanePosition(name)
        for nth in range(api.edge.getLaneNumber(edge)):
            lane = f"{edge}_{nth}"
            if for_people(api.lane.getAllowed(lane), api.lane.getDisallowed(lane)):
                last_m = api.lane.getLength(lane)
                near = api.simulation.convert3D(edge, min(at_m, last_m - 1.0), nth)
                ahead = api.simulation.convert3D(edge, min(at_m, last_m - 1.0) + 1.0, nth)
                on_m = sum((here - there) * (next_ - there) for here, there, next_ in zip(at, near, ahead, strict=True))
                x_m, y_m, z_m = api.simulation.convert3D(edge, min(max(0.0, at_m + on_m), last_m), nth)
                return float(x_m), float(y_m), float(z_m)
        return None


def for_people(allowed: tuple[str, ...], disallowed: tuple[str, ...]) -> bool:
    """Return whether people may use a lane with these permissions."""
    return "pedestrian" in allowed if allowed else "pedestrian" not in disallowed and "all" not in disallowed


def _lamps(signals: int) -> int:
    """CARLA's lamps of SUMO's signals."""
    return sum(int(lamp) for bit, lamp in LAMPS if signals & bit)
