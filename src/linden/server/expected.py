"""Streams that a client is about to listen to: it has asked where they are, and its subscription is on the way.

The official client asks ``get_sensor_token`` in ``listen()``, subscribes from a thread of its own, and may tick before
that thread has been heard of. CARLA's frames take so long that the subscription overtakes them; here the frame waits,
so that a sensor measures from the first tick after ``listen()`` on. Knows no clock: it is told the time.
"""

from collections import Counter
from typing import NamedTuple

PATIENCE_S = 3.0
"""How long a frame waits for a client that has asked and does not come. The official client takes a millisecond,
and more than half a second where ten programs share a processor: a camera that is not waited for is never answered."""
MOST_IN_VAIN = 3
"""How often frames wait for a client that does not come; then its questions hold up nobody, until it has come once."""


class _Wait(NamedTuple):
    client: int
    until_s: float


class Expected:
    """Which streams have been asked for and not been subscribed to yet. All times in s of one steady clock."""

    def __init__(self) -> None:
        self._waits: dict[int, _Wait] = {}
        self._in_vain: Counter[int] = Counter()

    def asked(self, stream_id: int, client: int, now_s: float) -> None:
        """Note that a client wants to know where a stream is; asking again makes nobody wait longer."""
        if stream_id not in self._waits and self._in_vain[client] < MOST_IN_VAIN:
            self._waits[stream_id] = _Wait(client, now_s + PATIENCE_S)

    def came(self, stream_id: int) -> None:
        """Note that somebody has begun to listen to it."""
        wait = self._waits.pop(stream_id, None)
        if wait is not None:
            self._in_vain.pop(wait.client, None)

    def forget(self, client: int) -> None:
        """Note that a client has gone; whom it asked for need not be waited for."""
        self._in_vain.pop(client, None)
        self._waits = {stream_id: wait for stream_id, wait in self._waits.items() if wait.client != client}

    def wait_s(self, now_s: float) -> float | None:
        """Return how long the next frame waits at most; None where nobody is expected, or not any more."""
        if not self._waits:
            return None
        for stream_id, wait in tuple(self._waits.items()):
            if wait.until_s <= now_s:
                del self._waits[stream_id]
                self._in_vain[wait.client] += 1
        return max(wait.until_s for wait in self._waits.values()) - now_s if self._waits else None
