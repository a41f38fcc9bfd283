"""What is between two antennas: nothing, roofs of vehicles, or something that stands.

Source of meaning: CARLA 0.9.16, PathLossModel.cpp. A ray goes from one antenna to the other, through the carriers of
both, through walkers, and through vehicles, which are noted. The first thing that stands ends it: a house, a tree, a
pole, a prop, the road on a hill.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.protocol.values.space import Vector3D
from linden.sensors.casting.caster import STATIC, Hits, Rays
from linden.sensors.devices.radio.path_loss import Edge, Path, PathState
from linden.sensors.view import Seen, actor_of_objects
from linden.simulation.actor_table import ActorRecord, ActorTable

_ON_M = 1e-3
"""How far behind what it passes a ray goes on."""


class Antenna(NamedTuple):
    """Where a station sends from, in the world, m; ``actor_id`` carries it, ``ground_m`` is the height of its foot."""

    actor_id: int
    location: Vector3D
    ground_m: float


class Link(NamedTuple):
    """Two antennas."""

    transmitter: Antenna
    receiver: Antenna

    @property
    def distance_m(self) -> float:
        """Between the antennas."""
        return math.dist(self.receiver.location, self.transmitter.location)


def paths(seen: Seen, actors: ActorTable, links: Sequence[Link]) -> list[Path]:
    """Return the way along each link; the rays of all of them are cast together."""
    start = np.array([link.transmitter.location for link in links], np.float64).reshape(-1, 3)
    apart = np.array([link.receiver.location for link in links], np.float64).reshape(-1, 3) - start
    reach_m = np.linalg.norm(apart, axis=1)
    direction = apart / np.maximum(reach_m, _ON_M)[:, None]
    passed_m = np.zeros(len(links))
    blocked = np.zeros(len(links), np.bool_)
    vehicles: list[dict[int, None]] = [{} for _ in links]
    rows = np.flatnonzero(reach_m > _ON_M)
    while len(rows):
        rays = Rays(
            (start[rows] + direction[rows] * passed_m[rows, None]).astype(np.float32),
            direction[rows].astype(np.float32),
        )
        hits = seen.caster.closest(rays, float((reach_m[rows] - passed_m[rows]).max()))
        passed_m[rows] += hits.distance_m
        met = passed_m[rows] < reach_m[rows]
        for row, actor_id in zip(rows[met].tolist(), _actors_met(seen, hits)[met].tolist(), strict=True):
            kind = _obstacle_kind(actors, links[row], actor_id)
            if kind is BlueprintKind.VEHICLE:
                vehicles[row][actor_id] = None
            blocked[row] = kind is BlueprintKind.OTHER
        passed_m[rows] += _ON_M
        rows = rows[met & ~blocked[rows]]
    return [
        _path(link, [] if is_blocked else [_edge(link, actors, vehicle) for vehicle in over], is_blocked=is_blocked)
        for link, over, is_blocked in zip(links, vehicles, blocked.tolist(), strict=True)
    ]


def _actors_met(seen: Seen, hits: Hits) -> NDArray[np.uint32]:
    """Return (N,) the actor that each ray met, 0 where it met none."""
    ids = np.zeros(len(hits.instance), np.uint32)
    moving, standing = hits.instance >= 0, hits.instance == STATIC
    ids[moving] = seen.instances.actor_id[hits.instance[moving]]
    things = seen.faces.object[seen.faces.first[0] + hits.triangle[standing]]
    ids[standing] = actor_of_objects(seen)[things]
    return ids


def _obstacle_kind(actors: ActorTable, link: Link, actor_id: int) -> BlueprintKind | None:
    """Return VEHICLE for a vehicle in the way, OTHER for what blocks it, None for what a message goes through."""
    if actor_id in (link.transmitter.actor_id, link.receiver.actor_id):
        return None
    record = actors.find(actor_id)
    if record is not None and record.kind is BlueprintKind.WALKER:
        return None
    is_vehicle = record is not None and record.kind is BlueprintKind.VEHICLE
    return BlueprintKind.VEHICLE if is_vehicle else BlueprintKind.OTHER


def roof_m(record: ActorRecord, location: Vector3D) -> float:
    """Return how high (world, m) the top of an actor's box is where the actor stands level."""
    return location.z + record.box.location.z + record.box.extent.z


def _edge(link: Link, actors: ActorTable, actor_id: int) -> Edge:
    """Return the roof of a vehicle as an edge across the middle of the vehicle, as in CARLA."""
    vehicle = actors.transform(actor_id).location
    ends = link.transmitter.location, link.receiver.location
    first_m, second_m = (math.hypot(vehicle.x - end.x, vehicle.y - end.y) for end in ends)
    share = first_m / max(first_m + second_m, _ON_M)
    line_m = ends[0].z + share * (ends[1].z - ends[0].z)
    return Edge(first_m, second_m, roof_m(actors.get(actor_id), vehicle) - line_m)


def _path(link: Link, edges: list[Edge], *, is_blocked: bool) -> Path:
    ground_m = min(link.transmitter.ground_m, link.receiver.ground_m)
    state = PathState.VEHICLES if edges else PathState.FREE
    return Path(
        link.distance_m,
        link.transmitter.location.z - ground_m,
        link.receiver.location.z - ground_m,
        PathState.BUILDINGS if is_blocked else state,
        edges,
    )
