"""The commands of a batch as named tuples, and their decoding. Source: ``carla/rpc/Command.h``, 0.9.16.

On the wire a command is ``[[index, body]]``: a struct of one member around the variant. The order of the variant is
that of the template's name in the official client's own symbols (which has ApplyLocation before ConsoleCommand).
"""

from collections.abc import Callable
from itertools import groupby
from typing import Annotated, Any, NamedTuple, TypeAlias, cast

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import AckermannControl, VehiclePhysicsControl, WalkerControl
from linden.protocol.values.space import Transform, Vector3D
from linden.protocol.wire.controls import (
    WORTH_COLUMNS,
    ClientControl,
    Controls,
    Transforms,
    plain_controls,
    plain_transforms,
)
from linden.protocol.wire.decode import U8, U32, DecodedBy, Decoder, WireTypeError, got, struct_decoder

JUST_SPAWNED = 0
"""The actor id that a command in ``do_after`` gives for the actor which its SpawnActor makes."""

MAX_NESTED_SPAWNS = 4
"""How deep SpawnActor may stand in the ``do_after`` of another: scripts need one, each doubles what an error costs."""


def _decode_nested(raw: object) -> "tuple[Command, ...]":
    level = raw if type(raw) is list else []
    for _ in range(MAX_NESTED_SPAWNS):
        level = [inner for item in level for inner in _do_after(item)]
        if not level:
            return decode_commands(raw)
    raise WireTypeError(f"expected commands at most {MAX_NESTED_SPAWNS} deep in one another, got more")


def _do_after(item: Any) -> list[Any]:  # noqa: ANN401 - whatever msgpack found
    """Return what should follow a command, where it is a SpawnActor; nothing of what is no command at all."""
    try:
        (((index, (*_, inner)),),) = (item,)
    except (TypeError, ValueError):
        return []
    return inner if type(index) is int and index == 0 and type(inner) is list else []


class SpawnActor(NamedTuple):
    """Spawn; where there is no parent, ``attachment`` is uninitialised memory of the client and means nothing."""

    description: ActorDescription
    transform: Transform
    parent_id: U32 | None
    attachment: U8
    socket: str
    do_after: "Annotated[tuple[Command, ...], DecodedBy(_decode_nested)]"


class DestroyActor(NamedTuple):
    """Take an actor out of the world."""

    actor_id: U32


class ApplyVehicleControl(NamedTuple):
    """Feet and hands of a driver, held until replaced."""

    actor_id: U32
    control: ClientControl


class ApplyVehicleAckermannControl(NamedTuple):
    """A target motion, held until replaced."""

    actor_id: U32
    control: AckermannControl


class ApplyWalkerControl(NamedTuple):
    """Where a walker goes."""

    actor_id: U32
    control: WalkerControl


class ApplyVehiclePhysicsControl(NamedTuple):
    """A vehicle's engine, gears and wheels."""

    actor_id: U32
    physics_control: VehiclePhysicsControl


class ApplyTransform(NamedTuple):
    """Put an actor somewhere; relative to its parent where it has one."""

    actor_id: U32
    transform: Transform


class ApplyWalkerState(NamedTuple):
    """Put a walker onto its navigation mesh: z is that of the surface; speed in m/s."""

    actor_id: U32
    transform: Transform
    speed_mps: float


class ApplyTargetVelocity(NamedTuple):
    """m/s in the world."""

    actor_id: U32
    velocity: Vector3D


class ApplyTargetAngularVelocity(NamedTuple):
    """Degrees/s in the world."""

    actor_id: U32
    angular_velocity: Vector3D


class ApplyImpulse(NamedTuple):
    """N·s in the world."""

    actor_id: U32
    impulse: Vector3D


class ApplyForce(NamedTuple):
    """N in the world."""

    actor_id: U32
    force: Vector3D


class ApplyAngularImpulse(NamedTuple):
    """N·m·s in the world."""

    actor_id: U32
    impulse: Vector3D


class ApplyTorque(NamedTuple):
    """N·m in the world."""

    actor_id: U32
    torque: Vector3D


class SetSimulatePhysics(NamedTuple):
    """Whether forces move the actor."""

    actor_id: U32
    enabled: bool


class SetEnableGravity(NamedTuple):
    """Whether the actor falls."""

    actor_id: U32
    enabled: bool


class SetAutopilot(NamedTuple):
    """A flag only; the Traffic Manager that drives lives in the client."""

    actor_id: U32
    enabled: bool


class ShowDebugTelemetry(NamedTuple):
    """Whether the server's screen shows the vehicle's telemetry."""

    actor_id: U32
    enabled: bool


