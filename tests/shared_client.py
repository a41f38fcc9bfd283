"""One client for all of a process's commands at one server, because a client reads the map anew.

In production each command connects anew. A client's first request for Linden's map takes 0.3 s of processor time, and
so does its first lane-invasion sensor: most of a short drive. In tests the next command has the client of the one
before, which is as if both were one command. Where another client has begun an episode since, it gets a new one.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import carla
import pytest

from basu import simulator
from fakes.raw_client import RawClient

Connect = Callable[[str, int, float], carla.Client]
BEGIN_EPISODES = ("generate_opendrive_world", "load_world", "reload_world")


class SharedClient:
    """Connects to one port by one client, and to every other port as the benchmark does."""

    def __init__(self, port: int, connect: Connect) -> None:
        """``connect`` makes new clients."""
        self._port, self._new = port, connect
        self._kept: carla.Client | None = None
        self._episode = 0

    def connect(self, host: str, port: int, timeout_s: float) -> carla.Client:
        """Return a client that has been answered."""
        if port != self._port:
            return self._new(host, port, timeout_s)
        episode = episode_of(port)
        if self._kept is None or self._episode != episode:
            self._kept, self._episode = self._new(host, port, timeout_s), episode
            for name in BEGIN_EPISODES:
                setattr(self._kept, name, self._noted(getattr(self._kept, name)))
        self._kept.set_timeout(timeout_s)
        return self._kept

    def _noted(self, begin: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function of the client that notes the episode which it has begun."""

        def noting(*arguments: Any, **options: Any) -> Any:
            world = begin(*arguments, **options)
            self._episode = episode_of(self._port)
            return world

        return noting


def episode_of(port: int) -> int:
    """Return the number of the episode that a server is in."""
    with RawClient(port) as raw:
        return int(raw.call("get_episode_info")[0])


@contextmanager
def shared_client(port: int) -> Iterator[None]:
    """Have the benchmark in this process share one client for the server at a port."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator, "connect", SharedClient(port, simulator.connect).connect)
        yield
