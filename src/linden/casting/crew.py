"""Work in threads: on long arrays by all processors at once, and beside other work."""

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import lru_cache
from itertools import count
from typing import TypeVar

Made = TypeVar("Made")

FEWEST = 512
"""Rays; a shorter stretch costs more to hand out than to work on."""

_STRETCHES = 4  # for each thread, so that one that met much to do is not waited for long


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@lru_cache(maxsize=1)
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(1, processors() - 1), thread_name_prefix="rays")


def in_stretches(total: int, work: Callable[[int, int], None], *, multiple: int) -> None:
    """Call ``work(start, stop)`` for stretches that make up ``total``, each but the last a ``multiple`` long.

    ``work`` has to let go of Python's lock, and to do the same for each number whatever the stretch it is in.
    """
    hands = processors()
    length = -(-max(FEWEST, -(-total // (hands * _STRETCHES))) // multiple) * multiple
    if hands == 1 or total <= length:
        if total:
            work(0, total)
        return
    turn = count()

    def take() -> None:
        while (start := next(turn) * length) < total:
            work(start, min(total, start + length))

    helpers: list[Future[None]] = [_pool().submit(take) for _ in range(min(hands, -(-total // length)) - 1)]
    take()
    for helper in helpers:
        helper.result()


def in_background(work: Callable[[], Made]) -> Future[Made]:
    """Return what will have been made by a thread of its own, which may wait for others."""
    hand = ThreadPoolExecutor(1, thread_name_prefix="background")
    made = hand.submit(work)
    hand.shutdown(wait=False)
    return made
