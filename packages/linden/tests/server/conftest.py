"""A live server that the tests of this folder share; each begins an episode and has clients of its own."""

from collections.abc import Iterator

import pytest

from fakes.raw_client import RawClient
from servers import RunningServer, running_server

LAST_PORT = pytest.StashKey[int]()


@pytest.fixture(scope="session")
def shared_server() -> Iterator[RunningServer]:
    with running_server() as running:
        yield running
        assert running.process.poll() is None, f"the server ended by itself: {running.log()}"


@pytest.fixture
def server(shared_server: RunningServer) -> RunningServer:
    """The server in a fresh episode, with the settings of a server that has just started."""
    with RawClient(shared_server.port) as raw:
        raw.call("load_new_episode", "Linden", True, 0xFFFF)
    return shared_server


@pytest.fixture
def manager_port(request: pytest.FixtureRequest) -> int:
    """A port for a Traffic Manager that no test before has registered."""
    stash = request.config.stash
    stash[LAST_PORT] = stash.get(LAST_PORT, 8000) + 1
    return stash[LAST_PORT]
