"""Packets that no client means: noise, requests cut off or changed, and right types with values that make no sense."""

import random
from collections.abc import Callable, Iterator
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgpack

from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.protocol.wire.commands import COMMANDS, Batch, DestroyActor
from linden.protocol.wire.decode import IntRange
from linden.server.rpc import registry

WITH_A_RIGHT_TO_CHANGE_THE_SESSION = {
    "load_new_episode",
    "copy_opendrive_to_file",
    "set_episode_settings",
    "destroy_actor",
}
"""Left out, with the command DestroyActor: what they do to another client is what they are for."""
WHOLE_REQUESTS_A_CONNECTION = 20
DEEPEST = 4  # arrays within arrays

Chance = random.Random

ODDITIES: list[Any] = [
    *(None, True, False),
    *(0, 1, -1, 24, 200, 2**31, 2**32 - 1, 2**64 - 1, -(2**63)),
    *(0.0, 1.5, -1e30, 1e308, float("nan"), float("inf"), -float("inf")),
    *("", "hero", "vehicle.easymile.ez10", "x" * 300, "\udcff", "Frame"),
    *(b"", b"\0\1\2", bytes(24)),
    [0.0, 0.0, 0.0],
    [[1.0, 2.0, 3.0], [0.0, 90.0, 0.0]],
]
EXTREMES: dict[Any, list[Any]] = {
    float: [0.0, 1.0, -1.0, 0.05, 90.0, 1e3, -1e6, 1e30, -3.4e38, 1e308],
    bool: [True, False],
    str: ["", "0", "1e400", "nan", "true", "vehicle.easymile.ez10", "walker.pedestrian.0001", "sensor.other.imu"],
    bytes: [b"", bytes(24)],
    int: [0, 1, -1, 4, 2**31 - 1, 2**32 - 1, -(2**31)],
}


def connections(seed: int, count: int) -> Iterator[list[bytes]]:
    """``count`` packets or a few more, by connection: one that may break it, or several that are whole."""
    registry.load_handlers()
    chance = random.Random(seed)
    breaking: tuple[Callable[[Chance], bytes], ...] = (noise, cut_off, changed)
    for _ in range(0, count, 5 * WHOLE_REQUESTS_A_CONNECTION):
        for kind in (of_any_type, of_the_right_types):
            yield [kind(chance) for _ in range(WHOLE_REQUESTS_A_CONNECTION)]
        for _ in range(WHOLE_REQUESTS_A_CONNECTION):
            for kind in breaking:
                yield [kind(chance)]


def noise(chance: Chance) -> bytes:
    return chance.randbytes(chance.randrange(1, 200))


def cut_off(chance: Chance) -> bytes:
    whole = of_any_type(chance)
    return whole[: chance.randrange(1, len(whole))]


def changed(chance: Chance) -> bytes:
    whole = bytearray(of_any_type(chance))
    start = whole.find(b"\x91")  # behind the name: a changed name is only a function that does not exist
    for _ in range(chance.randrange(1, 6)):
        whole[chance.randrange(start, len(whole))] = chance.randrange(256)
    return bytes(whole)


def of_any_type(chance: Chance) -> bytes:
    methods = sorted(CARLA_FUNCTIONS.keys() - WITH_A_RIGHT_TO_CHANGE_THE_SESSION)
    return request(chance, chance.choice(methods), [oddity(chance) for _ in range(chance.randrange(5))])


def of_the_right_types(chance: Chance) -> bytes:
    methods = sorted(registry.METHODS.keys() - WITH_A_RIGHT_TO_CHANGE_THE_SESSION)
    found = registry.METHODS[chance.choice(methods)]
    hints = get_type_hints(found.handler, include_extras=True)
    names = list(hints)[1:-1]  # without the context and the result
    return request(chance, found.name, [extreme(chance, hints[name]) for name in names])


def request(chance: Chance, method: str, arguments: list[Any]) -> bytes:
    message = [0, chance.randrange(2**32), method, [[chance.random() < 0.5], *arguments]]
    packed: bytes = msgpack.packb(message, unicode_errors="surrogateescape")
    return packed


def oddity(chance: Chance, depth: int = 0) -> Any:
    if depth < DEEPEST and chance.random() < 0.2:
        return [oddity(chance, depth + 1) for _ in range(chance.randrange(6))]
    return chance.choice(ODDITIES)


def extreme(chance: Chance, annotation: Any) -> Any:
    """A value of the right type, as msgpack carries it."""
    if annotation == Batch:
        return [command(chance) for _ in range(chance.randrange(4))]
    if get_origin(annotation) is Annotated:
        return extreme_integer(chance, annotation)
    if hasattr(annotation, "_fields"):
        return body(chance, annotation)
    if get_args(annotation):
        return extreme_composite(chance, get_origin(annotation), get_args(annotation))
    if annotation is object:
        return oddity(chance)
    return chance.choice(EXTREMES.get(annotation) or [member.value for member in annotation])


def extreme_integer(chance: Chance, annotation: Any) -> Any:
    base, *marks = get_args(annotation)
    limits = next((mark for mark in marks if isinstance(mark, IntRange)), None)
    if limits is None:
        return extreme(chance, base)
    likely_an_actor = min(limits.high, chance.randrange(400))
    return chance.choice([limits.low, limits.high, likely_an_actor, likely_an_actor, likely_an_actor])


def extreme_composite(chance: Chance, origin: Any, inner: tuple[Any, ...]) -> list[Any]:
    if origin is tuple and Ellipsis not in inner:
        return [extreme(chance, each) for each in inner]
    if origin in (tuple, list):
        return [extreme(chance, inner[0]) for _ in range(chance.randrange(4))]
    if type(None) in inner:
        return [False] if chance.random() < 0.5 else [True, extreme(chance, inner[0])]
    index = chance.randrange(len(inner))
    return [index, extreme(chance, inner[index])]


def body(chance: Chance, struct: Any) -> list[Any]:
    hints = get_type_hints(struct, include_extras=True)
    return [extreme(chance, hints[name]) for name in struct._fields]


def command(chance: Chance) -> list[Any]:
    index = chance.randrange(1 + COMMANDS.index(DestroyActor), len(COMMANDS))
    return [[index, body(chance, COMMANDS[index])]]
