"""Claims about sessions of the official client that arrive damaged: bytes changed, left out, put in, cut and mixed.

A real session is overheard once, between the official client and a live server. What is then made of it goes through
the wire and the handlers to a simulation in this process, so that thousands of damaged sessions take seconds.
"""

import logging
import random
import subprocess
import sys
from pathlib import Path

import msgpack
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fakes.eavesdropper import eavesdropping
from linden.errors import ProtocolError
from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.wire.rpc import RpcConnection
from linden.protocol.wire.stream import StreamTable
from linden.server import frames
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.world import World
from servers import RunningServer

SESSION = str(Path(__file__).parents[1] / "fakes" / "session.py")
EXAMPLES = 200
LONGEST_MESSAGE = 20_000
"""Longer ones are texts of maps and the like, of which nearly every byte is as good as any other."""


@pytest.fixture(scope="module")
def overheard(server: RunningServer) -> list[bytes]:
    with eavesdropping(server.port) as between:
        subprocess.run([sys.executable, SESSION, str(between.port)], check=True, timeout=100)
    messages = [message for message in between.messages() if len(message) < LONGEST_MESSAGE]
    methods = {msgpack.unpackb(message, unicode_errors="surrogateescape")[2] for message in messages}
    assert {"spawn_actor", "apply_batch", "tick_cue", "set_episode_settings", "apply_physics_control"} <= methods
    return messages


@pytest.fixture(scope="module")
def context() -> Context:
    registry.load_handlers()
    maps = MapLibrary((), MapCache.of_user().read)
    return Context(
        world=World(maps.load(HOME_MAP), EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)),
        maps=maps,
        frames=frames,
        streams=StreamTable(2001),
        variable_step_s=lambda: 0.05,
    )


def damaged(chance: random.Random, messages: list[bytes]) -> bytes:
    """Some messages of the session in their order, of which some have come to harm."""
    kept = [message for message in messages if chance.random() < 0.5]
    return b"".join(
        hurt(chance, bytearray(message), messages) if chance.random() < 0.3 else message for message in kept
    )


def hurt(chance: random.Random, message: bytearray, others: list[bytes]) -> bytes:
    at = chance.randrange(len(message))
    kind = chance.randrange(6)
    if kind == 0:
        return bytes(message[:at])
    if kind == 1:
        del message[at : at + chance.randrange(1, 9)]
    elif kind == 2:
        message[at:at] = chance.randbytes(chance.randrange(1, 9))
    elif kind == 3:
        return bytes(message[:at]) + chance.choice(others)[at:]
    elif kind == 4:
        message[at] = chance.choice((0x00, 0x7F, 0x80, 0x90, 0xC0, 0xC2, 0xC3, 0xCB, 0xCF, 0xD3, 0xDD, 0xFF))
    else:
        for _ in range(chance.randrange(1, 12)):
            message[chance.randrange(len(message))] = chance.randrange(256)
    return bytes(message)


@pytest.mark.slow
@pytest.mark.usefixtures("overheard", "context")
@settings(
    max_examples=EXAMPLES, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=st.integers(0, 2**32))
def test_a_damaged_session_is_answered_refused_or_broken_off_and_time_goes_on(
    seed: int, overheard: list[bytes], context: Context, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.clear()
    caplog.set_level(logging.WARNING, "linden")
    chance = random.Random(seed)
    connection, said, at = RpcConnection(), damaged(chance, overheard), 0
    try:
        while at < len(said):
            step = chance.randrange(1, 2000)
            for call in connection.receive(said[at : at + step]):
                assert registry.dispatch(context, call)
            at += step
    except ProtocolError:
        pass
    frame = context.world.frame
    assert context.advance() == frame + 1
    context.outbox.clear()
    actors = context.world.episode.actors
    shown = actors.rows[: len(actors)]
    assert all(np.isfinite(shown[name]).all() for name in ("location", "rotation", "velocity"))
    assert "internal error" not in caplog.text
