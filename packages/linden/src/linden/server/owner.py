"""Which process a connection belongs to, on Linux.

An agent beside a server could else walk round its gate, or go through the gate of another agent.

``/proc/net/tcp`` gives the inode of the socket at the other end of a connection within the machine, and
``/proc/PID/fd`` the sockets of a process (proc(5)).
"""

import logging
import socket
import struct
import sys
from collections.abc import Iterable
from pathlib import Path

log = logging.getLogger("linden")

_READINGS = 5  # the table is not read at once: a row may be missed where others come and go
_LOCAL, _REMOTE, _INODE = 1, 2, 9  # columns of /proc/net/tcp


def admits(agent: int | None, sock: socket.socket) -> bool:
    """Return whether a gate lets a connection in: one of its agent's process or of what that started.

    ``agent`` is None if any process may connect.
    """
    if agent is None or belongs_to(sock, agent):
        return True
    if belongs_to(sock, *_started_by(agent)):
        return True
    log.warning("a connection to a gate is closed: it is not of the gate's agent, process %d", agent)
    return False


def belongs_to(sock: socket.socket, *processes: int) -> bool:
    """Return whether the other end of an accepted IPv4 connection is a socket of one of some processes.

    True where the system has no such tables: there the door cannot be closed.
    """
    if sys.platform != "linux" or sock.family != socket.AF_INET:
        return True
    try:
        near, far = _column(sock.getsockname()), _column(sock.getpeername())
        inode = next(filter(None, (_inode(far, near) for _ in range(_READINGS))), None)
    except OSError:  # the connection is gone
        return False
    return inode is not None and any(_has(process, f"socket:[{inode}]") for process in processes)


def _has(process: int, wanted: str) -> bool:
    """Return whether a process holds a socket."""
    try:
        return any(_target(file) == wanted for file in Path(f"/proc/{process}/fd").iterdir())
    except OSError:  # the process is gone
        return False


def _started_by(process: int) -> Iterable[int]:
    """Return the descendants of a process."""
    below: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            # the name of the program stands in brackets and may hold anything; state and parent follow
            parent = int(stat.read_text("ascii", "replace").rpartition(")")[2].split()[1])
        except (OSError, IndexError):
            continue
        below.setdefault(parent, []).append(int(stat.parent.name))
    found = list(below.get(process, ()))
    for each in found:
        found += below.get(each, ())
    return found


def _inode(local: str, remote: str) -> str | None:
    """Return the inode of the socket with these two addresses, None where the table does not show it."""
    rows = map(str.split, Path("/proc/net/tcp").read_text("ascii").splitlines()[1:])
    return next((row[_INODE] for row in rows if (row[_LOCAL], row[_REMOTE]) == (local, remote)), None)


def _column(address: tuple[str, int]) -> str:
    """Return an address as /proc/net/tcp writes it: an integer of this machine, and the port, in hexadecimal."""
    (number,) = struct.unpack("=I", socket.inet_aton(address[0]))
    return f"{number:08X}:{address[1]:04X}"


def _target(file: Path) -> str:
    """Return what a link leads to, which is no path for a socket."""
    try:
        return str(file.readlink())
    except OSError:  # closed meanwhile
        return ""
