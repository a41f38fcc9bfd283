"""`Episode`: a loaded map with its actors, weather and other parts; fills the rows of the world snapshot each frame."""

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import DOT, BlueprintKind
from linden.maps.library import LoadedMap
from linden.physics.contact.statics import Statics
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.snapshot import ROW, TRAFFIC_LIGHT_ROW, TRAFFIC_SIGN_ROW, WALKER_ROW
from linden.protocol.values.space import BoundingBox, Transform
from linden.simulation import snapshot_rows as rows
from linden.simulation.actor_table import NO_BODY, ActorRecord, ActorRefusal
from linden.simulation.attachments import Sockets
from linden.simulation.bones import Poses
from linden.simulation.doors import Doors
from linden.simulation.friction import RoadFriction
from linden.simulation.snapshot_rows import MOTION_OFFSET, gather_motion
from linden.simulation.state import EpisodeState
from linden.simulation.surroundings import Surroundings, scenery_of
from linden.simulation.walkers import Walkers
from linden.structured import StructuredArray
from linden.traffic.traffic import Traffic

DEFAULT_SPEED_LIMIT_KMH = 30.0
"""What CARLA's vehicles start with until a sign says otherwise."""

STANDARD_GRAVITY_MPS2 = 9.81
"""What CARLA's IMU adds unless told otherwise."""

_MPS_TO_KMH = 3.6
_MOTION = np.dtype(
    {"names": ["motion"], "formats": [("<f4", (15,))], "offsets": [MOTION_OFFSET], "itemsize": ROW.itemsize}
)


def limits_of_lanes_kmh(world_map: LoadedMap) -> NDArray[np.float64]:
    """Return the limit (L,) of each lane of a map for `limits_under`, nan for none.

    Lanes in a junction lie over one another: there the limit of the way in goes on.
    """
    lanes = world_map.lanes
    limits: NDArray[np.float64] = np.where(lanes["junction"] < 0, lanes["speed_limit_mps"] * _MPS_TO_KMH, np.nan)
    return limits


