"""One frame of an episode as records of a recording: rows, lamps, contacts.

Layouts: ``linden.replay.file.layouts``. Colours of lamps go from 0 to 1 there.

CARLA records the events of collision sensors; here contacts are recorded without a sensor, one a pair. A query for two
kinds of actors distinguishes the first and the second actor of a collision. So the order is CARLA's: the hero or the
vehicle, then the other actor.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.protocol.values.episode import LightState
from linden.protocol.values.snapshot import TRAFFIC_LIGHT_ROW, VEHICLE_ROW, WALKER_ROW
from linden.protocol.values.space import Vector3D
from linden.replay.file import layouts
from linden.replay.file.packets import WheelTurns
from linden.sensors.devices.collision import SCENERY
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.episode import Episode
from linden.structured import StructuredArray

Rows = StructuredArray
Indices = NDArray[np.int64]

_ROLL_PITCH_YAW = [2, 0, 1]
_NOT_PLACED = (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN, BlueprintKind.SENSOR)
"""Kinds without recorded places in CARLA: they stand, or follow a parent."""


class ActorRows(NamedTuple):
    """The rows of each kind of actor; valid until the set of actors changes."""

    placed: Indices
    vehicles: Indices
    walkers: Indices
    moving: Indices
    lights: Indices
    vehicle_records: tuple[ActorRecord, ...]


def columns(episode: Episode) -> ActorRows:
    """Return the rows of each kind of actor in the snapshot."""
    actors = episode.actors

    def rows_where(*kinds: BlueprintKind) -> Indices:
        return np.array([actors.row(record.id) for record in actors if record.kind in kinds], np.int64)

    return ActorRows(
        placed=rows_where(*(kind for kind in BlueprintKind if kind not in _NOT_PLACED)),
        vehicles=rows_where(BlueprintKind.VEHICLE),
        walkers=rows_where(BlueprintKind.WALKER),
        moving=rows_where(BlueprintKind.VEHICLE, BlueprintKind.WALKER),
        lights=rows_where(BlueprintKind.TRAFFIC_LIGHT),
        vehicle_records=tuple(record for record in actors if record.kind is BlueprintKind.VEHICLE),
    )


def positions(rows: Rows, placed: Indices) -> StructuredArray:
    """Return where everybody is, but for the locations, which are left to the caller."""
    found = np.empty(len(placed), layouts.POSITION)
    found["id"] = rows["id"][placed]
    found["rotation_deg"] = rows["rotation"][placed][:, _ROLL_PITCH_YAW]
    return found


def vehicles(rows: Rows, of: Indices) -> StructuredArray:
    """Return how vehicles are driven."""
    return _copied(rows.view(VEHICLE_ROW), of, layouts.VEHICLE, ("steer", "throttle", "brake", "hand_brake", "gear"))


def walkers(rows: Rows, of: Indices) -> StructuredArray:
    """Return how fast walkers were told to walk."""
    found = np.empty(len(of), layouts.WALKER)
    found["id"], found["speed_mps"] = rows["id"][of], rows.view(WALKER_ROW)["speed"][of]
    return found


def light_states(rows: Rows, of: Indices) -> StructuredArray:
    """Return how traffic lights stand."""
    lights = rows.view(TRAFFIC_LIGHT_ROW)
    found = np.empty(len(of), layouts.LIGHT_STATE)
    found["id"], found["frozen"] = lights["id"][of], lights["frozen"][of]
    found["elapsed_s"], found["state"] = lights["elapsed_time"][of], lights["state"][of]
    return found


def light_times(rows: Rows, of: Indices) -> StructuredArray:
    """Return for how long the colours of traffic lights last."""
    lights = rows.view(TRAFFIC_LIGHT_ROW)
    found = np.empty(len(of), layouts.LIGHT_TIME)
    found["id"] = lights["id"][of]
    for colour in ("green", "yellow", "red"):
        found[f"{colour}_s"] = lights[f"{colour}_time"][of]
    return found


def kinematics(rows: Rows, of: Indices) -> StructuredArray:
    """Return how actors move."""
    found = np.empty(len(of), layouts.KINEMATICS)
    found["id"] = rows["id"][of]
    found["velocity_mps"] = rows["velocity"][of]
    found["angular_velocity_degps"] = rows["angular_velocity"][of]
    return found


def lamps(records: Sequence[ActorRecord]) -> StructuredArray:
    """Return which lamps of vehicles are lit."""
    return np.array([(record.id, record.light_state) for record in records], layouts.VEHICLE_LIGHT)


def wheels(episode: Episode, records: Sequence[ActorRecord]) -> list[WheelTurns]:
    """Return steering angle and rotation of every wheel of the vehicles that have a body, as the client reads them."""
    bodies = episode.bodies
    steer_deg, turn_deg = np.degrees(bodies.wheel_steer), -np.degrees(bodies.wheel_turned)
    found = []
    for record in records:
        if record.slot == NO_BODY:
            continue
        count = int(bodies.spec(record.slot)["wheel_count"])
        turns = np.empty(count, layouts.WHEEL)
        turns["wheel"] = np.arange(count)
        turns["steer_deg"] = steer_deg[record.slot, :count]
        turns["turn_deg"] = turn_deg[record.slot, :count]
        found.append(WheelTurns(record.id, turns))
    return found


def doors(before: Mapping[int, frozenset[int]], after: Mapping[int, frozenset[int]]) -> StructuredArray:
    """Return the doors that stand otherwise than before, by actor id and door."""
    moved = [
        (actor_id, door, door in after.get(actor_id, frozenset()))
        for actor_id in sorted({*before, *after})
        for door in sorted(before.get(actor_id, frozenset()) ^ after.get(actor_id, frozenset()))
    ]
    return np.array(moved, layouts.DOOR)


def _copied(rows: Rows, of: Indices, layout: "np.dtype[np.void]", fields: Sequence[str]) -> StructuredArray:
    found = np.empty(len(of), layout)
    for field in ("id", *fields):
        found[field] = rows[field][of]
    return found


_FULL = 255.0


def records(lamps: Sequence[LightState]) -> StructuredArray:
    """Return lamps as ``layouts.SCENE_LIGHT``."""
    found = [
        (lamp.id, lamp.intensity, (*(part / _FULL for part in lamp.color), 1.0), lamp.active, lamp.group)
        for lamp in lamps
    ]
    return np.array(found, layouts.SCENE_LIGHT)


def states(found: StructuredArray) -> list[LightState]:
    """Return records as lamps; where they are stands nowhere in the file."""
    return [
        LightState(
            lamp_id, Vector3D(), intensity, kind, (_byte(rgba[0]), _byte(rgba[1]), _byte(rgba[2])), active=bool(on)
        )
        for lamp_id, intensity, rgba, on, kind in found.tolist()
    ]


def _byte(share: float) -> int:
    return round(min(max(share, 0.0), 1.0) * _FULL) if share == share else 0  # noqa: PLR0124 - a damaged file's nan


_RANK = {BlueprintKind.VEHICLE: 1, BlueprintKind.WALKER: 2}
_LAST_RANK = 3


def collisions(episode: Episode, first_number: int) -> StructuredArray:
    """Return the collisions of the last step, numbered from ``first_number``."""
    pairs: dict[tuple[int, int], tuple[bool, bool]] = {}
    for slot, other_slot in episode.contacts[["a", "b"]].tolist():
        actor = episode.actors.of_slot(slot)
        if other_slot == SCENERY:
            pairs[actor.id, layouts.SCENERY] = (_is_hero(actor), False)
            continue
        first, second = sorted((actor, episode.actors.of_slot(other_slot)), key=_rank)
        pairs[first.id, second.id] = (_is_hero(first), _is_hero(second))
    found = [(first_number + place, *pair, *heroes) for place, (pair, heroes) in enumerate(pairs.items())]
    return np.array(found, layouts.COLLISION)


def _is_hero(actor: ActorRecord) -> bool:
    return actor.description.attribute("role_name") == "hero"


def _rank(actor: ActorRecord) -> tuple[int, int]:
    return 0 if _is_hero(actor) else _RANK.get(actor.kind, _LAST_RANK), actor.id
