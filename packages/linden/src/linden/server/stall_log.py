"""Log lines about stalls: the peer that holds up the frames, once when a stall lasts, and once when it ends.

The caller passes the time. Two things can hold up the frames of synchronous mode. A subscriber does not read its
messages, or a client does not tick.
"""

import logging
from collections.abc import Sequence

from linden.server.peers import RpcPeer, StreamPeer

log = logging.getLogger("linden")

HELD_UP_S = 1.0
"""From when on a frame that waits for subscribers is spoken of: twenty steps of 0.05 s."""
NO_TICK_S = 10.0
"""From when on a missing tick is spoken of: longer than a client's own start, and twice its default time-out."""

_NAMED = 5  # how many peers a sentence names


class Stall:
    """One stretch of waiting after the other, each told of once it has lasted."""

    def __init__(self, told_after_s: float) -> None:
        self._told_after_s = told_after_s
        self._since_s: float | None = None
        self._is_told = False

    def goes_on(self, now_s: float) -> bool:
        """Begin a stretch, or let it last; whether it is now to be told of, which is so once."""
        if self._since_s is None:
            self._since_s = now_s
        if self._is_told or now_s - self._since_s < self._told_after_s:
            return False
        self._is_told = True
        return True

    def ends(self, now_s: float) -> float | None:
        """End the stretch; return how long it was where it had been told of."""
        lasted_s = None if self._since_s is None or not self._is_told else now_s - self._since_s
        self._since_s, self._is_told = None, False
        return lasted_s

    def untold_s(self, now_s: float) -> float | None:
        """Return how long it is until the stretch is to be told of, None where there is nothing to tell."""
        if self._since_s is None or self._is_told:
            return None
        return max(0.0, self._since_s + self._told_after_s - now_s)


class StallLog:
    """The waiting of one server."""

    def __init__(self) -> None:
        self._held_up = Stall(HELD_UP_S)
        self._no_tick = Stall(NO_TICK_S)
        self._frame = -1

    def for_subscribers(self, now_s: float, congested: Sequence[StreamPeer]) -> None:
        """Note the peers that a tick waits for at this moment; mostly none."""
        if congested:
            if self._held_up.goes_on(now_s):
                log.warning("a tick waits for %s, with %s unread", _names(congested), _unread(congested))
        elif (lasted_s := self._held_up.ends(now_s)) is not None:
            log.warning("ticks go on after %.1f s of waiting for subscribers", lasted_s)

    def for_a_tick(self, now_s: float, frame: int, clients: Sequence[RpcPeer], last: RpcPeer | None) -> None:
        """Note that time stands still in synchronous mode until a client ticks.

        Args:
            now_s: the time.
            frame: number of the last frame.
            clients: the clients that could tick; empty where the server does not wait for a tick.
            last: the client that ticked last, None before the first tick.
        """
        if frame != self._frame or not clients:
            self._frame = frame
            if (lasted_s := self._no_tick.ends(now_s)) is not None:
                log.warning("the wait for a tick is over after %.1f s", lasted_s)
        if clients and self._no_tick.goes_on(now_s):
            log.warning(
                "synchronous mode: no tick for %.0f s after frame %d; %s", NO_TICK_S, frame, _whose(clients, last)
            )

    def untold_s(self, now_s: float) -> float | None:
        """Return how long it is until there may be something to tell, None where there is not."""
        waits = [self._held_up.untold_s(now_s), self._no_tick.untold_s(now_s)]
        return min((wait_s for wait_s in waits if wait_s is not None), default=None)


def _whose(clients: Sequence[RpcPeer], last: RpcPeer | None) -> str:
    """Log the client with the missing tick."""
    if last is None:
        return f"no client has ticked yet; connected: {_names(clients)}"
    if last.is_open:
        return f"waiting for {last}, which made that one"
    return f"{last} made that one and has left; another may tick, or end synchronous mode: {_names(clients)}"


def _names(peers: Sequence[RpcPeer] | Sequence[StreamPeer]) -> str:
    more = f" and {len(peers) - _NAMED} more" if len(peers) > _NAMED else ""
    return ", ".join(map(str, peers[:_NAMED])) + more


def _unread(peers: Sequence[StreamPeer]) -> str:
    return f"{sum(peer.outgoing.waiting_bytes for peer in peers) / 2**20:.1f} MiB"
