"""How an agent's process ended, and whether the kernel's record says that others took the machine's memory.

A process may kill itself, or have itself killed by what it started. So a SIGKILL is the agent's failure, with one
exception. The kernel recorded a kill for want of memory in the benchmark's control group (cgroup), and the agent's own
processes held little of that memory.
"""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path
from typing import NamedTuple

GB = 1e9
OWN_SHARE = 0.5  # of the memory there is: an agent that held more has used it up itself
GROUPS = Path("/sys/fs/cgroup")


class Ending(NamedTuple):
    """The end of a process."""

    code: int  # the exit status, negative for a signal, as ``subprocess`` has it
    peak_bytes: int = 0  # the most memory that one of its processes held, or all together that lived at its end


def ended_how(ending: Ending) -> str:
    """Half a sentence about the end of a process."""
    if ending.code >= 0:
        return f"its process ended with exit status {ending.code}"
    number = -ending.code
    try:
        name = signal.Signals(number).name
    except ValueError:
        name = f"number {number}"
    meaning = signal.strsignal(number) or "unknown"
    held = f"; at most it held {ending.peak_bytes / GB:.2f} GB of memory" if number == signal.SIGKILL else ""
    return f"its process was ended by the signal {name} ({meaning}){held if ending.peak_bytes else ''}"


def ended_outside(ending: Ending, oom_kills: int) -> bool:
    """Whether the machine's want of memory ended a process that had not used it up; ``oom_kills`` in its lifetime."""
    return ending.code == -signal.SIGKILL and oom_kills > 0 and 0 < ending.peak_bytes < OWN_SHARE * memory_bytes()


def oom_kills() -> int:
    """How many processes of this control group the kernel has ended for want of memory; of the machine without one."""
    for path in _files("memory.events", "memory.oom_control"):
        with contextlib.suppress(OSError, ValueError):
            return _value(path, "oom_kill")
    with contextlib.suppress(OSError, ValueError):
        return _value(Path("/proc/vmstat"), "oom_kill")
    return 0


def memory_bytes() -> int:
    """The memory that this control group may use, or that the machine has."""
    there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    for path in _files("memory.max", "memory.limit_in_bytes"):
        with contextlib.suppress(OSError, ValueError):  # "max" is no number
            return min(there, int(path.read_text()))
    return there


def _files(second: str, first: str) -> list[Path]:
    """A file of this process's control group as versions 2 and 1 call it; a container sees its own at the top."""
    found = []
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/cgroup").read_text().splitlines():
            _, kinds, path = line.split(":", 2)
            inside = path.lstrip("/")
            if not kinds:
                found += [GROUPS / inside / second, GROUPS / second]
            elif "memory" in kinds.split(","):
                found += [GROUPS / "memory" / inside / first, GROUPS / "memory" / first]
    return found


def _value(path: Path, name: str) -> int:
    """A number out of lines of names and numbers.

    Raises:
        ValueError: it is not there.
    """
    for line in path.read_text().splitlines():
        key, _, number = line.partition(" ")
        if key == name:
            return int(number)
    raise ValueError(name)
