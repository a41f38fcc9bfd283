"""A filter of system calls, for sockets of the agent's process to which Landlock's rules of ports do not apply.

Landlock checks ``connect`` and ``bind`` of plain TCP sockets. Other calls reach the same ports: sockets of MPTCP and
SMC, raw packets, and calls by io_uring. So does a connection that begins with the first data (TCP Fast Open). The
filter is a program of classic BPF for seccomp (https://docs.kernel.org/userspace-api/seccomp_filter.html), which needs
no privilege. All processes that a filtered one starts inherit it, and none can take it off.
"""

from __future__ import annotations

import ctypes
import errno
import platform
import socket
import struct
import sys
from typing import NamedTuple

SET_MODE_FILTER = 1  # SECCOMP_SET_MODE_FILTER
ALLOW, ERRNO = 0x7FFF0000, 0x00050000  # SECCOMP_RET_ALLOW, SECCOMP_RET_ERRNO: the low 16 bits are the error
LOAD, JUMP_EQUAL, JUMP_AT_LEAST, JUMP_BITS, MASK, RETURN = 0x20, 0x15, 0x35, 0x45, 0x54, 0x06  # BPF_LD|W|ABS and so on
NUMBER_AT, ARCHITECTURE_AT, ARGUMENTS_AT = 0, 4, 16  # in struct seccomp_data; the low halves of arguments are read

MPTCP, SMC_PROTOCOL = 262, 256  # IPPROTO_MPTCP; IPPROTO_SMC, since Linux 6.11
SMC, XDP = 43, 44  # AF_SMC, AF_XDP
SOCK_PACKET = 10  # the kernel makes a socket of AF_PACKET of one of AF_INET with this type
TYPE_BITS = 0xF  # of the type of a socket; SOCK_NONBLOCK and SOCK_CLOEXEC are above them
FAST_OPEN = 0x20000000  # MSG_FASTOPEN
TCP_ULP = 31  # an option that makes another kind of socket of one of TCP, such as SMC
FOREIGN_CALLS = 0x40000000  # calls of x32 on x86-64 begin here
IO_URING_SETUP = 425  # the same on all of Linux's architectures


class _Machine(NamedTuple):
    """Numbers of system calls of an architecture."""

    architecture: int  # AUDIT_ARCH_*
    seccomp: int
    socket: int
    setsockopt: int
    sending: tuple[tuple[int, int], ...]  # each call that sends to an address, and which argument has its flags


MACHINES = {
    "x86_64": _Machine(0xC000003E, seccomp=317, socket=41, setsockopt=54, sending=((44, 3), (46, 2), (307, 3))),
    "aarch64": _Machine(0xC00000B7, seccomp=277, socket=198, setsockopt=208, sending=((206, 3), (211, 2), (269, 3))),
}


class _Program(ctypes.Structure):
    """``struct sock_fprog``: how many instructions there are, and where."""

    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def filter_sockets() -> bool:
    """Refuse such calls to this thread and all that it starts; return whether the filter is in force.

    The process must have given up new privileges before, as `confinement.confine` does.
    """
    machine = MACHINES.get(platform.machine()) if sys.platform == "linux" else None
    if machine is None:
        return False
    code = program(machine)
    asked = _Program(len(code) // 8, code)
    return int(ctypes.CDLL(None).syscall(machine.seccomp, SET_MODE_FILTER, 0, ctypes.byref(asked))) == 0


def program(machine: _Machine) -> bytes:
    """Return the filter's instructions (``struct sock_filter``, 8 bytes each) for an architecture."""
    inet, raw = (socket.AF_INET, socket.AF_INET6), (socket.SOCK_RAW, SOCK_PACKET)
    return b"".join(
        (
            _step(LOAD, ARCHITECTURE_AT),
            _step(JUMP_EQUAL, machine.architecture, holds=1),
            _refuse(errno.ENOSYS),
            _step(LOAD, NUMBER_AT),
            _step(JUMP_AT_LEAST, FOREIGN_CALLS, fails=1),
            _refuse(errno.ENOSYS),
            _for_call(IO_URING_SETUP, _refuse(errno.ENOSYS)),
            _for_call(
                machine.socket,
                *(_if_argument(0, family, _refuse(errno.EAFNOSUPPORT)) for family in (SMC, socket.AF_PACKET, XDP)),
                *(
                    _if_argument(
                        0,
                        family,
                        *(_if_argument(1, kind, _refuse(errno.EPERM), bits=TYPE_BITS) for kind in raw),
                        *(_if_argument(2, kind, _refuse(errno.EPROTONOSUPPORT)) for kind in (MPTCP, SMC_PROTOCOL)),
                    )
                    for family in inet
                ),
            ),
            _for_call(
                machine.setsockopt,
                _if_argument(1, socket.IPPROTO_TCP, _if_argument(2, TCP_ULP, _refuse(errno.ENOPROTOOPT))),
            ),
            *(
                _for_call(
                    call,
                    _step(LOAD, ARGUMENTS_AT + 8 * flags),
                    _step(JUMP_BITS, FAST_OPEN, fails=1),
                    _refuse(errno.EOPNOTSUPP),
                )
                for call, flags in machine.sending
            ),
            _step(RETURN, ALLOW),
        )
    )


def _step(code: int, value: int, *, holds: int = 0, fails: int = 0) -> bytes:
    """Return an instruction; ``holds`` and ``fails`` are the instructions that a jump skips in either case."""
    return struct.pack("=HBBI", code, holds, fails, value)


def _refuse(error: int) -> bytes:
    """Return the instruction that ends the call with an error."""
    return _step(RETURN, ERRNO | error)


def _for_call(number: int, *then: bytes) -> bytes:
    """Return instructions for one system call; after them any call is allowed, because its number is not loaded."""
    body = b"".join((*then, _step(RETURN, ALLOW)))
    return _step(JUMP_EQUAL, number, fails=len(body) // 8) + body


def _if_argument(place: int, value: int, *then: bytes, bits: int = 0xFFFFFFFF) -> bytes:
    """Return instructions that are carried out where the ``bits`` of an argument have a value."""
    body = b"".join(then)
    compare = _step(JUMP_EQUAL, value, fails=len(body) // 8)
    return _step(LOAD, ARGUMENTS_AT + 8 * place) + _step(MASK, bits) + compare + body
