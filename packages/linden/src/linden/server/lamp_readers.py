"""`LampReaders`: counts the clients that a snapshot has told to read the lamps and that have not read them yet.

A snapshot says whether lamps or the map have changed. If so, LibCarla's ``carla.LightManager`` reads the lamps by a
call, from the thread that receives the snapshot. If no answer comes, the time-out of that call ends the client's whole
process (``std::terminate``), even if its program is not waiting for the simulator. So the server's end waits for these
calls.

A subscription does not name its client, so the calls are counted. All times in s of one steady clock.
"""

import math

READS_LAMPS = "query_lights_state"

READING_S = 0.8
"""How long after such a snapshot the end waits at most: less than ``linden.cli.process.GRACE_S``. The official client
takes 1 ms, and longer on a busy machine. Programs of another kind need not read the lamps at all."""


class LampReaders:
    """Clients that are about to read the lamps."""

    def __init__(self) -> None:
        self._count = 0
        self._until_s = -math.inf

    def told(self, clients: int, now_s: float) -> None:
        """Note that a snapshot with the news went to so many clients."""
        if now_s >= self._until_s:
            self._count = 0
        self._count += clients
        self._until_s = now_s + READING_S

    def has_read(self) -> None:
        """Note that a client has read the lamps."""
        self._count = max(0, self._count - 1)

    def wait_s(self, now_s: float) -> float:
        """Return how long the end of the server waits at most; 0 if it need not wait."""
        return max(0.0, self._until_s - now_s) if self._count else 0.0
