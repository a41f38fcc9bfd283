"""Namespaces of Linux for the agent's process: it neither sees nor limits others, and leaves nothing that lasts.

``user_namespaces(7)``, ``pid_namespaces(7)``, ``ipc_namespaces(7)``. No privilege is needed where the kernel allows
them; a container or a distribution may forbid them. Import nothing but the standard library here: the keeper stays
small.
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
NEW_QUEUES = 0x08000000  # CLONE_NEWIPC
READ_ONLY, SAFE = 1, 2 | 4 | 8  # MS_RDONLY; MS_NOSUID, MS_NODEV, MS_NOEXEC
BIND = 1 << 12 | 1 << 14  # MS_BIND, MS_REC
MOUNT_SETATTR, HERE, BELOW = 442, -100, 0x8000  # system call; AT_FDCWD, AT_RECURSIVE
SHARED_MEMORY = "/dev/shm"  # noqa: S108 - a system folder, not a temporary file
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


def forget(writable: Iterable[str]) -> bool:
    """Let nothing that this process leaves outlast its namespaces, but in the folders in which it may write.

    Shared memory and message queues become its own, and all other folders read-only: Landlock has no rule for times,
    permissions and attributes of files. Shared memory stays common where ``writable`` names ``/dev/shm``. Return
    whether all of it holds.
    """
    kept = list(writable)
    libc = ctypes.CDLL(None, use_errno=True)
    if SHARED_MEMORY in kept or int(libc.unshare(NEW_QUEUES)) != 0:
        return False
    if int(libc.mount(b"own", SHARED_MEMORY.encode(), b"tmpfs", SAFE & ~8, b"mode=1777")) != 0:
        return False
    if any(int(libc.mount(os.fsencode(each), os.fsencode(each), None, BIND, None)) != 0 for each in kept):
        return False
    if not _set_read_only(libc, "/", is_read_only=True):
        return False
    are_writable = [_set_read_only(libc, each, is_read_only=False) for each in (*kept, SHARED_MEMORY)]
    return all(are_writable)


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


def _set_read_only(libc: ctypes.CDLL, folder: str, *, is_read_only: bool) -> bool:
    """Change the mount at a folder and all mounts below it (Linux 5.12); whether the kernel allowed it."""
    changes = (ctypes.c_uint64 * 4)(int(is_read_only), int(not is_read_only))  # struct mount_attr: set, clear
    size = ctypes.sizeof(changes)
    return int(libc.syscall(MOUNT_SETATTR, HERE, os.fsencode(folder), BELOW, ctypes.byref(changes), size)) == 0


def _can_fork() -> bool:
    """Whether a first process of the namespace starts."""
    first = os.fork()
    if first == 0:
        os._exit(0)
    return os.waitpid(first, 0)[1] == 0
