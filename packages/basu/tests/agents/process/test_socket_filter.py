"""The filter's instructions, read by an interpreter of classic BPF.

The kernel refuses some of these calls for other reasons as well (no privilege, no such protocol), so a test that makes
them cannot show that the filter does.
"""

from __future__ import annotations

import errno
import socket
import struct

import pytest

from basu.agents.process.socket_filter import ALLOW, ERRNO, MACHINES, program

STREAM = socket.SOCK_STREAM
SOCKETS = {
    "tcp": ((socket.AF_INET, STREAM, 0), 0),
    "tcp that does not block": ((socket.AF_INET6, STREAM | socket.SOCK_NONBLOCK, 6), 0),
    "udp": ((socket.AF_INET, socket.SOCK_DGRAM, 0), 0),
    "unix": ((socket.AF_UNIX, STREAM, 0), 0),
    "mptcp": ((socket.AF_INET, STREAM, 262), errno.EPROTONOSUPPORT),
    "mptcp of version 6": ((socket.AF_INET6, STREAM | socket.SOCK_CLOEXEC, 262), errno.EPROTONOSUPPORT),
    "smc by family": ((43, STREAM, 0), errno.EAFNOSUPPORT),
    "smc by protocol": ((socket.AF_INET, STREAM, 256), errno.EPROTONOSUPPORT),
    "smc by protocol of version 6": ((socket.AF_INET6, STREAM, 256), errno.EPROTONOSUPPORT),
    "raw": ((socket.AF_INET, socket.SOCK_RAW, 6), errno.EPERM),
    "packets by type": ((socket.AF_INET, 10 | socket.SOCK_CLOEXEC, 0x0300), errno.EPERM),
    "packets by family": ((socket.AF_PACKET, socket.SOCK_RAW, 0x0300), errno.EAFNOSUPPORT),
    "packets past the kernel": ((44, socket.SOCK_RAW, 0), errno.EAFNOSUPPORT),
}


def answer(machine: str, number: int, arguments: tuple[int, ...], architecture: int | None = None) -> int:
    """Return the error with which the filter of a machine ends a system call; 0 where it allows the call."""
    numbers = MACHINES[machine]
    architecture = numbers.architecture if architecture is None else architecture
    call = struct.pack("=IIQ6Q", number, architecture, 0, *(*arguments, *(0,) * (6 - len(arguments))))
    steps = list(struct.iter_unpack("=HBBI", program(numbers)))
    value, at = 0, 0
    while True:
        code, holds, fails, operand = steps[at]
        at += 1
        if code == 0x20:
            (value,) = struct.unpack_from("=I", call, operand)
        elif code == 0x54:
            value &= operand
        elif code == 0x06:
            return 0 if operand == ALLOW else operand ^ ERRNO
        else:
            at += (
                holds if {0x15: value == operand, 0x35: value >= operand, 0x45: bool(value & operand)}[code] else fails
            )


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(("arguments", "error"), SOCKETS.values(), ids=SOCKETS)
def test_the_filter_refuses_each_socket_that_goes_round_the_rules_of_ports(
    machine: str, arguments: tuple[int, ...], error: int
) -> None:
    assert answer(machine, MACHINES[machine].socket, arguments) == error


@pytest.mark.parametrize("machine", MACHINES)
def test_the_filter_refuses_calls_of_another_architecture(machine: str) -> None:
    assert answer(machine, 102, (), architecture=0x40000003) == errno.ENOSYS
    assert answer(machine, 0x40000000 | 41, SOCKETS["mptcp"][0]) == errno.ENOSYS
