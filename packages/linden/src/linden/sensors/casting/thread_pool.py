"""Work on long arrays by all processors at once.

The threads are daemons: a process that ends does not wait for them. Those of ``concurrent.futures`` it would
wait for, and for ever where the signal came in the moment in which one was started.
"""

import os
from collections.abc import Callable
from concurrent.futures import Future
from functools import lru_cache
from itertools import count
from queue import SimpleQueue
from threading import Thread, local
from typing import TypeAlias

from linden.background import carry_out

Task: TypeAlias = tuple[Callable[[], None], "Future[None]"]

FEWEST = 512
"""Rays; a shorter stretch costs more to hand out than to work on."""

_here = local()  # .works: whether this thread works on a stretch

_STRETCHES = 4  # for each thread, so that one that met much to do is not waited for long


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@lru_cache(maxsize=1)
def _tasks() -> "SimpleQueue[Task]":
    """Return the task queue of the threads. There is one thread for each processor but the caller's."""
    tasks: SimpleQueue[Task] = SimpleQueue()

    def serve() -> None:
        while True:
            carry_out(*tasks.get())

    for _ in range(processors() - 1):
        Thread(target=serve, name="rays", daemon=True).start()
    return tasks


def in_stretches(
    total: int, work: Callable[[int, int], None], *, multiple: int, fewest: int = FEWEST, threads: int = 0
) -> None:
    """Call ``work(start, stop)`` for stretches that make up ``total``, each but the last a ``multiple`` long.

    No stretch but the last is shorter than ``fewest``. At most ``threads`` work, 0 being all processors.

    ``work`` has to let go of Python's lock, and to do the same for each number whatever the stretch it is in. What it
    asks for in stretches itself is done by its own thread.
    """
    hands = min(threads, processors()) or processors()
    length = -(-max(fewest, -(-total // (hands * _STRETCHES))) // multiple) * multiple
    if hands == 1 or total <= length or getattr(_here, "works", False):
        if total:
            work(0, total)
        return
    turn = count()

    def take() -> None:
        _here.works = True
        try:
            while (start := next(turn) * length) < total:
                work(start, min(total, start + length))
        finally:
            _here.works = False

    helpers = [Future[None]() for _ in range(min(hands, -(-total // length)) - 1)]
    for helper in helpers:
        _tasks().put((take, helper))
    take()
    for helper in helpers:
        helper.result()
