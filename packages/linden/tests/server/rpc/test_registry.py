"""Claims about the registry: what is registered is CARLA's, and every annotation has a way over the wire."""

import pytest

from fakes.simulation import FakeFrames, FakeMaps, FakeSimulation
from linden.protocol.wire.client_functions import CARLA_FUNCTIONS
from linden.protocol.wire.rpc import Call, Reply
from linden.protocol.wire.stream import StreamTable
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.server.rpc.registry import METHODS, dispatch, method


def new_context() -> Context:
    return Context(
        world=FakeSimulation(),
        maps=FakeMaps(),
        frames=FakeFrames(),
        streams=StreamTable(2001),
        variable_step_s=lambda: 0.04,
    )


def test_every_function_wraps_its_result_as_carla_does() -> None:
    registry.load_handlers()
    wrong = {name: found.reply for name, found in METHODS.items() if found.reply is not CARLA_FUNCTIONS[name]}
    assert not wrong


def test_a_function_that_carla_does_not_have_cannot_be_registered() -> None:
    with pytest.raises(ValueError, match="no function of CARLA's"):
        method("make_coffee")(lambda context: None)


def test_a_function_cannot_be_registered_twice() -> None:
    registry.load_handlers()
    with pytest.raises(ValueError, match="registered twice"):
        method("version")(lambda context: None)


def test_a_refused_asynchronous_call_is_logged_once(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(METHODS, "enable_carsim", raising=False)
    context = new_context()
    for number in range(3):
        dispatch(context, Call(number, "enable_carsim", [1, "x"], is_async=True))
    assert caplog.text.count("linden has no method 'enable_carsim'") == 1


def test_only_what_makes_frames_waits_for_slow_subscribers() -> None:
    registry.load_handlers()
    assert {name for name, found in METHODS.items() if found.advances} == {"tick_cue", "apply_batch"}


def test_the_vocabulary_has_all_of_the_client(request: pytest.FixtureRequest) -> None:
    assert len(CARLA_FUNCTIONS) == 129
    assert [name for name, reply in CARLA_FUNCTIONS.items() if reply is Reply.BARE] == ["apply_batch"]
