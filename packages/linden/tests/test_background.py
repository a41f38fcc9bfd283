"""Work in the background ends where it is not wanted any more, and before its process ends."""

import subprocess
import sys
import time
from threading import Event
from types import SimpleNamespace

import pytest

from linden import background
from linden.background import NotWantedError, OneAtATime, checkpoint, in_background


def test_what_was_made_or_raised_is_had_from_the_future() -> None:
    assert in_background(lambda: 7).result(10) == 7
    with pytest.raises(ZeroDivisionError):
        in_background(lambda: 1 // 0).result(10)


def test_work_that_is_not_wanted_ends_at_its_next_checkpoint() -> None:
    unwanted = Event()

    def work_for_ever() -> None:
        while True:
            checkpoint()

    made = in_background(work_for_ever, unwanted)
    other = in_background(checkpoint, Event())
    unwanted.set()
    with pytest.raises(NotWantedError):
        made.result(10)
    assert other.result(10) is None
    checkpoint()  # here nothing is given up


def wait_until_returned() -> None:
    """Wait until no memory is to be returned."""
    until_s = time.monotonic() + 10
    while background._returns:
        assert time.monotonic() < until_s
        time.sleep(0.01)


def test_memory_is_returned_after_the_last_work_and_not_after_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """What work made is still held when it ends, so the system gets no memory if it is returned at once."""
    wait_until_returned()  # for the tests before this one
    returned_s: list[float] = []
    library = SimpleNamespace(malloc_trim=lambda _: returned_s.append(time.monotonic()))
    monkeypatch.setattr(background.ctypes, "CDLL", lambda _: library)
    monkeypatch.setattr(background, "_SETTLED_S", 0.2)
    for _ in range(20):
        in_background(lambda: None).result(10)
        time.sleep(0.02)
    ended_s = time.monotonic()
    wait_until_returned()
    assert returned_s[-1] >= ended_s
    assert len(returned_s) < 10


AT_THE_END = """
import sys, time
from linden.background import checkpoint, end_all, in_background
def work():
    for _ in range(10_000):
        time.sleep(0.01)
        {check}
made = in_background(work)
print(end_all(0.5), made.done(), in_background(checkpoint).exception(10).__class__.__name__)
"""


@pytest.mark.parametrize(
    ("check", "said"), [("checkpoint()", "True True NoneType"), ("pass", "False False NotWantedError")]
)
def test_the_end_of_a_process_waits_for_work_but_not_for_ever(check: str, said: str) -> None:
    program = [sys.executable, "-c", AT_THE_END.format(check=check)]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=60, check=True)
    assert ran.stdout == f"{said}\n"


def test_one_thread_at_a_time_is_let_in_and_one_that_is_not_wanted_stops_waiting() -> None:
    turns, unwanted, inside = OneAtATime(), Event(), []

    def take_turn() -> int:
        with turns:
            inside.append(len(inside))
            return inside[-1]

    with turns:
        given_up, waiting = in_background(take_turn, unwanted), in_background(take_turn)
        unwanted.set()
        with pytest.raises(NotWantedError):
            given_up.result(10)
        assert inside == []
    assert waiting.result(10) == 0
    with pytest.raises(ZeroDivisionError), turns:
        _ = 1 // 0
    assert take_turn() == 1


HEAPS = """
import ctypes, tempfile, threading
from linden.background import share_one_heap
share_one_heap() if {shared} else None
started = threading.Barrier(4)
def allocate():
    started.wait()
    bytearray(100_000)
threads = [threading.Thread(target=allocate) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
libc = ctypes.CDLL(None)
libc.fopen.restype = ctypes.c_void_p
with tempfile.NamedTemporaryFile() as file:
    stream = ctypes.c_void_p(libc.fopen(file.name.encode(), b"w"))
    libc.malloc_info(0, stream)
    libc.fclose(stream)
    print(file.read().count(b"<heap nr="))
"""


def test_threads_share_one_heap_after_the_call() -> None:
    counts = [
        int(subprocess.check_output([sys.executable, "-c", HEAPS.format(shared=shared)])) for shared in (True, False)
    ]
    assert counts[0] == 1
    assert counts[1] > 1
