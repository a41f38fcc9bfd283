"""`Subscribers`: registry of streams with limits for slow peers; `Expected`: a stream's token asked for, not yet used.

In asynchronous mode a slow subscriber misses whole messages: only the newest one waits for it. In synchronous mode
every message is sent. Up to :data:`QUEUED_BYTES` wait for each subscriber, and up to :data:`QUEUED_BYTES_OF_ALL` for
all together. A subscriber with more is congested. No frame is made while a subscriber is congested, and after
:data:`PATIENCE_S` its connection is closed.

A subscription is expected from a client's request for a stream's token until that client subscribes. The official
client calls ``get_sensor_token`` in ``listen()``, subscribes in a thread of its own, and may tick before that thread
has connected. CARLA's frames take so long that the subscription comes first. Here the frame waits, so that a sensor
measures from the first tick after ``listen()`` on. The caller passes the time.
"""

import logging
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

from linden.protocol.wire.stream import WORLD_OBSERVER_ID, StreamTable
from linden.server.peers import StreamPeer

log = logging.getLogger("linden")

QUEUED_BYTES = 32 * 1024 * 1024
"""What may wait for one subscriber: a second of 800 x 600 pictures at 20 Hz, or an hour of snapshots of one car."""
QUEUED_BYTES_OF_ALL = 256 * 1024 * 1024
"""What may wait for all subscribers together; shared evenly among the slow ones, if they are more than eight."""
PATIENCE_S = 4.0
"""How long a congested subscriber holds up the frames: less than the 5 s after which other clients give up a call."""


