"""Who listens to which stream, and what is done about those who read too slowly.

In asynchronous mode a message is dropped for a subscriber that has not read those before it. In synchronous mode
nothing is dropped: up to :data:`QUEUED_BYTES` wait for each subscriber; whoever has more waiting is congested, no
frame is made until that is over, and after :data:`PATIENCE_S` the connection is closed.
"""

import logging
from collections.abc import Callable

from linden.server.peers import StreamPeer
from linden.wire.stream import StreamTable

log = logging.getLogger("linden")

QUEUED_BYTES = 32 * 1024 * 1024
"""What may wait for one subscriber: a second of 800 x 600 pictures at 20 Hz, or an hour of snapshots of one car."""
PATIENCE_S = 4.0
"""How long a congested subscriber holds up the frames: less than the 5 s after which other clients give up a call."""


class Subscribers:
    """The stream connections of a server that have said what they listen to."""

    def __init__(
        self, table: StreamTable, watch: Callable[[StreamPeer], None], close: Callable[[StreamPeer], None]
    ) -> None:
        """``watch`` is told of a peer for which something waits, ``close`` of one that is to go."""
        self._table = table
        self._watch = watch
        self._close = close
        self._by_stream: dict[int, list[StreamPeer]] = {}
        self._congested: list[StreamPeer] = []

    def add(self, peer: StreamPeer, stream_id: int) -> None:
        """Begin to send a stream to a peer."""
        self._by_stream.setdefault(stream_id, []).append(peer)
        self._table.subscribe(stream_id)

    def remove(self, peer: StreamPeer) -> None:
        """Forget a peer, whether or not it ever subscribed."""
        stream_id = peer.subscription.stream_id
        if stream_id is not None and peer in self._by_stream.get(stream_id, []):
            self._by_stream[stream_id].remove(peer)
            self._table.unsubscribe(stream_id)
        if peer in self._congested:
            self._congested.remove(peer)

    def publish(self, stream_id: int, payload: bytes, now_s: float, *, may_drop: bool) -> None:
        """Send one message to all who listen; those whose connection is broken are closed."""
        for peer in tuple(self._by_stream.get(stream_id, ())):
            if may_drop and peer.outgoing.waiting_bytes:
                self._drop(peer)
                continue
            self.send(peer, payload, now_s)

    def send(self, peer: StreamPeer, payload: bytes, now_s: float) -> None:
        """Send one message to one peer; closes it where its connection is broken."""
        try:
            peer.publish(payload)
        except OSError as error:
            log.info("%s is gone: %s", peer, error)
            self._close(peer)
            return
        if peer.outgoing.waiting_bytes:
            self._watch(peer)
        if peer.outgoing.waiting_bytes > QUEUED_BYTES and peer.congested_since_s is None:
            peer.congested_since_s = now_s
            self._congested.append(peer)

    def patience_s(self, now_s: float) -> float | None:
        """Return how long frames will wait for the congested, None where they need not wait."""
        self._relieve(now_s)
        if not self._congested:
            return None
        return max(0.0, min((peer.congested_since_s or 0.0) for peer in self._congested) + PATIENCE_S - now_s)

    def _relieve(self, now_s: float) -> None:
        """Take out those who have caught up, and close those with whom patience has ended."""
        for peer in tuple(self._congested):
            if peer.outgoing.waiting_bytes <= QUEUED_BYTES:
                peer.congested_since_s = None
                self._congested.remove(peer)
            elif now_s - (peer.congested_since_s or 0.0) >= PATIENCE_S:
                log.warning(
                    "%s is closed: in synchronous mode it held up the frames for %.0f s with %d bytes unread",
                    peer,
                    PATIENCE_S,
                    peer.outgoing.waiting_bytes,
                )
                self._close(peer)

    def _drop(self, peer: StreamPeer) -> None:
        peer.dropped += 1
        if peer.dropped == 1:
            log.info("%s reads more slowly than frames are made; it misses some (asynchronous mode)", peer)
