"""A process ends with its parent, however the parent ended: prctl(2) of Linux. Other systems have no such call."""

from __future__ import annotations

import ctypes
import signal
import sys

PR_SET_PDEATHSIG = 1


def end_with_parent(by: signal.Signals = signal.SIGKILL) -> None:
    """Have the kernel send this process a signal when the thread that started it is gone."""
    prctl(PR_SET_PDEATHSIG, by)


def prctl(option: int, value: int) -> None:
    """Set an option of this process by its number in Linux (the system call of this name); elsewhere do nothing."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)
