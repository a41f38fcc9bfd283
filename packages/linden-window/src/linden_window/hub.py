"""`Hub`: queues frames and notes for each page of a window, and keeps the last notes for new pages. Has no socket.

A page takes notes in their order. It takes the newest frame, readings and measurements only: a page that reads slowly
misses frames. If notes pile up before a page, it is closed with a sentence.
"""

import asyncio
import json
from collections import deque
from typing import Any

MOST_PAGES = 16
"""Each page costs the time to send a frame; ten people watch one world at most."""
MOST_NOTES = 2000
"""Notes that may wait for one page: a slow page gets them with its next frame."""
_KEPT = (
    "actors", "weather", "lights", "lamps", "settings", "route", "sensors", "signals", "panel", "marks",
    "record", "end",
)  # fmt: skip
"""Notes that a new page gets at once, the last of each type."""


class PageQueue:
    """Frames and notes that wait to be sent to one page."""

    def __init__(self) -> None:
        self.notes: deque[str] = deque()
        self.frame: bytes | None = None
        self.readings: str | None = None
        self.panes: dict[str, bytes] = {}
        self.dropped = 0
        self.is_overrun = False
        self.wakes = asyncio.Event()

    def note(self, text: str) -> None:
        """Append a note; a page for which too many notes wait counts as overrun."""
        self.is_overrun |= len(self.notes) >= MOST_NOTES
        if not self.is_overrun:
            self.notes.append(text)
        self.wakes.set()

    def show(self, frame: bytes) -> None:
        """Queue a frame in the place of one that was not sent in time."""
        self.dropped += self.frame is not None
        self.frame = frame
        self.wakes.set()

    def show_readings(self, text: str) -> None:
        """Queue the figures of a drive in the place of older ones."""
        self.readings = text
        self.wakes.set()

    def show_pane(self, name: str, packed: bytes) -> None:
        """Queue a sensor's measurement in the place of an older one."""
        self.panes[name] = packed
        self.wakes.set()

    def take(self) -> list[str | bytes]:
        """Return all that waits, notes first."""
        taken: list[str | bytes] = [*self.notes]
        self.notes.clear()
        if self.readings is not None:
            taken.append(self.readings)
            self.readings = None
        if self.frame is not None:
            taken.append(self.frame)
            self.frame = None
        taken += self.panes.values()
        self.panes.clear()
        self.wakes.clear()
        return taken


class Hub:
    """The pages of one window and the last note of each type."""

    def __init__(self) -> None:
        self._pages: dict[PageQueue, None] = {}
        self._last: dict[str, str] = {}
        self._scene_number: object = None

    def __len__(self) -> int:
        return len(self._pages)

    def join(self) -> PageQueue | None:
        """Return the queue of a new page with the present state in it; None if there are enough pages."""
        if len(self._pages) >= MOST_PAGES:
            return None
        queue = PageQueue()
        for kind in ("scene", *_KEPT):
            if kind in self._last:
                queue.note(self._last[kind])
        self._pages[queue] = None
        return queue

    def leave(self, queue: PageQueue) -> None:
        """Remove a page that has closed its connection."""
        self._pages.pop(queue, None)

    def note(self, facts: dict[str, Any]) -> None:
        """Send facts to all pages, and keep them for new ones if they describe the present."""
        kind = str(facts.get("type", ""))
        text = json.dumps(facts, separators=(",", ":"))
        if kind == "readings":
            for queue in self._pages:
                queue.show_readings(text)
            return
        if kind == "scene" and facts.get("number") != self._scene_number:
            self._scene_number, self._last = facts.get("number"), {}  # notes of the last world are out of date
        if kind == "scene" or kind in _KEPT:
            self._last[kind] = text
        for queue in self._pages:
            queue.note(text)

    def frame(self, packed: bytes) -> None:
        """Replace the frame that waits for each page by a newer one."""
        for queue in self._pages:
            queue.show(packed)

    def pane(self, name: str, packed: bytes) -> None:
        """Replace a sensor's measurement that waits for each page by a newer one."""
        for queue in self._pages:
            queue.show_pane(name, packed)
