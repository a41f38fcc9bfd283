"""Questions to a recording, under the names of ScenarioRunner's ``MetricsLog``, so that its metric classes run on it.

Frames count from 1. An actor is named by its id or its role name. What the recording does not have
is None. Where the answers differ from ScenarioRunner's, and why: docs/how-to/recording.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu_carla_log import carla_values as values
from basu_carla_log.arrays import ActorArrays, actor_arrays
from basu_carla_log.finder import Actor, Finder
from basu_carla_log.layouts import Kind

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla

    from basu_carla_log.log import Log


class Collision(NamedTuple):
    """Two in contact in a frame; the other is 4294967295 where it is scenery."""

    frame: int
    t_s: float
    actor_id: int
    other_id: int


class MetricsLog:
    """Queries of a recording. ``log`` has its columns."""

    def __init__(self, log: Log) -> None:
        self.log = log
        self._find = Finder(log)

    # --- the run

    def get_total_frame_count(self) -> int:
        """How many frames there are."""
        return self.log.frames

    def get_elapsed_time(self, frame: int) -> float:
        """Simulated s since the recording began."""
        return float(self.log.elapsed_s[self._find.index(frame)])

    def get_delta_time(self, frame: int) -> float:
        """Simulated s since the frame before, 0 in the first."""
        index = self._find.index(frame)
        return float(self.log.elapsed_s[index] - self.log.elapsed_s[index - 1]) if index else 0.0

    def get_platform_time(self, frame: int) -> float | None:
        """S of the machine's clock since the recording began."""
        time_s = float(self.log.platform_s[self._find.index(frame)])
        return None if np.isnan(time_s) else time_s

    def get_collisions(self) -> list[Collision]:
        """All contacts of the recording, in the order of the file."""
        table = self.log.table(Kind.COLLISIONS)
        return [
            Collision(int(frame), self.get_elapsed_time(int(frame)), int(row["id"]), int(row["other_id"]))
            for frame, row in zip(table.frame, table.rows, strict=True)
        ]

    def get_actor_collisions(self, actor_id: Actor) -> dict[int, list[int]]:
        """The actors that an actor touched, by frame."""
        wanted, found = self._find.id(actor_id), dict[int, list[int]]()
        for contact in self.get_collisions():
            pair = (contact.actor_id, contact.other_id)
            if wanted in pair:
                other = pair[1] if pair[0] == wanted else pair[0]
                others = found.setdefault(contact.frame, [])
                if other not in others:
                    others.append(other)
        return found

    # --- the actors

    def get_ego_vehicle_id(self) -> int:
        """The id of the first actor with the role ``hero``."""
        return self._find.id("hero")

    def get_actor_ids_with_role_name(self, role_name: str) -> list[int]:
        """Ids in the order in which the actors came."""
        return list(self.log.ids_of(role_name=role_name))

    def get_actor_ids_with_type_id(self, type_id: str) -> list[int]:
        """Likewise; ``type_id`` may have wildcards, as ``vehicle.*``."""
        return list(self.log.ids_of(type_id=type_id))

    def get_actor_attributes(self, actor_id: Actor) -> dict[str, Any] | None:
        """What is known of an actor: its type, attributes (texts), first place, box, parent, frames."""
        return self._find.actors.get(self._find.id(actor_id))

    def get_actor_bounding_box(self, actor_id: Actor) -> carla.BoundingBox | None:
        """Its box around its own origin, in m."""
        return (self.get_actor_attributes(actor_id) or {}).get("bounding_box")

    def get_traffic_light_trigger_volume(self, traffic_light_id: Actor) -> carla.BoundingBox | None:
        """The box in which a light speaks to a vehicle."""
        return (self.get_actor_attributes(traffic_light_id) or {}).get("trigger_volume")

    def get_actor_alive_frames(self, actor_id: Actor) -> tuple[int | None, int | None]:
        """The first and the last frame an actor is in."""
        actor = self.get_actor_attributes(actor_id)
        if actor is None:
            return None, None
        return actor["created"], actor["destroyed"] - 1 if "destroyed" in actor else self.log.frames

    def get_actor_arrays(self, actor_id: Actor) -> ActorArrays:
        """All of an actor's run as numpy arrays."""
        return actor_arrays(self.log, self._find.locations_m, self._find.id(actor_id))

    # --- where they are, and how they move

    def get_actor_transform(self, actor_id: Actor, frame: int) -> carla.Transform | None:
        """Where an actor is in the world."""
        return self._find.transform(actor_id, frame)

    def get_actor_velocity(self, actor_id: Actor, frame: int) -> carla.Vector3D | None:
        """In m/s, world."""
        return self._find.vector(Kind.VELOCITIES, "velocity_mps", actor_id, frame)

    def get_actor_angular_velocity(self, actor_id: Actor, frame: int) -> carla.Vector3D | None:
        """In degrees/s."""
        return self._find.vector(Kind.VELOCITIES, "angular_degps", actor_id, frame)

    def get_actor_acceleration(self, actor_id: Actor, frame: int) -> carla.Vector3D | None:
        """In m/s2: the change of velocity since the frame before, zero in an actor's first."""
        now = self.get_actor_velocity(actor_id, frame)
        if now is None:
            return None
        before = self.get_actor_velocity(actor_id, frame - 1) if frame > 1 else None
        step_s = self.get_delta_time(frame)
        return values.vector((0, 0, 0)) if before is None or step_s <= 0.0 else (now - before) / step_s

    def get_vehicle_control(self, vehicle_id: Actor, frame: int) -> carla.VehicleControl | None:
        """The control in force."""
        row = self._find.row(Kind.CONTROLS, vehicle_id, frame)
        return None if row is None else values.control(row)

    def get_vehicle_physics_control(self, vehicle_id: Actor, frame: int) -> carla.VehiclePhysicsControl | None:
        """A vehicle's parts, by the last record until a frame."""
        made_of = self._find.physics(vehicle_id, frame)
        return None if made_of is None else values.physics_control(made_of)

    def get_walker_speed(self, walker_id: Actor, frame: int) -> float | None:
        """The commanded speed of a walker, m/s."""
        row = self._find.row(Kind.WALKER_SPEEDS, walker_id, frame)
        return None if row is None else float(row["speed_mps"])

    # --- lights

    def get_traffic_light_state(self, traffic_light_id: Actor, frame: int) -> carla.TrafficLightState | None:
        """Its colour."""
        row = self._find.row(Kind.LIGHT_STATES, traffic_light_id, frame)
        return None if row is None else values.light_state(int(row["state"]))

    def is_traffic_light_frozen(self, traffic_light_id: Actor, frame: int) -> bool | None:
        """Whether a client stopped its cycle."""
        row = self._find.row(Kind.LIGHT_STATES, traffic_light_id, frame)
        return None if row is None else bool(row["frozen"])

    def get_traffic_light_elapsed_time(self, traffic_light_id: Actor, frame: int) -> float | None:
        """S since its colour changed."""
        row = self._find.row(Kind.LIGHT_STATES, traffic_light_id, frame)
        return None if row is None else float(row["elapsed_s"])

    def get_traffic_light_state_time(
        self, traffic_light_id: Actor, state: carla.TrafficLightState, frame: int
    ) -> float | None:
        """How long a colour lasts, s, by the last record until a frame."""
        row = self._find.last(Kind.LIGHT_TIMES, traffic_light_id, frame)
        column = {"Green": "green_s", "Yellow": "yellow_s", "Red": "red_s"}.get(str(state))
        return None if row is None or column is None else float(row[column])

    def get_vehicle_lights(self, vehicle_id: Actor, frame: int) -> list[carla.VehicleLightState] | None:
        """The lamps that are on, ``[NONE]`` where none is."""
        row = self._find.row(Kind.VEHICLE_LIGHTS, vehicle_id, frame)
        return None if row is None else values.lamps(int(row["bits"]))

    def is_vehicle_light_active(self, light: carla.VehicleLightState, vehicle_id: Actor, frame: int) -> bool:
        """Return whether a lamp of a vehicle is on in a frame."""
        return light in (self.get_vehicle_lights(vehicle_id, frame) or ())

    def get_scene_light_state(self, light_id: int, frame: int) -> carla.LightState | None:
        """A lamp of a street or house, as last switched until a frame."""
        row = self._find.last(Kind.SCENE_LIGHTS, light_id, frame)
        return None if row is None else values.scene_light(row)

    # --- several frames, several actors

    def get_all_actor_transforms(
        self, actor_id: Actor, first_frame: int | None = None, last_frame: int | None = None
    ) -> list[carla.Transform | None]:
        """One a frame, from the first to the last, both included; all where none is named."""
        return self._find.over(self.get_actor_transform, actor_id, first_frame, last_frame)

    def get_all_actor_velocities(
        self, actor_id: Actor, first_frame: int | None = None, last_frame: int | None = None
    ) -> list[carla.Vector3D | None]:
        """Likewise."""
        return self._find.over(self.get_actor_velocity, actor_id, first_frame, last_frame)

    def get_all_actor_angular_velocities(
        self, actor_id: Actor, first_frame: int | None = None, last_frame: int | None = None
    ) -> list[carla.Vector3D | None]:
        """Likewise."""
        return self._find.over(self.get_actor_angular_velocity, actor_id, first_frame, last_frame)

    def get_all_actor_accelerations(
        self, actor_id: Actor, first_frame: int | None = None, last_frame: int | None = None
    ) -> list[carla.Vector3D | None]:
        """Likewise."""
        return self._find.over(self.get_actor_acceleration, actor_id, first_frame, last_frame)

    def get_actor_transforms_at_frame(
        self, frame: int, actor_list: Iterable[int] | None = None
    ) -> dict[int, carla.Transform]:
        """By actor, of those in ``actor_list``, or of all."""
        return self._find.among(self.get_actor_transform, frame, actor_list)

    def get_actor_velocities_at_frame(
        self, frame: int, actor_list: Iterable[int] | None = None
    ) -> dict[int, carla.Vector3D]:
        """Likewise."""
        return self._find.among(self.get_actor_velocity, frame, actor_list)

    def get_actor_angular_velocities_at_frame(
        self, frame: int, actor_list: Iterable[int] | None = None
    ) -> dict[int, carla.Vector3D]:
        """Likewise."""
        return self._find.among(self.get_actor_angular_velocity, frame, actor_list)

    def get_actor_accelerations_at_frame(
        self, frame: int, actor_list: Iterable[int] | None = None
    ) -> dict[int, carla.Vector3D]:
        """Likewise."""
        return self._find.among(self.get_actor_acceleration, frame, actor_list)
