"""Namespaces of Linux for the agent's process: with its own users and processes it neither sees nor limits others.

``user_namespaces(7)``, ``pid_namespaces(7)``. No privilege is needed where the kernel allows them; a container or a
distribution may forbid them. Import nothing but the standard library here: the keeper stays small.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

NEW_MOUNTS, NEW_USERS, NEW_PROCESSES = 0x00020000, 0x10000000, 0x20000000  # CLONE_NEWNS, CLONE_NEWUSER, CLONE_NEWPID
READ_ONLY, SAFE = 1, 2 | 4 | 8  # MS_RDONLY; MS_NOSUID, MS_NODEV, MS_NOEXEC
PRIVATE = 1 << 18 | 1 << 14  # MS_PRIVATE, MS_REC
DROP_BOUND = 24  # PR_CAPBSET_DROP
MOST_CAPABILITIES = 64
CAPABILITY_VERSION = 0x20080522  # _LINUX_CAPABILITY_VERSION_3


def enter() -> bool:
    """Give this process namespaces of users and mounts, and its future children one of processes; whether it has them.

    A trial in a child comes first: a process that got half of it could not go back.
    """
    if sys.platform != "linux":
        return False
    trial = os.fork()
    if trial == 0:
        with contextlib.suppress(BaseException):
            os._exit(0 if _enter() and _can_fork() else 1)
        os._exit(1)
    return os.waitpid(trial, 0)[1] == 0 and _enter()


def mount_processes() -> bool:
    """Show this namespace's processes in ``/proc`` instead of all; whether the kernel allowed it."""
    libc = ctypes.CDLL(None, use_errno=True)
    libc.mount(None, b"/", None, PRIVATE, None)  # already so in a namespace of other users
    return int(libc.mount(b"proc", b"/proc", b"proc", SAFE, None)) == 0


def hide(folders: Iterable[str]) -> bool:
    """Show nothing in these folders, to this process and all that it starts; return whether the kernel allowed it."""
    libc = ctypes.CDLL(None, use_errno=True)
    flags = READ_ONLY | SAFE
    return all(int(libc.mount(b"empty", os.fsencode(each), b"tmpfs", flags, b"size=4k")) == 0 for each in folders)


def number_next_process(number: int) -> None:
    """Let the next process of this namespace have an identifier that no other agent's has, where that is possible.

    Programs make names of it: temporary files, nodes of ROS.
    """
    with contextlib.suppress(OSError):
        Path("/proc/sys/kernel/ns_last_pid").write_text(str(number - 1))


def drop_capabilities() -> None:
    """Give up what the namespace of users gave this process; programs that it starts do not get it back."""
    libc = ctypes.CDLL(None)
    for capability in range(MOST_CAPABILITIES):
        libc.prctl(DROP_BOUND, capability, 0, 0, 0)
    header = (ctypes.c_uint32 * 2)(CAPABILITY_VERSION, 0)
    libc.capset(ctypes.byref(header), ctypes.byref((ctypes.c_uint32 * 6)()))


def _enter() -> bool:
    user, group = os.getuid(), os.getgid()
    if int(ctypes.CDLL(None).unshare(NEW_USERS | NEW_PROCESSES | NEW_MOUNTS)) != 0:
        return False
    try:
        Path("/proc/self/setgroups").write_text("deny")
        Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
        Path("/proc/self/gid_map").write_text(f"{group} {group} 1")
    except OSError:
        return False
    return True


def _can_fork() -> bool:
    """Whether a first process of the namespace starts."""
    first = os.fork()
    if first == 0:
        os._exit(0)
    return os.waitpid(first, 0)[1] == 0
