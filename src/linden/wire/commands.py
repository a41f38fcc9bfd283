"""The commands of a batch as named tuples, and their decoding. Source: ``carla/rpc/Command.h``, 0.9.16.

On the wire a command is ``[[index, body]]``: a struct of one member around the variant. The order of the variant is
that of the template's name in the official client's own symbols (which has ApplyLocation before ConsoleCommand).
"""

from math import hypot
from typing import Annotated, Any, NamedTuple, TypeAlias, cast

from linden.values.actors import ActorDescription
from linden.values.space import Transform, Vector3D
from linden.values.vehicles import AckermannControl, VehicleControl, VehiclePhysicsControl
from linden.values.walkers import WalkerControl
from linden.wire.controls import ClientControl
from linden.wire.decode import U8, U32, DecodedBy, Decoder, WireTypeError, got, struct_decoder

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


def decode_commands(raw: object) -> tuple[Command, ...]:
    """Return the commands of a batch.

    Raises:
        WireTypeError: the first that does not fit, with its place in the batch.
    """
    if type(raw) is not list:
        raise WireTypeError(f"expected an array of commands, got {got(raw)}")
    commands: list[Command] = []
    try:
        for item in raw:
            commands.append(_plain_control(item) or _decode_command(item))  # noqa: PERF401 - the length says which failed
    except WireTypeError as error:
        raise error.inside(f"[{len(commands)}]") from None
    return tuple(commands)


def _plain_control(item: Any) -> ApplyVehicleControl | None:  # noqa: ANN401 - whatever msgpack found
    """Return the command that a traffic script sends for every vehicle in every tick; None where anything is unusual.

    The short way of :func:`_decode_command`: all types are the very ones the client sends, and no number is too large
    (none is larger than the root of the sum of their squares, which is NaN where one of them is).
    """
    try:
        (((index, (actor_id, control)),),) = (item,)
        fits = (
            type(index) is int
            and index == _CONTROL
            and type(actor_id) is int
            and 0 <= actor_id <= _LARGEST_ID
            and type(control) is list
            and tuple(map(type, control)) == _CONTROL_TYPES
            and hypot(*control) <= _LARGEST_PLAIN
        )
    except (TypeError, ValueError):
        return None
    return ApplyVehicleControl(actor_id, VehicleControl._make(control)) if fits else None


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


_CONTROL = COMMANDS.index(ApplyVehicleControl)
_CONTROL_TYPES = tuple(VehicleControl.__annotations__[name] for name in VehicleControl._fields)
_LARGEST_ID = 2**32 - 1
_LARGEST_PLAIN = 2**31 - 1  # pedals, wheel and gear are far below
_DECODERS: tuple[Decoder, ...] = tuple(struct_decoder(command) for command in COMMANDS)


def done(actor_id: int) -> tuple[Any, ...]:
    """Return one command's answer in that of ``apply_batch``: it was carried out on this actor."""
    return ((1, actor_id),)


def failed(message: str) -> tuple[Any, ...]:
    """Return one command's answer in that of ``apply_batch``: it was refused."""
    return ((0, (message,)),)


Batch = Annotated[tuple[Command, ...], DecodedBy(decode_commands)]
"""The annotation of a handler's argument that is a batch."""
