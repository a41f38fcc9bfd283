"""Streams that a client is about to listen to: it has asked where they are, and its subscription is on the way.

The official client asks ``get_sensor_token`` in ``listen()``, subscribes from a thread of its own, and may tick before
that thread has been heard of. CARLA's frames take so long that the subscription overtakes them; here the frame waits,
so that a sensor measures from the first tick after ``listen()`` on. Knows no clock: it is told the time.
"""

PATIENCE_S = 0.5
"""How long a frame waits for somebody who has asked and does not come. The official client takes a millisecond,
and some hundreds of them where ten programs share a processor."""


class Expected:
    """Which streams have been asked for and not been subscribed to yet. All times in s of one steady clock."""

    def __init__(self) -> None:
        self._until_s: dict[int, float] = {}

    def asked(self, stream_id: int, now_s: float) -> None:
        """Note that somebody wants to know where a stream is."""
        self._until_s[stream_id] = now_s + PATIENCE_S

    def came(self, stream_id: int) -> None:
        """Note that somebody has begun to listen to it."""
        self._until_s.pop(stream_id, None)

    def wait_s(self, now_s: float) -> float | None:
        """Return how long the next frame waits at most; None where nobody is expected, or not any more."""
        if not self._until_s:
            return None
        self._until_s = {stream_id: until_s for stream_id, until_s in self._until_s.items() if until_s > now_s}
        return max(self._until_s.values()) - now_s if self._until_s else None
