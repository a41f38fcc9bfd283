"""``FrameApplier`` sets actors to a recorded frame: pose, controls, velocity, wheels, doors, lamps, traffic lights."""

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.geometry import relative
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.replay.file.packets import Frame, Records, WheelTurns
from linden.replay.interpolation import ActorPlaces, within
from linden.replay.replayed_actors import ReplayedActors, ReplayedWorld
from linden.simulation.actor_table import NO_BODY

_EMBODIED = (BlueprintKind.VEHICLE, BlueprintKind.WALKER)
_FASTEST_MPS, _FASTEST_DEGPS, _FASTEST_WALKER_MPS = 1e3, 6e3, 50.0
"""As fast as physics lets a client make a body, turn it, and let a walker walk."""
_LONGEST_COLOUR_S = 1e9

Indices = NDArray[np.int64]


class _Found(NamedTuple):
    """The rows of a list that belong to replayed actors, and these actors."""

    rows: Indices
    actor_ids: Indices
    slots: Indices
    """Of their bodies; ``NO_BODY`` where they have none."""


class FrameApplier:
    """Moves replayed actors to their recorded poses."""

    def __init__(self, simulation: ReplayedWorld, replayed: ReplayedActors) -> None:
        self._simulation, self._replayed = simulation, replayed
        self._kept: dict[str, tuple[tuple[bytes, int, int], _Found]] = {}

    def put(self, where: ActorPlaces) -> None:
        """Move the actors to their recorded places."""
        bodies, found = self._simulation.episode.bodies, self._players("places", where.id)
        embodied = found.slots != NO_BODY
        rows, slots = found.rows[embodied], found.slots[embodied]
        bodies.position[slots] = where.location_m[rows]
        bodies.rotation[slots] = np.radians(where.rotation_deg[rows])
        bodies.velocity[slots] = 0.0
        bodies.angular_velocity[slots] = 0.0
        for row, actor_id in zip(found.rows[~embodied].tolist(), found.actor_ids[~embodied].tolist(), strict=True):
            location, rotation = where.location_m[row].tolist(), where.rotation_deg[row].tolist()
            self._place(actor_id, Transform(Vector3D(*location), Rotation(*rotation)))

    def _place(self, actor_id: int, pose: Transform) -> None:
        """Put an actor without a body somewhere in the world."""
        episode = self._simulation.episode
        parent_id = episode.actors.get(actor_id).parent_id
        episode.place(actor_id, relative(episode.transform(parent_id), pose) if parent_id else pose)

    def show(self, frame: Frame) -> None:
        """Let everybody do what they did in a frame."""
        self._drive(frame.vehicles)
        self._turn_wheels(frame.wheels)
        self._walk(frame.walkers)
        self._move(frame.kinematics)
        self._light(frame.light_states)
        lamps = self._players("lamps", frame.vehicle_lights["id"])
        actors = self._simulation.episode.actors
        for actor_id, bits in zip(
            lamps.actor_ids.tolist(), frame.vehicle_lights["bits"][lamps.rows].tolist(), strict=True
        ):
            actors.set_lamps(actor_id, bits)

    def _drive(self, vehicles: Records) -> None:
        found = self._players("vehicles", vehicles["id"], BlueprintKind.VEHICLE)
        bodies, slots, driven = self._simulation.episode.bodies, found.slots, vehicles[found.rows]
        for pedal, column in (("throttle", bodies.throttle), ("steer", bodies.steer), ("brake", bodies.brake)):
            column[slots] = within(driven[pedal], 1.0)
        bodies.hand_brake[slots] = driven["hand_brake"] != 0
        bodies.gear[slots] = bodies.gear_command[slots] = np.clip(driven["gear"], -1, bodies.spec(slots)["gear_count"])
        bodies.reverse[slots], bodies.manual_gear_shift[slots] = driven["gear"] < 0, False

    def _turn_wheels(self, wheels: Sequence[WheelTurns]) -> None:
        """Let the wheels of vehicles point and have rolled as recorded."""
        found = self._players("wheels", np.array([one.id for one in wheels], np.uint32), BlueprintKind.VEHICLE)
        bodies = self._simulation.episode.bodies
        for row, slot in zip(found.rows.tolist(), found.slots.tolist(), strict=True):
            count = int(bodies.spec(slot)["wheel_count"])
            for wheel in wheels[row].wheels:
                if wheel["wheel"] < count:
                    bodies.point_wheel(slot, int(wheel["wheel"]), float(within(wheel["steer_deg"], 360.0)))
                    bodies.roll_wheel(slot, int(wheel["wheel"]), float(within(wheel["turn_deg"], 360.0)))

    def swing_doors(self, doors: Records) -> None:
        """Open and close the doors that were opened or closed in a frame; a door that the vehicle lacks is skipped."""
        episode, of = self._simulation.episode, self._replayed.of
        for recorded_id, door, opens in doors.tolist():
            record = episode.actors.find(of.get(recorded_id, 0))
            if record is not None and record.kind is BlueprintKind.VEHICLE:
                with suppress(Refusal):
                    episode.doors.swing(record, door, opens=bool(opens))

    def _walk(self, walkers: Records) -> None:
        found = self._players("walkers", walkers["id"], BlueprintKind.WALKER)
        self._simulation.episode.bodies.walker_speed[found.slots] = np.abs(
            within(walkers["speed_mps"][found.rows], _FASTEST_WALKER_MPS)
        )

    def _move(self, kinematics: Records) -> None:
        """Let everybody have the velocity that was recorded, for sensors to see; CARLA leaves it at 0."""
        found = self._players("moving", kinematics["id"], BlueprintKind.VEHICLE, BlueprintKind.WALKER)
        bodies = self._simulation.episode.bodies
        bodies.velocity[found.slots] = within(kinematics["velocity_mps"][found.rows], _FASTEST_MPS)
        turning_degps = within(kinematics["angular_velocity_degps"][found.rows], _FASTEST_DEGPS)
        bodies.angular_velocity[found.slots] = np.radians(turning_degps)

    def _light(self, states: Records) -> None:
        episode = self._simulation.episode
        found = self._players("lights", states["id"], BlueprintKind.TRAFFIC_LIGHT)
        if not len(found.rows):
            return
        shown = states[found.rows]
        lights = np.array([episode.light_ids.index(actor_id) for actor_id in found.actor_ids.tolist()])
        colour = np.where(shown["state"] < 0, TrafficLightState.UNKNOWN, shown["state"]).astype(np.uint8)
        colour = np.minimum(colour, np.uint8(TrafficLightState.UNKNOWN))
        elapsed_s = np.abs(within(shown["elapsed_s"], _LONGEST_COLOUR_S))
        episode.traffic.restore(lights, colour, elapsed_s, shown["frozen"] != 0)

    def _players(self, name: str, ids: NDArray[np.uint32], *kinds: BlueprintKind) -> _Found:
        """Return the replayed actors among ``ids``, of some kinds or any; cached until the set of actors changes.

        Actors that a client has destroyed meanwhile are left out.
        """
        actors = self._simulation.episode.actors
        key = (ids.tobytes(), self._replayed.version, actors.version)
        if name in self._kept and self._kept[name][0] == key:
            return self._kept[name][1]
        rows, found = [], []
        for row, recorded_id in enumerate(ids.tolist()):
            record = actors.find(self._replayed.of.get(recorded_id, 0))
            if record is None or (kinds and record.kind not in kinds):
                continue
            if record.kind in _EMBODIED and kinds and record.slot == NO_BODY:  # an attached one
                continue
            rows.append(row)
            found.append((record.id, record.slot))
        players = np.array(found, np.int64).reshape(-1, 2)
        answer = _Found(np.array(rows, np.int64), players[:, 0], players[:, 1])
        self._kept[name] = (key, answer)
        return answer
