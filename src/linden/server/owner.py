"""Which process a connection belongs to, on Linux: an agent beside a server could else walk round its gate.

``/proc/net/tcp`` gives the inode of the socket at the other end of a connection within the machine, and
``/proc/PID/fd`` the sockets of a process (proc(5)).
"""

import socket
import struct
import sys
from pathlib import Path

_READINGS = 5  # the table is not read at once: a row may be missed where others come and go
_LOCAL, _REMOTE, _INODE = 1, 2, 9  # columns of /proc/net/tcp


def belongs_to(sock: socket.socket, process: int) -> bool:
    """Return whether the other end of an accepted IPv4 connection is a socket of a process on this machine.

    True where the system has no such tables: there the door cannot be closed.
    """
    if sys.platform != "linux" or sock.family != socket.AF_INET:
        return True
    try:
        near, far = _column(sock.getsockname()), _column(sock.getpeername())
        inode = next(filter(None, (_inode(far, near) for _ in range(_READINGS))), None)
        if inode is None:
            return False
        wanted = f"socket:[{inode}]"
        return any(_target(file) == wanted for file in Path(f"/proc/{process}/fd").iterdir())
    except OSError:  # one of the two is gone
        return False


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
