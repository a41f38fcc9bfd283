"""Claims about threads of C++ that fail: the process goes on, says what it has to say, and ends as it was told to."""

import signal
import subprocess
import sys

PROGRAM = """
import ctypes, threading, time
from basu import client_threads

{hold}
terminate = ctypes.CDLL(client_threads.LIBRARY)._ZSt9terminatev
{fail}
while not client_threads.is_held():
    time.sleep(0.01)
print("what was measured")
client_threads.leave(3)
"""
ON_A_THREAD = "threading.Thread(target=terminate).start()"


def ended(hold: str, fail: str) -> "subprocess.CompletedProcess[str]":
    program = PROGRAM.format(hold=hold, fail=fail)
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60)


def test_a_thread_that_fails_is_held_and_the_rest_goes_on() -> None:
    done = ended("client_threads.hold()", ON_A_THREAD)
    assert (done.returncode, done.stdout) == (3, "what was measured\n")


def test_without_it_the_process_would_have_ended() -> None:
    assert ended("", ON_A_THREAD).returncode == -signal.SIGABRT


def test_on_the_main_thread_nothing_can_be_saved() -> None:
    assert ended("client_threads.hold()", "terminate()").returncode == -signal.SIGABRT


COMMAND = """
import ctypes, threading, time
from basu import client_threads
from basu.cli import entry_point, main

client_threads.hold()
threading.Thread(target=ctypes.CDLL(client_threads.LIBRARY)._ZSt9terminatev).start()
while not client_threads.is_held():
    time.sleep(0.01)
assert main(["nothing"]) == 2
print("the caller goes on")
entry_point()
"""


def test_a_held_thread_ends_the_process_of_a_command_and_not_a_caller_of_main() -> None:
    """A worker of the tests ended without a word, because a test before had a thread that was held."""
    words = [sys.executable, "-c", COMMAND, "nothing"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stdout) == (2, "the caller goes on\n"), done.stderr