class Subscribers:
    """The stream connections of a server that have said what they listen to."""

    def __init__(
        self, table: StreamTable, watch: Callable[[StreamPeer], None], close: Callable[[StreamPeer], None]
    ) -> None:
        """``watch`` is called with a peer that has bytes to send, ``close`` with one to close."""
        self._table = table
        self._watch = watch
        self._close = close
        self._by_stream: dict[int, dict[StreamPeer, None]] = {}
        self._behind: dict[StreamPeer, None] = {}

    def add(self, peer: StreamPeer, stream_id: int) -> None:
        """Begin to send a stream to a peer."""
        self._by_stream.setdefault(stream_id, {})[peer] = None
        self._table.subscribe(stream_id)

    def remove(self, peer: StreamPeer) -> None:
        """Forget a peer, whether or not it ever subscribed."""
        self._behind.pop(peer, None)
        stream_id = peer.subscription.stream_id
        if stream_id is None or peer not in self._by_stream.get(stream_id, {}):
            return
        del self._by_stream[stream_id][peer]
        if not self._by_stream[stream_id]:
            del self._by_stream[stream_id]
        self._table.unsubscribe(stream_id)
        if peer.dropped:
            log.info("%s has missed %d messages in all", peer, peer.dropped)

    def count(self, stream_id: int) -> int:
        """Return how many peers listen to a stream."""
        return len(self._by_stream.get(stream_id, ()))

    def publish(self, stream_id: int, payload: bytes, now_s: float, *, may_drop: bool) -> None:
        """Send one message to all subscribers of a stream; broken connections are closed."""
        for peer in tuple(self._by_stream.get(stream_id, ())):
            self.send(peer, payload, now_s, may_drop=may_drop)

    def send(self, peer: StreamPeer, payload: bytes, now_s: float, *, may_drop: bool) -> None:
        """Send one message to one peer, as its gate shows it; closes it where its connection is broken."""
        if peer.gate is not None and peer.gate.filters and peer.subscription.stream_id == WORLD_OBSERVER_ID:
            shown = peer.gate.shown(payload)
            peer.held = payload if shown is None else None
            if shown is None:
                return
            payload = shown
        missed = peer.dropped
        try:
            (peer.offer if may_drop else peer.publish)(payload)
        except OSError as error:
            log.info("%s is gone: %s", peer, error)
            self._close(peer)
            return
        if missed == 0 < peer.dropped:
            log.info("%s reads more slowly than frames are made; it misses some (asynchronous mode)", peer)
        if peer.outgoing.waiting_bytes:
            self._watch(peer)
        if may_drop:
            peer.congested_since_s = None
        elif peer.outgoing.waiting_bytes:
            self._behind[peer] = None
            self._weigh(peer, now_s)

    def patience_s(self, now_s: float) -> float | None:
        """Return how long frames will wait for the congested, None where they need not wait."""
        congested = self.congested(now_s)
        if not congested:
            return None
        return max(0.0, min(peer.congested_since_s or 0.0 for peer in congested) + PATIENCE_S - now_s)

    def congested(self, now_s: float) -> list[StreamPeer]:
        """Return the subscribers that frames wait for, and close subscribers that have run out of time."""
        for peer in tuple(self._behind):
            self._weigh(peer, now_s)
        for peer in self._overdue(now_s):
            log.warning(
                "%s is closed: in synchronous mode it held up the frames for %.0f s with %d bytes unread",
                peer,
                now_s - (peer.congested_since_s or now_s - PATIENCE_S),
                peer.outgoing.waiting_bytes,
            )
            self._close(peer)
        return [peer for peer in self._behind if peer.congested_since_s is not None]

    def _overdue(self, now_s: float) -> list[StreamPeer]:
        """Return the subscribers to close, all at once: no frame was made meanwhile, so all had the same time to read.

        The share of the others grows with each that is closed. So those near it would become congested later, one
        after the other, with as much patience each.
        """
        since_s = min(
            (peer.congested_since_s for peer in self._behind if peer.congested_since_s is not None), default=None
        )
        if since_s is None or now_s - since_s < PATIENCE_S:
            return []
        return [peer for peer in self._behind if peer.outgoing.waiting_bytes > 0.5 * self._share_bytes()]

    def _share_bytes(self) -> int:
        """Return how much may wait for each of the slow subscribers."""
        return min(QUEUED_BYTES, QUEUED_BYTES_OF_ALL // len(self._behind))

    def _weigh(self, peer: StreamPeer, now_s: float) -> None:
        """Note whether more waits for a peer than its share, and since when."""
        waiting = peer.outgoing.waiting_bytes
        if waiting > self._share_bytes():
            if peer.congested_since_s is None:
                peer.congested_since_s = now_s
            return
        peer.congested_since_s = None
        if not waiting:
            del self._behind[peer]


SUBSCRIPTION_WAIT_S = 1.0
"""How long a frame waits for an expected subscriber. The official client takes a millisecond, and more than half a
second where ten programs share a processor. A camera without its subscriber in time never answers."""
MOST_IN_VAIN = 3
"""How often frames wait in vain for a client; then its requests delay no frame until it has subscribed once."""


class _Wait(NamedTuple):
    stream_id: int
    client: int


class Expected:
    """Streams with a requested token and no subscription yet. All times in s of one steady clock.

    Each client that requested a stream's token is expected to subscribe. A subscription does not name its client, so
    it ends the earliest wait for its stream.
    """

    def __init__(self) -> None:
        self._until_s: dict[_Wait, float] = {}
        self._in_vain: Counter[int] = Counter()

    def asked(self, stream_id: int, client: int, now_s: float) -> None:
        """Note that a client wants to know where a stream is; a second request does not extend the wait."""
        if self._in_vain[client] < MOST_IN_VAIN:
            self._until_s.setdefault(_Wait(stream_id, client), now_s + SUBSCRIPTION_WAIT_S)

    def came(self, stream_id: int) -> None:
        """Note that a client has subscribed to it."""
        wait = next((each for each in self._until_s if each.stream_id == stream_id), None)
        if wait is not None:
            del self._until_s[wait]
            self._in_vain.pop(wait.client, None)

    def forget(self, client: int) -> None:
        """Note that a client has gone; the streams that it expected need not be waited for."""
        self._in_vain.pop(client, None)
        self._until_s = {wait: until_s for wait, until_s in self._until_s.items() if wait.client != client}

    def wait_s(self, now_s: float) -> float | None:
        """Return how long the next frame waits at most; None where no subscriber is expected, or not any more."""
        if not self._until_s:
            return None
        for wait, until_s in tuple(self._until_s.items()):
            if until_s <= now_s:
                del self._until_s[wait]
                self._in_vain[wait.client] += 1
        return max(self._until_s.values()) - now_s if self._until_s else None
