"""Batches of commands, carried out in their order. Source: LibCarla 0.9.16, ``carla/rpc/Command.h``."""

from collections.abc import Callable
from functools import lru_cache
from itertools import groupby
from typing import Any, TypeAlias

import numpy as np

from linden.errors import Refusal
from linden.protocol.values.enums import AttachmentType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire import commands as cmd
from linden.protocol.wire.controls import Controls, Transforms
from linden.protocol.wire.rpc import Packed, packed_result
from linden.server.rpc import actors, vehicles, walkers
from linden.server.rpc import traffic_lights as lights
from linden.server.rpc import unreal as other_physics
from linden.server.rpc.context import Context
from linden.server.rpc.registry import method, told
from linden.simulation.actor_table import NO_BODY
from linden.simulation.attachments import hung

Answer: TypeAlias = tuple[Any, ...]
"""``((1, actor id),)`` or ``((0, (message,)),)``: CARLA's Response of an actor id."""

WORTH_AN_ARRAY = 8
"""Controls in a row from which setting them together is quicker than one after the other."""

RUN: dict[type[cmd.Command], Callable[..., object]] = {
    cmd.DestroyActor: actors.destroy_actor,
    cmd.ApplyVehicleControl: vehicles.apply_control_to_vehicle,
    cmd.ApplyVehicleAckermannControl: vehicles.apply_ackermann_control_to_vehicle,
    cmd.ApplyWalkerControl: walkers.apply_control_to_walker,
    cmd.ApplyWalkerState: walkers.apply_walker_state,
    cmd.ApplyVehiclePhysicsControl: vehicles.apply_physics_control,
    cmd.ApplyTransform: actors.set_actor_transform,
    cmd.ApplyLocation: actors.set_actor_location,
    cmd.ApplyTargetVelocity: actors.set_actor_target_velocity,
    cmd.ApplyTargetAngularVelocity: actors.set_actor_target_angular_velocity,
    cmd.ApplyImpulse: actors.add_actor_impulse,
    cmd.ApplyForce: actors.add_actor_force,
    cmd.ApplyAngularImpulse: actors.add_actor_angular_impulse,
    cmd.ApplyTorque: actors.add_actor_torque,
    cmd.SetSimulatePhysics: actors.set_actor_simulate_physics,
    cmd.SetEnableGravity: actors.set_actor_enable_gravity,
    cmd.SetAutopilot: vehicles.set_actor_autopilot,
    cmd.ShowDebugTelemetry: other_physics.show_vehicle_debug_telemetry,
    cmd.SetVehicleLightState: vehicles.set_light_bits,
    cmd.SetTrafficLightState: lights.set_traffic_light_state,
}
"""Commands with the same fields as a function that can also be called alone."""


@method("apply_batch", bare=True, advances=True)
def apply_batch(context: Context, batch: cmd.Batch, do_tick: bool) -> list[Answer] | Packed:  # noqa: FBT001 - the wire's order
    """Carry out commands in their order; one that fails says so in its own answer and stops none of the others."""
    answers: list[Answer] | Packed | None = _driven(context, batch[0]) if len(batch) == 1 else None
    if answers is None:
        answers = _carry_out(context, batch)
    if do_tick:
        context.advance()
    return answers


def _carry_out(context: Context, batch: cmd.Batch) -> list[Answer]:
    """Carry out commands in their order and return their answers."""
    answers: list[Answer] = []
    for kind, group in groupby(batch, type):
        run: list[Any] = list(group)
        if kind is Controls:
            answers += [answer for controls in run for answer in _drive(context, controls)]
        elif kind is Transforms:
            answers += [answer for transforms in run for answer in _place(context, transforms)]
        elif kind is cmd.ApplyVehicleControl and len(run) >= WORTH_AN_ARRAY:
            ids, fields = zip(*run, strict=True)
            answers += _drive(context, Controls(np.array(ids, np.int64), np.array(fields, np.float64)))
        elif kind is cmd.ApplyWalkerState and len(run) >= WORTH_AN_ARRAY:
            answers += _lead(context, run)
        else:
            answers += [_answer(context, command) for command in run]
    return answers


def _driven(context: Context, controls: object) -> Packed | None:
    """Set controls that all vehicles can take, and return the answers; None where one cannot, or these are others."""
    if type(controls) is not Controls or not _set_together(context, controls):
        return None
    return _all_done(controls.actor_ids.tobytes())


