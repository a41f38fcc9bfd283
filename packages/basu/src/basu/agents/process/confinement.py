"""Confinement of the agent's process by the kernel: its own processes, its own folder, and no way around the gate.

Landlock (Linux 5.13; ports from 6.7, signals from 6.12; https://docs.kernel.org/userspace-api/landlock.html) needs no
privilege. All processes that a confined one starts inherit it, and none can take it off.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from typing import TYPE_CHECKING

from basu.agents.process.namespaces import SHARED_MEMORY
from basu.agents.process.socket_filter import filter_sockets

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

PROCESSES, SIGHT, RESULTS, MEMORY = "processes", "sight", "results", "memory"
SIGNALS, FILES, PORTS = "signals", "files", "ports"
MEANINGS = {
    PROCESSES: "all that it starts ends with it, and it can neither signal nor limit other processes",
    SIGHT: "it sees no other processes",
    RESULTS: "it sees neither the folder of its drive nor results of others",
    MEMORY: "what it leaves in shared memory, in message queues and in attributes of files ends with it",
    SIGNALS: "it can signal and trace no other processes",
    FILES: "it writes in its own folder only",
    PORTS: "it can use neither the simulator's own ports nor those of Traffic Managers",
}
"""The parts of a confinement; which of them hold depends on the kernel and its settings."""

CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446  # system calls, the same on all of Linux's architectures
ABI_VERSION = 1  # flag of CREATE_RULESET
PATH_BENEATH, NET_PORT = 1, 2  # LANDLOCK_RULE_PATH_BENEATH, LANDLOCK_RULE_NET_PORT
USE_TCP = 1 | 2  # LANDLOCK_ACCESS_NET_BIND_TCP, LANDLOCK_ACCESS_NET_CONNECT_TCP
PORT_NUMBERS = 1 << 16
SIGNAL_SCOPE = 2  # LANDLOCK_SCOPE_SIGNAL
ABI_WITH_REFER, ABI_WITH_TRUNCATE, ABI_WITH_PORTS, ABI_WITH_SCOPES = 2, 3, 4, 6
WRITE_FILE, REMOVE_AND_MAKE, REFER, TRUNCATE = 1 << 1, 0x1FF0, 1 << 13, 1 << 14  # LANDLOCK_ACCESS_FS_*
NO_NEW_PRIVILEGES = 38  # prctl(2); Landlock asks for it
DEVICES, OWN_PROCESSES = "/dev", "/proc"


class _Ruleset(ctypes.Structure):
    """``struct landlock_ruleset_attr``: kinds of access to files and to the network, and scopes."""

    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _Beneath(ctypes.Structure):
    """``struct landlock_path_beneath_attr``: kinds of access below an open folder."""

    _pack_ = 1
    _fields_ = (("files", ctypes.c_uint64), ("folder", ctypes.c_int32))


class _Port(ctypes.Structure):
    """``struct landlock_net_port_attr``: kinds of access to a port."""

    _fields_ = (("network", ctypes.c_uint64), ("port", ctypes.c_uint64))


def sentence(held: Iterable[str]) -> str:
    """What a confinement comes to, in words."""
    known = [meaning for name, meaning in MEANINGS.items() if name in held]
    return "; ".join(known) or "nothing confines it here"


def landlock_abi() -> int:
    """The version of the kernel's Landlock; 0 where there is none."""
    if sys.platform != "linux" or platform.machine() not in ("x86_64", "aarch64"):
        return 0
    return max(0, int(ctypes.CDLL(None).syscall(CREATE_RULESET, None, 0, ABI_VERSION)))


def is_available() -> bool:
    """Whether this system's kernel can confine signals."""
    return landlock_abi() >= ABI_WITH_SCOPES


def confine(
    writable: Sequence[str], *, sees_own_processes: bool = False, closed_ports: Sequence[int] = ()
) -> list[str]:
    """Confine this thread, and all threads and processes that it starts; the parts that hold.

    Call it before the process has other threads. ``writable`` are the folders below which it may write;
    ``sees_own_processes`` says that ``/proc`` has its own processes only, which it may adjust. It may neither
    connect to ``closed_ports`` of TCP nor listen there, at any address, nor can it send raw packets.
    """
    abi = landlock_abi()
    if abi == 0:
        return []
    everything = WRITE_FILE | REMOVE_AND_MAKE
    everything |= REFER if abi >= ABI_WITH_REFER else 0
    everything |= TRUNCATE if abi >= ABI_WITH_TRUNCATE else 0
    has_scopes = abi >= ABI_WITH_SCOPES
    has_ports = bool(closed_ports) and abi >= ABI_WITH_PORTS
    rules = _Ruleset(files=everything, network=USE_TCP if has_ports else 0, scoped=SIGNAL_SCOPE if has_scopes else 0)
    libc = ctypes.CDLL(None)
    size = (3 if has_scopes else 2 if has_ports else 1) * ctypes.sizeof(ctypes.c_uint64)
    ruleset = int(libc.syscall(CREATE_RULESET, ctypes.byref(rules), size, 0))
    if ruleset < 0:
        return []
    to_files = everything & (WRITE_FILE | TRUNCATE)
    allowed = [*((folder, everything) for folder in (*writable, SHARED_MEMORY)), (DEVICES, to_files)]
    if sees_own_processes:
        allowed.append((OWN_PROCESSES, to_files))
    try:
        for folder, access in allowed:
            _allow(libc, ruleset, folder, access)
        if has_ports:
            _close_ports(libc, ruleset, closed_ports)
        if libc.prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0) != 0 or libc.syscall(RESTRICT_SELF, ruleset, 0) != 0:
            return []
    finally:
        os.close(ruleset)
    has_ports = has_ports and filter_sockets()
    return [*([SIGNALS] if has_scopes else []), FILES, *([PORTS] if has_ports else [])]


def _allow(libc: ctypes.CDLL, ruleset: int, folder: str, access: int) -> None:
    """Allow kinds of access below a folder, where it is there."""
    try:
        descriptor = os.open(folder, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    try:
        beneath = _Beneath(files=access, folder=descriptor)
        libc.syscall(ADD_RULE, ruleset, PATH_BENEATH, ctypes.byref(beneath), 0)
    finally:
        os.close(descriptor)


def _close_ports(libc: ctypes.CDLL, ruleset: int, closed: Sequence[int]) -> None:
    """Allow the use of all ports but the closed ones: Landlock has rules that allow, and none that forbid."""
    add, kept = libc.syscall, frozenset(closed)
    rule = _Port(network=USE_TCP)
    at = ctypes.byref(rule)
    for port in range(PORT_NUMBERS):
        if port not in kept:
            rule.port = port
            add(ADD_RULE, ruleset, NET_PORT, at, 0)
