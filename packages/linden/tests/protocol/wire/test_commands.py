"""Claims about batches, the first of them against the official client's own commands."""

from typing import Any

import msgpack
import pytest

from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire import commands
from linden.protocol.wire.commands import COMMANDS, MAX_NESTED_SPAWNS, SpawnActor, decode_commands
from linden.protocol.wire.decode import WireTypeError

CONTROL = [0.5, -0.25, 0.0, False, True, False, 3]


def command(index: int, body: list[Any]) -> list[Any]:
    return [[index, body]]


def test_the_order_is_that_of_the_variant() -> None:
    names = [each.__name__ for each in COMMANDS]
    assert len(names) == 22
    assert names[2] == "ApplyVehicleControl"
    assert names[18:] == ["SetVehicleLightState", "ApplyLocation", "ConsoleCommand", "SetTrafficLightState"]


def test_a_batch_keeps_its_order() -> None:
    batch = [command(2, [7, CONTROL]), command(1, [9]), command(14, [7, False]), command(2, [8, CONTROL])]
    assert decode_commands(batch) == (
        commands.ApplyVehicleControl(7, VehicleControl(*CONTROL)),
        commands.DestroyActor(9),
        commands.SetSimulatePhysics(7, enabled=False),
        commands.ApplyVehicleControl(8, VehicleControl(*CONTROL)),
    )


def test_a_spawn_carries_what_is_done_after_it() -> None:
    description = [5, "vehicle.easymile.ez10", [["role_name", 4, "hero"]]]
    pose = [[1.0, 2.0, 3.0], [0.0, 90.0, 0.0]]
    spawn = command(0, [description, pose, [False], 208, "", [command(16, [0, True]), command(2, [0, CONTROL])]])
    (decoded,) = decode_commands([spawn])
    assert decoded == commands.SpawnActor(
        ActorDescription(5, "vehicle.easymile.ez10", (AttributeValue("role_name", 4, "hero"),)),
        Transform(Vector3D(1.0, 2.0, 3.0), Rotation(0.0, 90.0, 0.0)),
        None,
        208,
        "",
        (
            commands.SetAutopilot(commands.JUST_SPAWNED, enabled=True),
            commands.ApplyVehicleControl(commands.JUST_SPAWNED, VehicleControl(*CONTROL)),
        ),
    )


@pytest.mark.parametrize(
    ("batch", "sentence"),
    [
        ("go", "expected an array of commands, got str 'go'"),
        ([command(1, [9]), "ab"], "[1]: expected a command [[index, body]], got str 'ab'"),
        ([[[1, [9]], 3]], "[0]: expected a command [[index, body]], got an array of 2"),
        ([command(22, [9])], "[0]: expected the index of a command, 0 to 21, got int 22"),
        ([command(-1, [9])], "[0]: expected the index of a command, 0 to 21, got int -1"),
        ([[[True, [9]]]], "[0]: expected the index of a command, 0 to 21, got bool True"),
        ([command(1, [9]), command(1, ["x"])], "[1] (DestroyActor).actor_id: expected an integer, got str 'x'"),
        (
            [command(2, [9, ["full", *CONTROL[1:]]])],
            "[0] (ApplyVehicleControl).control.throttle: expected a number, got str",
        ),
    ],
)
def test_a_command_that_does_not_fit_is_named_with_its_place(batch: Any, sentence: str) -> None:
    with pytest.raises(WireTypeError) as caught:
        decode_commands(batch)
    assert str(caught.value).startswith(sentence)


def test_answers_have_the_wrapping_of_a_value() -> None:
    answers = [commands.done(7), commands.failed("no")]
    assert msgpack.unpackb(msgpack.packb(answers)) == [[[1, 7]], [[0, ["no"]]]]


@pytest.mark.parametrize(
    "command",
    [
        [[2, [7, [0.5, 0.1, 0.0, False, False, False, 0]]]],
        [[2, [7, [0.5, 0.1, 0, False, False, False, 0]]]],  # an integer where a number is meant
        [[2, [7, [0.5]]]],  # the rest keeps its defaults
    ],
)
def test_the_short_way_of_a_control_decodes_what_the_long_way_does(command: list) -> None:
    assert decode_commands([command]) == (commands._decode_command(command),)


@pytest.mark.parametrize(
    "broken",
    [
        [[2, [7, [True, 0.1, 0.0, False, False, False, 0]]]],
        [[2, [-1, [0.5, 0.1, 0.0, False, False, False, 0]]]],
        [[2, [7, [1e300, 0.1, 0.0, False, False, False, 0]]]],
        [[2, [7, [0.5, 0.1, 0.0, False, False, False, 2**40]]]],
        [[2, [7, "throttle"]]],
        "no command",
        None,
    ],
)
def test_the_short_way_lets_nothing_through_that_the_long_way_refuses(broken: object) -> None:
    with pytest.raises(WireTypeError):
        decode_commands([broken])


def nested_spawns(depth: int) -> list[Any]:
    description, pose = [0, "walker.pedestrian.0001", []], [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    command: list[Any] = [[0, [description, pose, [False], 0, "", []]]]
    for _ in range(depth):
        command = [[0, [description, pose, [False], 0, "", [command]]]]
    return [command]


def test_spawns_stand_in_one_another_to_the_needed_depth() -> None:
    (outer,) = decode_commands(nested_spawns(MAX_NESTED_SPAWNS))
    assert isinstance(outer, SpawnActor)
    assert isinstance(outer.do_after[0], SpawnActor)


def test_spawns_nested_without_end_are_refused_by_a_sentence() -> None:
    for depth in (MAX_NESTED_SPAWNS + 1, 200):
        with pytest.raises(WireTypeError, match="expected commands at most 4 deep in one another"):
            decode_commands(nested_spawns(depth))
