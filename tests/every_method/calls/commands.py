"""carla.command: each command made and carried out in a batch, and its fields."""

from collections.abc import Callable
from typing import Any

import carla
from carla import command

from every_method.call import Call, Defect
from every_method.calls.actors import passing
from every_method.calls.traffic_manager import PORT, manager
from every_method.calls.vehicle_values import ackermann, control
from every_method.entries import fields, missing
from every_method.stage import Stage

PUSH = carla.Vector3D(x=10.0)
POSE = carla.Transform(carla.Location(1.0, 2.0, 30.0))


def car(stage: Stage) -> carla.Vehicle:
    """A car to order about."""
    return passing(stage)


def spectator(stage: Stage) -> carla.Actor:
    """Somebody who may be put anywhere."""
    return stage.once("spectator", stage.world.get_spectator)


def carried_out(make: Callable[[Stage], Any]) -> Call:
    """Return a row that puts a command into a batch: it is carried out, or refused by the sentence of its answer."""

    def call(stage: Stage) -> bool:
        (response,) = stage.client.apply_batch_sync([make(stage)])
        if response.has_error():
            raise RuntimeError(response.error)
        return True

    return call


def rows(name: str, make: Callable[[Stage], Any], **expected: Any) -> dict[str, Call]:
    """Return the rows of a command: carried out, and its fields read."""
    return {
        f"command.{name}.__init__": carried_out(make),
        f"command.{name}.actor_id": lambda s: make(s).actor_id > 0,
        **fields(f"command.{name}", make, **expected),
    }


def pushed(name: str) -> dict[str, Call]:
    """Return the rows of a command that pushes a car."""
    field = {"ApplyForce": "force", "ApplyTorque": "torque"}.get(name, "impulse")
    return rows(name, lambda s: getattr(command, name)(car(s), PUSH), **{field: PUSH})


def spawning(stage: Stage) -> command.SpawnActor:
    """A command that spawns a car."""
    blueprint = stage.once("library", stage.world.get_blueprint_library).find("vehicle.audi.a2")
    return command.SpawnActor(
        blueprint, next(stage.once("free points", lambda: iter(stage.map.get_spawn_points()[24::2])))
    )


def then_driven(stage: Stage) -> bool:
    """Whether what shall happen to the spawned car happens."""
    chained = spawning(stage).then(command.SetSimulatePhysics(command.FutureActor, True))
    (response,) = stage.client.apply_batch_sync([chained])
    return not response.has_error() and response.actor_id > 0


def response(stage: Stage, actor_id: int) -> command.Response:
    """The answer to the destruction of an actor."""
    (found,) = stage.client.apply_batch_sync([command.DestroyActor(actor_id)])
    return found


def physics(stage: Stage) -> carla.VehiclePhysicsControl:
    """The engine that the car has anyway."""
    return stage.once("engine", lambda: car(stage).get_physics_control())


CALLS: dict[str, Call] = {
    "command.FutureActor": lambda _: command.FutureActor == 0,
    **pushed("ApplyForce"),
    **pushed("ApplyImpulse"),
    **pushed("ApplyAngularImpulse"),
    **pushed("ApplyTorque"),
    **missing("command.ApplyTorque", {"transform": "the wheel calls it torque"}),
    **rows(
        "ApplyTargetVelocity",
        lambda s: command.ApplyTargetVelocity(car(s), carla.Vector3D()),
        velocity=carla.Vector3D(),
    ),
    **rows(
        "ApplyTargetAngularVelocity",
        lambda s: command.ApplyTargetAngularVelocity(car(s), carla.Vector3D()),
        angular_velocity=carla.Vector3D(),
    ),
    **rows("ApplyTransform", lambda s: command.ApplyTransform(spectator(s), POSE), transform=POSE),
    **rows("ApplyVehicleControl", lambda s: command.ApplyVehicleControl(car(s), control()), control=control()),
    **rows(
        "ApplyVehicleAckermannControl",
        lambda s: command.ApplyVehicleAckermannControl(car(s), ackermann()),
        control=ackermann(),
    ),
    **rows(
        "ApplyVehiclePhysicsControl",
        lambda s: command.ApplyVehiclePhysicsControl(car(s), physics(s)),
        physics_control=lambda found: found.mass > 100.0,
    ),
    **missing("command.ApplyVehiclePhysicsControl", {"control": "the wheel calls it physics_control"}),
    **rows(
        "ApplyWalkerControl",
        lambda s: command.ApplyWalkerControl(s.walker, carla.WalkerControl(speed=0.5)),
        control=carla.WalkerControl(speed=0.5),
    ),
    **rows(
        "ApplyWalkerState",
        lambda s: command.ApplyWalkerState(s.walker, s.walker.get_transform(), 1.0),
        speed=1.0,
        transform=lambda pose: isinstance(pose, carla.Transform),
    ),
    **rows(
        "SetAutopilot",
        lambda s: command.SetAutopilot(car(s), False, manager(s).get_port()),
        enabled=False,
        tm_port=PORT,
    ),
    **missing("command.SetAutopilot", {"port": "the wheel calls it tm_port"}),
    **rows("SetEnableGravity", lambda s: command.SetEnableGravity(car(s), True), enabled=True),
    **rows("SetSimulatePhysics", lambda s: command.SetSimulatePhysics(car(s), True), enabled=True),
    **rows(
        "SetVehicleLightState",
        lambda s: command.SetVehicleLightState(car(s).id, carla.VehicleLightState.Fog),
        light_state=lambda bits: int(bits) == 128,
    ),
    **fields(
        "command.ShowDebugTelemetry",
        lambda s: command.ShowDebugTelemetry(car(s).id, True),
        actor_id=lambda number: number > 0,
        enabled=True,
    ),
    "command.ShowDebugTelemetry.__init__": Defect(
        lambda s: s.client.apply_batch_sync([command.ShowDebugTelemetry(car(s).id, True)]),
        "TypeError",
        "it can be made, but the wheel does not take it into a batch",
    ),
    "command.SpawnActor.__init__": carried_out(spawning),
    "command.SpawnActor.then": then_driven,
    **fields(
        "command.SpawnActor",
        spawning,
        transform=lambda pose: isinstance(pose, carla.Transform),
        attachment_type=lambda kind: kind is not None,
        socket_name="",
    ),
    "command.SpawnActor.parent_id": Defect(
        lambda s: spawning(s).parent_id,
        "TypeError",
        "the wheel has no Python class for a number that may be absent",
    ),
    "command.DestroyActor.__init__": carried_out(lambda s: command.DestroyActor(s.spawn("static.prop.mailbox", 16))),
    "command.DestroyActor.actor_id": lambda s: command.DestroyActor(s.vehicle).actor_id == s.vehicle.id,
    "command.Response.actor_id": lambda s: (
        response(s, gone.id).actor_id == gone.id if (gone := s.spawn("static.prop.mailbox", 18)) else False
    ),
    "command.Response.error": lambda s: _error_of_nobody(s) != "",
    "command.Response.has_error": lambda s: _error_of_nobody(s) != "",
}


def _error_of_nobody(stage: Stage) -> str:
    """Return the error of an order to somebody who is not there; asked for aside, for it is meant to be refused."""
    with stage.aside():
        found = response(stage, 4_000_000)
    return str(found.error) if found.has_error() else ""
