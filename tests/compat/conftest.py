"""A live server for each process of tests, and the official client, which none of us wrote, as the judge."""

import gc
from collections.abc import Iterator
from contextlib import ExitStack

import carla
import pytest

from fakes.raw_client import RawClient
from servers import RunningServer, running_server

TIMEOUT_S = 20.0
QUIET = [True, False, [True, 0.05], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
"""Settings of a world in which nothing happens unasked."""

leaving = ExitStack()
"""The server of a session that is done; pytest holds the last test's clients until then."""


def pytest_sessionfinish() -> None:
    """End the server after its clients: one that loses its server while it ends may end our process."""
    gc.collect()
    leaving.close()


@pytest.fixture(scope="session")
def server() -> Iterator[RunningServer]:
    """A server that the tests of a process share; each of them begins an episode of its own."""
    running = leaving.enter_context(running_server("--log-level", "info"))
    yield running
    assert running.process.poll() is None, f"the server ended by itself: {running.log()}"


@pytest.fixture
def client(server: RunningServer) -> carla.Client:
    """A client of a fresh episode: asynchronous mode, default settings, nobody spawned.

    The episode is begun before the client comes, and the client of the test before has gone by then, in a world that
    stands still: the official one drops its stream when an episode ends, and on a busy machine one time in a hundred
    that ends its process, which is this one (soak.py counts it).
    """
    with RawClient(server.port) as raw:
        raw.call("set_episode_settings", QUIET)
        gc.collect()
        raw.call("load_new_episode", "Linden", True, 0xFFFF)
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(TIMEOUT_S)
    return client


@pytest.fixture
def world(client: carla.Client) -> carla.World:
    """The world of ``client``, in synchronous mode with steps of 0.05 s."""
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode = True
    settings.fixed_delta_seconds = 0.05
    world.apply_settings(settings)
    return world
