"""Windows for tests: a world on a small map, and pages of a process without a world."""

import importlib.util
import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from linden.maps.library import MapLibrary
from linden.world import World
from opendrive_texts import SIGNS_AND_LIGHTS

if importlib.util.find_spec("websockets") is None:
    pytest.skip("the window needs websockets, which `scripts/setup dev` installs", allow_module_level=True)

from linden_window.link import PageLink


@pytest.fixture
def world() -> World:
    """A world on a street with a junction, lights and signs."""
    return World(MapLibrary().from_opendrive(SIGNS_AND_LIGHTS))


@pytest.fixture
def link() -> Iterator[PageLink]:
    """The process of the pages, with no world behind it."""
    with started() as made:
        yield made


@contextmanager
def started(*options: str) -> Iterator[PageLink]:
    made = PageLink.start(*options)
    try:
        yield made
    finally:
        made.close()


class Recorder(PageLink):
    """A link that keeps what is sent."""

    def __init__(self) -> None:
        ours, self._theirs = socket.socketpair()
        super().__init__(ours, None, "")
        self.notes: list[dict[str, object]] = []
        self.frames: list[bytes] = []
        self.panes: list[tuple[str, bytes]] = []

    def note(self, facts: dict[str, object]) -> None:
        self.notes.append(json.loads(json.dumps(facts)))

    def frame(self, packed: bytes) -> None:
        self.frames.append(packed)

    def pane(self, name: str, packed: bytes) -> None:
        self.panes.append((name, packed))

    def of(self, kind: str) -> list[dict[str, object]]:
        return [note for note in self.notes if note["type"] == kind]


@pytest.fixture
def recorder() -> Recorder:
    return Recorder()
