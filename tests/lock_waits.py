"""How long a server lets a call wait: its main thread's work, and its wait for Python's lock. Linux's clocks.

The load of other processes is left out. At any moment of a call one of these is true: the server's main thread works,
or waits for a core; the client's thread works, or waits for a core; or neither. In the last case the main thread waits
for Python's lock, which another thread of the server holds (or the moment is one of the few microseconds on the way).
That thread may itself wait for a core meanwhile, so the wait is at most the processor time of the server's other
threads. Both bounds hold at once, and the lesser one is taken: what other processes take from one side, they leave in
the other.
"""

import time
from pathlib import Path
from typing import NamedTuple


class Moment(NamedTuple):
    """What the clocks show. All in s."""

    now_s: float
    process_s: float
    """Processor time of all threads of the server."""
    main_s: float
    """Of its main thread."""
    scheduled_s: float
    """For how long its main thread or this thread has worked or waited for a core."""


class LockWatch:
    """The clocks of a server, read by the thread that calls it."""

    def __init__(self, pid: int) -> None:
        self._of_process = (~pid << 3) | 2  # CPUCLOCK_SCHED of a process: linux/posix-timers.h
        self._of_main = Path(f"/proc/{pid}/task/{pid}/schedstat")

    def read(self) -> Moment:
        """Return the present moment."""
        own_s = sum(_scheduled(Path("/proc/thread-self/schedstat")))
        main_s, delay_s = _scheduled(self._of_main)
        process_s = time.clock_gettime(self._of_process)
        return Moment(time.monotonic(), process_s, main_s, own_s + main_s + delay_s)


def held_up_s(before: Moment, after: Moment) -> float:
    """Return for how long the server's main thread worked, or waited for Python's lock, between two moments."""
    worked_s = after.main_s - before.main_s
    neither_s = (after.now_s - before.now_s) - (after.scheduled_s - before.scheduled_s)
    others_s = (after.process_s - before.process_s) - worked_s
    return worked_s + max(0.0, min(neither_s, others_s))


def _scheduled(path: Path) -> tuple[float, float]:
    """Return the time on a core and the time of waiting for one: proc(5), "schedstat"."""
    worked_ns, waited_ns, _ = path.read_text("ascii").split()
    return int(worked_ns) / 1e9, int(waited_ns) / 1e9
