"""A live server for each module, and the official client, which none of us wrote, as the judge."""

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

leaving: list[ExitStack] = []
"""Servers of modules that are done; pytest holds their last test's clients until the next test begins."""


def see_off() -> None:
    """End servers that are left, after their clients: one that loses its server while it ends may end our process."""
    gc.collect()
    while leaving:
        leaving.pop().close()


def pytest_sessionfinish() -> None:
    see_off()


@pytest.fixture(scope="module")
def server() -> Iterator[RunningServer]:
    """A server that the tests of a module share; each of them begins an episode of its own."""
    see_off()
    stack = ExitStack()
    running = stack.enter_context(running_server("--log-level", "info"))
    leaving.append(stack)
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
