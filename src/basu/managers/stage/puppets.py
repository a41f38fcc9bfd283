"""Those whom a scenario leads: one batch of commands a frame for all of them.

A vehicle's velocity and turning are set in every frame, as ScenarioRunner's ``SimpleVehicleControl`` does it, so that
a scenario's timing is exact; it still stands on its wheels, and whoever hits it is hit. Upwards it moves by itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.managers.world_changes import CONTROL_TOLERANCE, is_same_control

if TYPE_CHECKING:
    from basu.managers.stage.cast import Member

ROLLING = carla.VehicleControl()
HELD = carla.VehicleControl(brake=1.0, hand_brake=True)


class Motion(NamedTuple):
    """What a vehicle is told, in m/s and rad/s, or a walker (whose turning is 0)."""

    velocity_x_mps: float
    velocity_y_mps: float
    yaw_rate_radps: float


STILL = Motion(0.0, 0.0, 0.0)


class Puppets:
    """The vehicles and walkers that are led."""

    def __init__(self, client: carla.Client) -> None:
        self._client = client
        self._vehicles: dict[int, tuple[carla.Actor, Motion]] = {}
        self._new: list[object] = []  # commands that are sent once
        self._held: set[int] = set()
        self._walkers: dict[int, tuple[float, float]] = {}  # what each was told last, in m/s
        self._controls: dict[int, tuple[carla.Actor, Any]] = {}  # the control that each was given last

    def move(self, member: Member, velocity_x_mps: float, velocity_y_mps: float, yaw_rate_radps: float) -> None:
        """Lead a vehicle."""
        motion, actor = Motion(velocity_x_mps, velocity_y_mps, yaw_rate_radps), member.actor
        before = self._vehicles.get(actor.id)
        if motion == STILL and actor.id not in self._held:
            self._held.add(actor.id)
            self._control(actor, HELD)
            self._new.append(carla.command.ApplyTargetVelocity(actor.id, carla.Vector3D()))
        elif motion != STILL and (before is None or actor.id in self._held):
            self._held.discard(actor.id)
            self._control(actor, ROLLING)
        self._vehicles[actor.id] = (actor, motion)

    def walk(self, member: Member, velocity_x_mps: float, velocity_y_mps: float) -> None:
        """Lead a walker."""
        gait = (velocity_x_mps, velocity_y_mps)
        if self._walkers.get(member.actor.id) == gait:
            return
        self._walkers[member.actor.id] = gait
        speed_mps = math.hypot(velocity_x_mps, velocity_y_mps)
        control = carla.WalkerControl()
        control.speed = speed_mps
        if speed_mps > 0.0:
            control.direction = carla.Vector3D(velocity_x_mps / speed_mps, velocity_y_mps / speed_mps, 0.0)
        self._new.append(carla.command.ApplyWalkerControl(member.actor.id, control))
        self._controls[member.actor.id] = (member.actor, control)

    def let_go(self, member: Member) -> None:
        """Lead it no more."""
        if self._vehicles.pop(member.actor.id, None) is not None and member.actor.id in self._held:
            self._held.discard(member.actor.id)
            self._control(member.actor, ROLLING)

    def forget(self) -> None:
        """Lead nobody any more."""
        self._vehicles.clear()
        self._held.clear()
        self._walkers.clear()
        self._controls.clear()
        self._new.clear()

    def with_other_controls(self, snapshot: carla.WorldSnapshot) -> list[carla.Actor]:
        """Return the actors that have another control than they were given; each is returned once.

        Call it at the beginning of a frame: then all commands so far were sent before the step to it.
        """
        found = []
        for key, (actor, given) in list(self._controls.items()):
            if not snapshot.has_actor(key):
                continue
            had = actor.get_control()
            same = is_same_control(given, had) if isinstance(given, carla.VehicleControl) else _is_same_gait(given, had)
            if not same:
                found.append(actor)
                del self._controls[key]
        return found

    def _control(self, actor: carla.Actor, control: carla.VehicleControl) -> None:
        """Give a vehicle a control, once."""
        self._new.append(carla.command.ApplyVehicleControl(actor.id, control))
        self._controls[actor.id] = (actor, control)

    def carry_out(self) -> None:
        """Send what all of them are told."""
        commands, self._new = self._new, []
        for actor_id, (actor, motion) in self._vehicles.items():
            if motion == STILL:
                continue  # its brakes hold it
            rise_mps = actor.get_velocity().z
            velocity = carla.Vector3D(motion.velocity_x_mps, motion.velocity_y_mps, rise_mps)
            turning = carla.Vector3D(0.0, 0.0, math.degrees(motion.yaw_rate_radps))
            commands.append(carla.command.ApplyTargetVelocity(actor_id, velocity))
            commands.append(carla.command.ApplyTargetAngularVelocity(actor_id, turning))
        if commands:
            self._client.apply_batch(commands)


def _is_same_gait(one: carla.WalkerControl, other: carla.WalkerControl) -> bool:
    """Whether two walkers' controls are equal but for the rounding of the wire; a resting one has no direction."""
    if abs(one.speed - other.speed) > CONTROL_TOLERANCE:
        return False
    apart = math.hypot(one.direction.x - other.direction.x, one.direction.y - other.direction.y)
    return one.speed <= 0.0 or apart < CONTROL_TOLERANCE