def _set_together(context: Context, controls: Controls) -> bool:
    """Set controls, and return whether all vehicles could take them; else none has taken any."""
    episode = context.world.episode
    slots = episode.vehicles(controls.actor_ids)
    if slots is None:
        return False
    episode.bodies.set_controls(slots, controls.fields)
    return True


@lru_cache(maxsize=8)
def _all_done(actor_ids: bytes) -> Packed:
    """Return the answers for these actors, as int64: a Traffic Manager sends the same in nearly every step."""
    return packed_result([cmd.done(actor_id) for actor_id in np.frombuffer(actor_ids, np.int64).tolist()])


def _drive(context: Context, controls: Controls) -> list[Answer]:
    """Set the controls of many vehicles at once: what a script for traffic sends every tick."""
    actor_ids = controls.actor_ids.tolist()
    if _set_together(context, controls):
        return [cmd.done(actor_id) for actor_id in actor_ids]
    episode = context.world.episode
    answers: list[Answer] = []
    for nth, actor_id in enumerate(actor_ids):
        try:
            episode.bodies.set_controls(np.array([episode.vehicle(actor_id)]), controls.fields[nth : nth + 1])
            answers.append(cmd.done(actor_id))
        except Refusal as refusal:  # noqa: PERF203 - each command fails or succeeds by itself
            answers.append(cmd.failed(told("apply_control_to_vehicle", refusal)))
    return answers


def _place(context: Context, transforms: Transforms) -> list[Answer]:
    """Put many actors somewhere at once; each by itself where one comes twice, has no body or is not there."""
    episode = context.world.episode
    records = [episode.actors.find(actor_id) for actor_id in transforms.actor_ids]
    slots = [NO_BODY if record is None else record.slot for record in records]
    if NO_BODY in slots or len(set(slots)) < len(slots):
        return [
            _answer(context, cmd.ApplyTransform(actor_id, Transform(Vector3D(*place[:3]), Rotation(*place[3:]))))
            for actor_id, place in zip(*transforms, strict=True)
        ]
    episode.place_bodies(np.array(slots), np.array(transforms.transforms))
    return [cmd.done(actor_id) for actor_id in transforms.actor_ids]


def _lead(context: Context, states: list[Any]) -> list[Answer]:
    """Lead many walkers at once, or each by itself where one of them cannot be led."""
    try:
        walkers.lead(context, states)
    except Refusal:
        return [_answer(context, state) for state in states]
    return [cmd.done(state.actor_id) for state in states]


def _answer(context: Context, command: cmd.Command) -> Answer:
    try:
        return cmd.done(_run(context, command))
    except Refusal as refusal:
        run = RUN.get(type(command))
        return cmd.failed(told(run.__name__ if run else "spawn_actor", refusal))


def _run(context: Context, command: cmd.Command) -> int:
    """Carry out one command and return the id of the actor it concerns.

    Raises:
        Refusal: it cannot be done.
    """
    if isinstance(command, cmd.SpawnActor):
        return _spawn(context, command)
    run = RUN.get(type(command))
    if run is None:
        raise Refusal(f"command {type(command).__name__}: CARLA has it, linden not yet")
    run(context, *command)
    return int(command[0])


def _spawn(context: Context, command: cmd.SpawnActor) -> int:
    """Spawn, then do what should follow; as in CARLA, what fails of the latter does not undo the spawn."""
    parent_id, socket = command.parent_id or 0, command.socket if command.parent_id else ""
    # the client leaves the attachment unset unless the script sets one; then any byte may come
    on_arm = command.parent_id and command.attachment in {AttachmentType.SPRING_ARM, AttachmentType.SPRING_ARM_GHOST}
    pose = hung(command.transform, command.attachment) if on_arm else command.transform
    record = actors.attach(context, command.description, pose, parent_id, socket)
    for follow_up in command.do_after:
        aimed = follow_up
        if not isinstance(follow_up, cmd.SpawnActor) and follow_up[0] == cmd.JUST_SPAWNED:
            aimed = follow_up._replace(actor_id=record.id)
        ((status, result),) = _answer(context, aimed)
        if not status:
            context.warn_once(f"{type(aimed).__name__} after spawning actor {record.id}: {result[0]}")
    return record.id