class SetVehicleLightState(NamedTuple):
    """Bits of VehicleLightState."""

    actor_id: U32
    light_state: U32


class ApplyLocation(NamedTuple):
    """Put an actor somewhere and keep its rotation."""

    actor_id: U32
    location: Vector3D


class ConsoleCommand(NamedTuple):
    """A command for Unreal's console."""

    command: str


class SetTrafficLightState(NamedTuple):
    """A TrafficLightState by number."""

    actor_id: U32
    state: U8


Command: TypeAlias = (
    SpawnActor
    | DestroyActor
    | ApplyVehicleControl
    | ApplyVehicleAckermannControl
    | ApplyWalkerControl
    | ApplyVehiclePhysicsControl
    | ApplyTransform
    | ApplyWalkerState
    | ApplyTargetVelocity
    | ApplyTargetAngularVelocity
    | ApplyImpulse
    | ApplyForce
    | ApplyAngularImpulse
    | ApplyTorque
    | SetSimulatePhysics
    | SetEnableGravity
    | SetAutopilot
    | ShowDebugTelemetry
    | SetVehicleLightState
    | ApplyLocation
    | ConsoleCommand
    | SetTrafficLightState
)
COMMANDS: tuple[type[Command], ...] = Command.__args__
"""The commands in the order of their index on the wire."""


def decode_commands(raw: object, *, before: int = 0) -> tuple[Command, ...]:
    """Return commands one by one; as many as ``before`` come before them in their batch.

    Raises:
        WireTypeError: the first that does not fit, with its place in the batch.
    """
    if type(raw) is not list:
        raise WireTypeError(f"expected an array of commands, got {got(raw)}")
    commands: list[Command] = []
    try:
        for item in raw:
            commands.append(_decode_command(item))  # noqa: PERF401 - the length says which failed
    except WireTypeError as error:
        raise error.inside(f"[{before + len(commands)}]") from None
    return tuple(commands)


def decode_batch(raw: object) -> "tuple[Command | Controls | Transforms, ...]":
    """Return the commands of a batch; many controls or transforms in a row are one of its members.

    Raises:
        WireTypeError: the first that does not fit, with its place in the batch.
    """
    if type(raw) is Controls:  # read by linden.protocol.wire.packed
        return (raw,)
    if type(raw) is not list:
        return decode_commands(raw)
    members: list[Command | Controls | Transforms] = []
    before = 0
    for index, stretch in groupby(raw, _index):
        items = list(stretch)
        plain = _PLAIN.get(index) if len(items) >= WORTH_COLUMNS else None
        columns = plain(items) if plain else None
        members += [columns] if columns else decode_commands(items, before=before)
        before += len(items)
    return tuple(members)


def _index(item: Any) -> int | None:  # noqa: ANN401 - whatever msgpack found
    """Return the index of a command, None where it is none."""
    try:
        index = item[0][0]
    except (TypeError, LookupError):
        return None
    return index if type(index) is int else None


def _decode_command(item: Any) -> Command:  # noqa: ANN401 - whatever msgpack found
    if type(item) is not list or len(item) != 1 or type(item[0]) is not list or len(item[0]) != 2:
        raise WireTypeError(f"expected a command [[index, body]], got {got(item)}")
    index, body = item[0]
    if type(index) is not int or not 0 <= index < len(COMMANDS):
        raise WireTypeError(f"expected the index of a command, 0 to {len(COMMANDS) - 1}, got {got(index)}")
    try:
        return cast("Command", _DECODERS[index](body))
    except WireTypeError as error:
        raise error.inside(f" ({COMMANDS[index].__name__})") from None


_PLAIN: dict[int | None, Callable[[list[Any]], Controls | Transforms | None]] = {
    COMMANDS.index(ApplyVehicleControl): plain_controls,
    COMMANDS.index(ApplyTransform): plain_transforms,
}
"""Commands, by index, of which many in a row are read column by column."""
_DECODERS: tuple[Decoder, ...] = tuple(struct_decoder(command) for command in COMMANDS)


def done(actor_id: int) -> tuple[Any, ...]:
    """Return one command's answer in that of ``apply_batch``: it was carried out on this actor."""
    return ((1, actor_id),)


def failed(message: str) -> tuple[Any, ...]:
    """Return one command's answer in that of ``apply_batch``: it was refused."""
    return ((0, (message,)),)


Batch = Annotated[tuple[Command | Controls | Transforms, ...], DecodedBy(decode_batch)]
"""The annotation of a handler's argument that is a batch."""