class Episode(EpisodeState):
    """Everything that ends with a load.

    Attributes:
        surroundings: what stands there, its lamps, and what clients drew.
        traffic: the lights.
        doors: of the vehicles, which stand open.
        friction: friction of the road, and the vehicles in friction triggers.
        walkers: controlled walkers, dead walkers, and distances walked.
        poses: of walkers, as clients set them.
        sockets: what is attached to a bone.
    """

    walkers: Walkers
    poses: Poses

    def __init__(self, world_map: LoadedMap, *, first_frame: int, first_actor_id: int = 1) -> None:
        super().__init__(world_map, first_frame, first_actor_id)
        self.walkers, self.poses = Walkers(), Poses()
        scenery = scenery_of(world_map)
        self.surroundings = Surroundings(scenery)
        self.traffic = Traffic(scenery.signals)
        self.doors, self.friction = Doors(), RoadFriction()
        self.sockets = Sockets()
        self.imu_gravity_mps2 = STANDARD_GRAVITY_MPS2
        self.spectator_id = self._add_fixture("spectator", BlueprintKind.OTHER, Transform(), DOT).id
        self.light_ids = self._add_traffic()
        first_light = self.actors.row(self.light_ids[0]) if self.light_ids else 0
        self._light_rows = slice(
            first_light, first_light + len(self.light_ids)
        )  # they come one after the other, to stay
        self._light_actor_id = np.array(self.light_ids, np.int32)
        self._limit_of_lane_kmh = limits_of_lanes_kmh(world_map)
        self._speed_limit_kmh: dict[int, float] = {}
        self._seen_version = -1

    def _add_fixture(
        self, type_id: str, kind: BlueprintKind, pose: Transform, box: BoundingBox, tags: bytes = b""
    ) -> ActorRecord:
        record = ActorRecord(
            id=self.actors.next_id(),
            description=ActorDescription(0, type_id),
            kind=kind,
            box=box,
            semantic_tags=tags,
        )
        self.actors.add(record, pose)
        return record

    def _add_traffic(self) -> list[int]:
        """Make actors of lights and signs; returns the ids of the lights in their order."""
        light_ids: list[int] = []
        for index, item in enumerate(self.traffic.actors):
            is_light = index in self.traffic.lights
            kind, layout = (
                (BlueprintKind.TRAFFIC_LIGHT, TRAFFIC_LIGHT_ROW)
                if is_light
                else (BlueprintKind.TRAFFIC_SIGN, TRAFFIC_SIGN_ROW)
            )
            record = self._add_fixture(item.type_id, kind, item.transform, item.box, item.semantic_tags)
            row = self.actors.rows.view(layout)[self.actors.row(record.id)]
            row["sign_id"] = item.sign_id.encode()[:32]
            if is_light:
                row["pole_index"] = self.traffic.pole_index(len(light_ids))
                light_ids.append(record.id)
        return light_ids

    @property
    def statics(self) -> Statics:
        """Oriented boxes that stand in the way, as ``physics`` takes them."""
        return self.surroundings.statics

    def vehicles(self, actor_ids: NDArray[np.int64]) -> NDArray[np.int32] | None:
        """Return the slots (K,) of vehicles (K,), None where one of them is no vehicle."""
        if self._seen_version != self.actors.version:
            self._survey()
        ids, slots = self._vehicle_index
        if not len(ids):
            return None
        places = np.searchsorted(ids, actor_ids)
        places[places == len(ids)] = 0
        return slots[places] if np.array_equal(ids[places], actor_ids) else None

    def light(self, actor_id: int) -> int:
        """Return the number of a traffic light.

        Raises:
            ActorRefusal: no such actor, or no traffic light.
        """
        if self.actors.get(actor_id).kind is not BlueprintKind.TRAFFIC_LIGHT:
            raise ActorRefusal("Actor is not a traffic light", actor_id)
        return self.light_ids.index(actor_id)

    # -- what the snapshot shows ---------------------------------------------------------------------------------

    def observe(self) -> None:
        """Bring the rows of the snapshot up to date with everything else."""
        if self._seen_version != self.actors.version:
            self._survey()
        actors, bodies, count = self.actors, self.bodies, len(self.actors)
        gather_motion(
            count, actors.pose, actors.relative, actors.parent_row, actors.slot,
            bodies.position, bodies.rotation, bodies.velocity, bodies.angular_velocity, bodies.acceleration,
            self._motion,
        )  # fmt: skip
        self._motion_of_rows[:count] = self._motion[:count]
        if self.light_ids:
            self.traffic.write(self._rows_of_lights)
        if len(self._vehicle_slots):
            self._observe_vehicles()
        if len(self._walker_slots):
            walkers, slots = actors.rows.view(WALKER_ROW), self._walker_slots
            walkers["direction"][self._walker_rows] = bodies.walker_direction[slots]
            walkers["speed"][self._walker_rows] = bodies.walker_speed[slots]
            walkers["jump"][self._walker_rows] = bodies.jump[slots]

    def warm_up(self) -> None:
        """Compile, or load from the cache, what only vehicles need, so that the first one does not wait for it."""
        self.observe()
        self._observe_vehicles()

    def walker_ids_and_slots(self) -> tuple[list[int], NDArray[np.int32]]:
        """Return ids and slots of all walkers, oldest first."""
        if self._seen_version != self.actors.version:
            self._survey()
        return self._walker_ids, self._walker_slots

    def _survey(self) -> None:
        """Note which rows are vehicles' and walkers'; called when the set of actors has changed."""
        self._keep_limits()
        self._vehicle_ids, self._vehicle_slots, self._vehicle_rows = self._embodied(BlueprintKind.VEHICLE)
        self._vehicle_actor_id = np.array(self._vehicle_ids, np.int32)
        order = np.argsort(self._vehicle_actor_id)
        self._vehicle_index = self._vehicle_actor_id[order].astype(np.int64), self._vehicle_slots[order]
        self._walker_ids, self._walker_slots, self._walker_rows = self._embodied(BlueprintKind.WALKER)
        self._limits_kmh = np.array(
            [self._speed_limit_kmh.get(actor_id, DEFAULT_SPEED_LIMIT_KMH) for actor_id in self._vehicle_ids]
        )
        self._row_bytes: NDArray[np.uint8] = self.actors.rows.view(np.uint8).reshape(-1, ROW.itemsize)
        self._motion = np.zeros((len(self.actors.rows), 15), np.float32)
        self._motion_of_rows: NDArray[np.float32] = self.actors.rows.view(_MOTION)["motion"]
        self._rows_of_lights: StructuredArray = self.actors.rows.view(TRAFFIC_LIGHT_ROW)[self._light_rows]
        self._seen_version = self.actors.version

    def _embodied(self, kind: BlueprintKind) -> tuple[list[int], NDArray[np.int32], NDArray[np.int32]]:
        """Return ids, slots and rows of all actors of a kind that have a body."""
        found = [record for record in self.actors if record.kind is kind and record.slot != NO_BODY]
        slots = np.array([record.slot for record in found], np.int32)
        rows_of_kind = np.array([self.actors.row(record.id) for record in found], np.int32)
        return [record.id for record in found], slots, rows_of_kind

    def _keep_limits(self) -> None:
        if self._seen_version >= 0:
            self._speed_limit_kmh = dict(zip(self._vehicle_ids, map(float, self._limits_kmh), strict=True))

    def _observe_vehicles(self) -> None:
        bodies, slots = self.bodies, self._vehicle_slots
        rows.write_controls(
            self._row_bytes, self._vehicle_rows, slots, bodies.throttle, bodies.steer, bodies.brake,
            bodies.hand_brake, bodies.reverse, bodies.manual_gear_shift, bodies.gear,
        )  # fmt: skip
        self._row_bytes[self._vehicle_rows, rows.FAILURE_STATE] = bodies.failure[slots]
        rows.limits_under(
            self.map.ground, self.map.lane_of_triangle, self._limit_of_lane_kmh, bodies.position, slots,
            self._limits_kmh,
        )  # fmt: skip
        where = (bodies.position, bodies.rotation, bodies.box_centre, bodies.half_extent, slots)
        light = self.traffic.over(*where)
        at_sign = self.traffic.at_signs(*where, self._vehicle_actor_id, self.elapsed_s)
        rows.write_surroundings(
            self._row_bytes, self._vehicle_rows, self._limits_kmh, light, self.traffic.state.colour,
            self._light_actor_id, at_sign,
        )  # fmt: skip
