"""The keeper of an agent's process: starts it confined, passes a bounded part of its output on, ends all it started.

The benchmark starts the keeper, which forks the agent's process before the agent's code is loaded. With namespaces of
Linux a first process stands between both: when it ends, the kernel ends every process of the namespace. Without them
the keeper inherits the agent's orphans (``PR_SET_CHILD_SUBREAPER``) and ends them one by one.

The keeper ends when the agent's process does, or when the benchmark closes its end of the control socket. Imports here
are those of the standard library alone: the keeper takes little memory and no time.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import select
import signal
import socket
import sys
import time
from pathlib import Path
from typing import NamedTuple, NoReturn

from basu.agents.process import confinement, namespaces
from basu.parent_end import end_with_parent, prctl

PR_SET_CHILD_SUBREAPER = 36
OUTPUT_BYTES = 1 << 20
"""What a run's agent may write to each of its two outputs; what exceeds it is thrown away."""
CHUNK_BYTES = 1 << 16
CONTROLS = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]|\xc2[\x80-\x9f]")
"""Control characters, with which an agent could write over what the benchmark prints; lines and tabs are none."""
HALF_CONTROL = b"\xc2"
"""The first byte of a control character of two; the second may come in another part."""
END_LIMIT_S = 2.0  # for killed processes to be gone
LEFT_OUT = (
    f"\nbasu: the agent wrote more than {OUTPUT_BYTES >> 20} MB in this run; the rest of its output is left out\n"
)


class ProcessLimits(NamedTuple):
    """What the agent's process may do beside its usual rights, and what it may not."""

    writable: list[str]  # folders
    closed_ports: list[int]  # of TCP, at any address
    hidden: list[str]  # folders in which it sees nothing, where namespaces are allowed


class Ended(NamedTuple):
    """The end of an agent's process, as the kernel has it."""

    status: int  # of wait(2)
    peak_kb: int  # the most memory that one of its processes held, or all that were killed together


def main() -> None:
    """Keep an agent's process: arguments are the descriptors of channel and control, and the limits."""
    channel, control = int(sys.argv[2]), int(sys.argv[3])
    limits = ProcessLimits(*json.loads(sys.argv[4]))
    sys.argv[:] = ["basu-agent"]  # the rest is not for the agent
    os.set_inheritable(channel, False)
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    has_namespaces = namespaces.enter()
    outputs = [os.pipe(), os.pipe()]
    ended_read, ended_write = os.pipe()
    keeper = os.getpid()
    pid = os.fork()
    if pid != 0:
        for _, write in (*outputs, (0, ended_write)):
            os.close(write)
        os.close(channel)
        _keep(pid, control, [read for read, _ in outputs], ended_read if has_namespaces else None)
    end_with_parent()
    for read, _ in (*outputs, (ended_read, 0)):
        os.close(read)
    os.close(control)
    held = [confinement.PROCESSES] if has_namespaces else []
    if has_namespaces:
        if namespaces.forget(limits.writable):  # before folders are mounted that stay writable
            held.append(confinement.MEMORY)
        if namespaces.mount_processes():
            held.append(confinement.SIGHT)
        if limits.hidden and namespaces.hide(limits.hidden):
            held.append(confinement.RESULTS)
        namespaces.number_next_process(keeper)
        agent = os.fork()
        if agent != 0:
            for descriptor in (channel, outputs[0][1], outputs[1][1]):
                os.close(descriptor)
            _be_first(agent, ended_write)
        end_with_parent()
    os.close(ended_write)
    _become_agent(channel, [write for _, write in outputs], limits, held)


def _become_agent(channel: int, outputs: list[int], limits: ProcessLimits, held: list[str]) -> None:
    """Go on as the agent's process, confined."""
    os.setsid()
    for descriptor, own in zip(outputs, (1, 2), strict=True):
        os.dup2(descriptor, own)
        os.close(descriptor)
    if held:
        namespaces.drop_capabilities()
    held += confinement.confine(
        limits.writable, sees_own_processes=confinement.SIGHT in held, closed_ports=limits.closed_ports
    )
    from basu.agents.process.child import serve  # noqa: PLC0415 - carla and numpy, which the keeper does without

    serve(channel, held)


class _PeakMemory:
    """The most memory that an agent held: the peak of one process, or the sum of the processes that SIGKILL ended.

    Processes that live at the end are ended so, and a process that the kernel ends for want of memory.
    """

    def __init__(self) -> None:
        self._largest_kb = self._killed_kb = 0

    def add(self, status: int, peak_kb: int) -> None:
        """Add a process that has ended: its status as wait(2) has it, and the most that it held."""
        self._largest_kb = max(self._largest_kb, peak_kb)
        if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL:
            self._killed_kb += peak_kb

    @property
    def peak_kb(self) -> int:
        """The larger of both."""
        return max(self._largest_kb, self._killed_kb)


# -- the first process of a namespace


def _be_first(agent: int, ended: int) -> NoReturn:
    """Reap every process of the namespace until the agent's has ended; the rest ends with this process."""
    signal.signal(signal.SIGTERM, lambda *_: os.kill(agent, signal.SIGTERM))
    end, memory = None, _PeakMemory()
    while end is None:
        pid, status, usage = os.wait4(-1, 0)
        memory.add(status, usage.ru_maxrss)
        if pid == agent:
            end = status
    with contextlib.suppress(OSError):
        os.kill(-1, signal.SIGKILL)
        while True:
            _, status, usage = os.wait4(-1, 0)
            memory.add(status, usage.ru_maxrss)
    os.write(ended, json.dumps(Ended(end, memory.peak_kb)).encode())
    os._exit(0)


