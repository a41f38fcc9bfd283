"""Confinement of the agent's process by the kernel: it may signal and trace its own processes only.

Landlock (Linux 6.12, ABI 6; https://docs.kernel.org/userspace-api/landlock.html) needs no privilege. A process that it
confines cannot end the simulator or the benchmark by a signal, and all processes that it starts inherit that.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys

CREATE_RULESET, RESTRICT_SELF = 444, 446  # system calls, the same on all of Linux's architectures
ABI_VERSION = 1  # flag of CREATE_RULESET
SIGNAL_SCOPE = 2  # LANDLOCK_SCOPE_SIGNAL
ABI_WITH_SCOPES = 6
NO_NEW_PRIVILEGES = 38  # prctl(2); Landlock asks for it


class _Ruleset(ctypes.Structure):
    """``struct landlock_ruleset_attr``: kinds of access to files and to the network, and scopes."""

    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


def is_available() -> bool:
    """Whether this system's kernel can confine signals."""
    if sys.platform != "linux" or platform.machine() not in ("x86_64", "aarch64"):
        return False
    return int(ctypes.CDLL(None).syscall(CREATE_RULESET, None, 0, ABI_VERSION)) >= ABI_WITH_SCOPES


def confine() -> bool:
    """Let this thread, and all threads and processes that it starts, signal only one another; whether that is so.

    Call it before the process has other threads.
    """
    if not is_available():
        return False
    libc = ctypes.CDLL(None)
    rules = _Ruleset(scoped=SIGNAL_SCOPE)
    descriptor = int(libc.syscall(CREATE_RULESET, ctypes.byref(rules), ctypes.sizeof(rules), 0))
    if descriptor < 0:
        return False
    try:
        return (
            int(libc.prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0)) == 0 and int(libc.syscall(RESTRICT_SELF, descriptor, 0)) == 0
        )
    finally:
        os.close(descriptor)
