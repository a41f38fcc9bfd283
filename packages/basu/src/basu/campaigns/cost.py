"""`cost_of` returns the processor time and memory of a process and its descendants, from ``/proc`` of Linux."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

TICKS_HZ = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
UTIME, STIME, RSS = 11, 12, 21  # fields of /proc/PID/stat behind the program's name: proc_pid_stat(5), less 3


class Cost(NamedTuple):
    """A state of a tree of processes."""

    cpu_s: float  # since their starts
    memory_mb: float  # resident, pages that processes share counted in each


def cost_of(pid: int | None = None) -> Cost:
    """The cost of a process and its children so far; zeros where the system does not say."""
    cpu_s = memory_mb = 0.0
    waiting = [os.getpid() if pid is None else pid]
    while waiting:
        process = Path(f"/proc/{waiting.pop()}")
        try:
            fields = (process / "stat").read_text().rpartition(")")[2].split()
            children = [path.read_text() for path in process.glob("task/*/children")]
        except OSError:  # it has ended, or there is no /proc
            continue
        cpu_s += (int(fields[UTIME]) + int(fields[STIME])) / TICKS_HZ
        memory_mb += int(fields[RSS]) * PAGE_BYTES / 1e6
        waiting += [int(child) for text in children for child in text.split()]
    return Cost(cpu_s, memory_mb)