# -- the keeper


def _keep(child: int, control: int, outputs: list[int], ended: int | None) -> NoReturn:
    """Pass output on until the child has ended or the benchmark lets go; then end the rest and report."""
    signal.signal(signal.SIGTERM, lambda *_: os.kill(child, signal.SIGTERM))
    end = None
    try:
        end = _watch(child, socket.socket(fileno=os.dup(control)), _Outputs(outputs))
    finally:
        end = _end_all(child, end, has_orphans=ended is None)
    if ended is not None:
        os.set_blocking(ended, False)
        with contextlib.suppress(OSError, ValueError):
            end = Ended(*json.loads(os.read(ended, CHUNK_BYTES)))
    if end is not None:
        with contextlib.suppress(OSError):
            os.write(control, json.dumps(end).encode())
    os._exit(0)


def _watch(child: int, control: socket.socket, outputs: _Outputs) -> Ended | None:
    """Pass output on until the child has ended; None where the benchmark lets go before."""
    woken, waker = os.pipe()
    for descriptor in (woken, waker):
        os.set_blocking(descriptor, False)
    signal.set_wakeup_fd(waker, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    poll = select.poll()
    for descriptor in (woken, control.fileno(), *outputs.open):
        poll.register(descriptor, select.POLLIN)
    while True:
        end = _reaped(child)
        if end is not None:
            outputs.drain()
            return end
        for descriptor, _ in poll.poll():
            if descriptor == woken:
                with contextlib.suppress(BlockingIOError):
                    os.read(woken, CHUNK_BYTES)
            elif descriptor == control.fileno():
                if not control.recv(CHUNK_BYTES):
                    outputs.drain()
                    return None
                outputs.begin()
            elif not outputs.pass_on(descriptor):
                poll.unregister(descriptor)


class _Outputs:
    """The agent's standard output and standard error on their way to the keeper's, bounded for each run."""

    def __init__(self, descriptors: list[int]) -> None:
        self.open = dict(zip(descriptors, (1, 2), strict=True))
        self._left = dict.fromkeys(descriptors, OUTPUT_BYTES)
        self._held = dict.fromkeys(descriptors, b"")  # half a character, until the other half has come
        self._has_begun = False
        for descriptor in descriptors:
            os.set_blocking(descriptor, False)

    def begin(self) -> None:
        """Begin a run: its output is counted anew. What the run before has written is passed on first.

        What the process wrote before the keeper learned of the first run belongs to the first run.
        """
        if self._has_begun:
            self.drain()
            self._left = dict.fromkeys(self._left, OUTPUT_BYTES)
        self._has_begun = True

    def drain(self) -> None:
        """Pass on what lies in the pipes, and no more than they hold."""
        for descriptor in list(self.open):
            for _ in range(OUTPUT_BYTES // CHUNK_BYTES):
                if not select.select([descriptor], [], [], 0.0)[0] or not self.pass_on(descriptor):
                    break

    def pass_on(self, descriptor: int) -> bool:
        """Pass a part on; False at its end."""
        try:
            part = os.read(descriptor, CHUNK_BYTES)
        except BlockingIOError:
            return True
        if not part:
            self.open.pop(descriptor, None)
            return False
        left = self._left[descriptor]
        if left >= 0:
            text = self._held[descriptor] + part[:left]
            self._held[descriptor] = text[-1:] if text.endswith(HALF_CONTROL) else b""
            _write(self.open[descriptor], CONTROLS.sub(b"?", text.removesuffix(self._held[descriptor])))
            self._left[descriptor] = max(-1, left - len(part))
            if len(part) > left:
                _write(2, LEFT_OUT.encode())
        return True


def _write(descriptor: int, data: bytes) -> None:
    """Write all of it; where nothing takes it, it is lost."""
    with contextlib.suppress(OSError):
        while data:
            data = data[os.write(descriptor, data) :]


def _reaped(child: int) -> Ended | None:
    """The end of the child, once it is there; orphans that ended are reaped as well."""
    with contextlib.suppress(ChildProcessError):
        while True:
            pid, status, usage = os.wait4(-1, os.WNOHANG)
            if pid == 0:
                return None
            if pid == child:
                return Ended(status, usage.ru_maxrss)
    return None


def _end_all(child: int, end: Ended | None, *, has_orphans: bool) -> Ended | None:
    """Kill the child, and the keeper's other children, until there are none; return the end with the memory of all.

    Args:
        child: the keeper's own child.
        end: its end, if it has ended.
        has_orphans: whether orphans of the agent's process become children of the keeper. In a namespace of processes
            they become children of its first process and end with it. The keeper then shares the mounts of that
            namespace, so ``/proc`` gives identifiers that belong to other processes outside it.
    """
    memory = _PeakMemory()
    if end is not None:
        memory.add(end.status, end.peak_kb)
    deadline_s = time.monotonic() + END_LIMIT_S
    while time.monotonic() < deadline_s:
        for pid in _children() if has_orphans else [child] if end is None else []:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        try:
            pid, status, usage = os.wait4(-1, os.WNOHANG)
        except ChildProcessError:
            break
        if pid == 0:
            time.sleep(0.001)
            continue
        memory.add(status, usage.ru_maxrss)
        if pid == child:
            end = Ended(status, usage.ru_maxrss)
    return None if end is None else end._replace(peak_kb=memory.peak_kb)


def _children() -> list[int]:
    """The children of this process, which must be in the namespace of processes that ``/proc`` shows."""
    own, found = os.getpid(), []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, IndexError):
            if int(stat.read_text().rpartition(")")[2].split()[1]) == own:
                found.append(int(stat.parent.name))
    return found
