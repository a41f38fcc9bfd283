"""The process of agents, from the benchmark's side: start, calls within limits, and end of a hanging process."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.agents.process.channel import POLL_S, BenchmarksEnd, ChannelClosedError
from basu.agents.process.endings import Ending, ended_how, ended_outside, oom_kills
from basu.agents.process.keeper import END_LIMIT_S, ProcessLimits

if TYPE_CHECKING:
    from collections.abc import Callable

GRACE_S = 0.25  # beyond a limit for the process to end the call by itself, with the line in which it was
START_LIMIT_S = 60.0  # for Python and CARLA's client to be there, on a machine that is busy with other things
PENDING_S = 1.0  # for a call to end that was left when the user interrupted the run
KEEPER = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from basu.agents.process.keeper import main; main()"
FOLDER = "BASU_AGENT_FOLDER"  # the variable that tells an agent where it may write
ALSO_WRITABLE: tuple[str, ...] = ()  # for tests, which measure the coverage of the process
HASH_SEED = "0"  # the order of a set of texts is part of what an agent does: the same in each process
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
GB = 1e9


class Death(Exception):  # noqa: N818 - it becomes an error of the agent
    """The process is gone or useless; the text is a half sentence that says what happened to it."""

    def __init__(self, sentence: str, *, from_outside: bool = False) -> None:
        """``from_outside`` says that the kernel ended it for want of memory that others use."""
        super().__init__(sentence)
        self.from_outside = from_outside


class OverLimitError(Exception):
    """A call did not end in time, and the process was killed."""


class CallError(Exception):
    """What a call in the process raised: the kind of error, its sentence, and the traceback there."""

    def __init__(self, kind: str, sentence: str, trace: str) -> None:
        super().__init__(sentence)
        self.kind, self.sentence, self.trace = kind, sentence, trace


class Memory(NamedTuple):
    """What a process may use."""

    limit_gb: float

    def excess(self, pid: int) -> str | None:
        """Half a sentence where the process and all that it started use more; None otherwise."""
        used_gb = sum(map(_resident_bytes, _tree(pid))) / GB
        if used_gb <= self.limit_gb:
            return None
        return f"it used {used_gb:.2f} GB of memory, more than its limit of {self.limit_gb:g} GB"


class ProcessBounds(NamedTuple):
    """The bounds that a drive sets to a process."""

    memory: Memory | None = None
    writable: tuple[str, ...] = ()  # folders in which it may write beside its own
    closed_ports: tuple[int, ...] = ()  # of TCP: it may neither connect to them nor listen there
    hidden: tuple[str, ...] = ()  # folders in which it sees nothing, where the kernel allows it


class AgentProcess:
    """One process with its keeper (`basu.agents.process.keeper`), in a session of its own: Ctrl-C does not reach it."""

    def __init__(self, bounds: ProcessBounds) -> None:
        """Start the process; no call is sent yet. Hidden folders that are not there yet are made."""
        ours, theirs = socket.socketpair()
        self._control, kept = socket.socketpair()
        self._folder = Path(tempfile.mkdtemp(prefix="basu-agent-"))
        self._ooms = oom_kills()
        self._made_folders = [Path(each) for each in bounds.hidden if not Path(each).exists()]
        for made in self._made_folders:
            made.mkdir(parents=True, exist_ok=True)
        may_write = [str(self._folder), *bounds.writable, *ALSO_WRITABLE]
        limits = ProcessLimits(may_write, list(bounds.closed_ports), list(bounds.hidden))
        arguments = [json.dumps(sys.path), str(theirs.fileno()), str(kept.fileno()), json.dumps(limits)]
        with theirs, kept:
            self._process = subprocess.Popen(  # noqa: S603 - our own command
                [sys.executable, "-c", KEEPER, *arguments],
                stdin=subprocess.DEVNULL,
                pass_fds=[theirs.fileno(), kept.fileno()],
                start_new_session=True,
                env={**os.environ, **_own_places(self._folder)},
            )
        self._life = _life_of(self._process.pid)
        self._channel = BenchmarksEnd(ours, self._life)
        self._memory = bounds.memory
        self._look_again_s = 0.0
        self._number = 0
        self._begin_limit_s = START_LIMIT_S  # of the call that was sent last
        self._is_pending = False
        self._own_kill = False
        self.confinement: tuple[str, ...] | None = None  # the parts that hold here; None until it has said so
        _running.add(self)

    @property
    def pid(self) -> int:
        """The identifier of the keeper."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it can take calls."""
        return self._process.poll() is None and not self._own_kill

    def call(self, operation: str, argument: Any, *, limit_s: float, begin_limit_s: float = START_LIMIT_S) -> Any:  # noqa: ANN401
        """What an operation in the process returns.

        Args:
            operation: a method of the process's :class:`basu.agents.process.child.Child`.
            argument: its argument, anything that can be pickled.
            limit_s: wall time for the agent's part, from the moment the process says that it begins with it.
            begin_limit_s: wall time until then.

        Raises:
            Death: the process is gone.
            OverLimitError: the agent's part took longer; the process was killed.
            CallError: the operation raised.
        """
        self.send(operation, argument, begin_limit_s=begin_limit_s)
        return self.answer(limit_s=limit_s)

    def send(self, operation: str, argument: Any, *, begin_limit_s: float = START_LIMIT_S) -> None:  # noqa: ANN401
        """Send a call. ``answer`` waits for its result; meanwhile other processes can be sent their calls.

        Raises:
            Death: the process is gone, or takes no call.
        """
        if self._process.poll() is not None:
            raise self._dead()
        if operation == "make":
            self._begin_run()
        self._begin_limit_s = PENDING_S if self._is_pending else begin_limit_s
        self._number += 1
        self._is_pending = True
        try:
            if not self._channel.send((self._number, operation, argument), time.monotonic() + self._begin_limit_s):
                raise self._hung(self._begin_limit_s)
        except (ChannelClosedError, LookupError, TypeError, ValueError) as error:
            raise self._dead() from error

    def answer(self, *, limit_s: float) -> Any:  # noqa: ANN401 - as the operation has it
        """Return what the call that was sent last returns; its limits begin no earlier than now.

        Raises:
            Death, OverLimitError, CallError: as ``call``.
        """
        try:
            return self._awaited(self._begin_limit_s, limit_s)
        except (ChannelClosedError, LookupError, TypeError, ValueError) as error:
            raise self._dead() from error

    def _awaited(self, begin_limit_s: float, limit_s: float) -> Any:  # noqa: ANN401 - as the operation has it
        """What the operation that was sent returns.

        Raises:
            Death, OverLimitError, CallError: as ``call``.
            ChannelClosedError, LookupError, TypeError, ValueError: the answer is none.
        """
        deadline_s, has_begun = time.monotonic() + begin_limit_s, False
        while True:
            answer = self._message(deadline_s)
            if answer is None:
                if has_begun:
                    self.kill()
                    raise OverLimitError
                raise self._hung(begin_limit_s)
            if answer[0] != self._number:
                continue  # of a call that was interrupted
            if answer[1] == "begun" and not has_begun:
                has_begun, deadline_s = True, time.monotonic() + limit_s + GRACE_S
                continue
            self._is_pending = False
            return _result(answer)

    def kill(self) -> None:
        """End the process and all that it started, at once; what it has written in its own folder goes too."""
        if self._own_kill:
            return
        self._own_kill = True
        _running.discard(self)
        self._control.close()  # at which the keeper ends everything, and itself
        try:
            self._process.wait(END_LIMIT_S + PENDING_S)
        except subprocess.TimeoutExpired:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(PENDING_S)
        self._channel.close()
        if self._life is not None:
            os.close(self._life)
        shutil.rmtree(self._folder, ignore_errors=True)
        for made in self._made_folders:
            with contextlib.suppress(OSError):
                made.rmdir()  # where no drive has written into it

    def end_unused(self) -> None:
        """End the process if no drive has written into a folder that was made for it, and remove that folder."""
        if any(made.is_dir() and not any(made.iterdir()) for made in self._made_folders):
            self.kill()

    def _begin_run(self) -> None:
        """Let the keeper count the output of a new run."""
        with contextlib.suppress(OSError):
            self._control.send(b"n")

    def _message(self, deadline_s: float) -> list[Any] | None:
        """The next message, None after the deadline.

        Raises:
            Death: the process ended, or used too much memory.
            ChannelClosedError: it closed its end.
        """
        watched = self._memory is not None or self._life is None
        while True:
            until_s = min(deadline_s, time.monotonic() + POLL_S) if watched else deadline_s
            answer = self._channel.receive(until_s)
            self._check_memory()
            if answer is not None and self.confinement is None:
                self.confinement = tuple(map(str, answer[1]))  # the first message, before any code of the agent's
            elif answer is not None:
                # a process that sends without end answers nothing
                return answer if time.monotonic() < deadline_s + GRACE_S else None
            elif self._process.poll() is not None:
                last = self._channel.receive(0.0)  # what it said before it ended
                if last is not None:
                    return last
                raise self._dead()
            if time.monotonic() >= deadline_s:
                return None

    def _check_memory(self) -> None:
        """End a process that uses too much.

        Raises:
            Death: it did.
        """
        if self._memory is None or time.monotonic() < self._look_again_s or self._process.poll() is not None:
            return
        self._look_again_s = time.monotonic() + POLL_S
        excess = self._memory.excess(self._process.pid)
        if excess is not None:
            self.kill()
            raise Death(excess)

    def _hung(self, limit_s: float) -> Death:
        """The process is there and does not answer."""
        self.kill()
        return Death(f"its process did not answer within {limit_s:g} s, so it was ended")

    def _dead(self) -> Death:
        """What became of the process, which has ended or closed its end."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(PENDING_S)
        ending = self._ending()
        self.kill()
        if ending is None:
            return Death("its process broke off its connection")
        outside = ended_outside(ending, oom_kills() - self._ooms)
        return Death(ended_how(ending), from_outside=outside)

    def _ending(self) -> Ending | None:
        """How the process ended: as its keeper says, or as the keeper itself ended; None while it lives."""
        if self._process.poll() is None:
            return None
        self._control.setblocking(False)
        with contextlib.suppress(OSError, ValueError, TypeError):
            status, peak_kb = json.loads(self._control.recv(1 << 12))
            return Ending(os.waitstatus_to_exitcode(status), peak_kb * 1024)
        return Ending(self._process.returncode, 0)


def _own_places(folder: Path) -> dict[str, str]:
    """The variables by which programs find where they may write, and the seed of hashes."""
    places = {
        FOLDER: folder / "files",
        "TMPDIR": folder / "tmp",
        "NUMBA_CACHE_DIR": folder / "cache" / "numba",  # numba refuses to compile where it cannot write
        "TRITON_CACHE_DIR": folder / "cache" / "triton",
        "ROS_LOG_DIR": folder / "ros",
    }
    for place in places.values():
        place.mkdir(parents=True)
    return {"PYTHONHASHSEED": HASH_SEED, **{name: str(place) for name, place in places.items()}}


def _result(answer: list[Any]) -> Any:  # noqa: ANN401 - as the operation has it
    """The value of an answer.

    Raises:
        CallError: the operation raised.
    """
    if answer[1] == "done":
        return answer[2]
    kind, sentence, trace = map(str, answer[2:5])
    raise CallError(kind, sentence, trace)


def _life_of(pid: int) -> int | None:
    """A descriptor that turns readable when the process ends, whatever its own children hold open (Linux)."""
    opened: Callable[[int], int] | None = getattr(os, "pidfd_open", None)
    try:
        return None if opened is None else opened(pid)
    except OSError:
        return None


def _tree(root: int) -> list[int]:
    """A process and its descendants: what leaves the group of an agent's process stays below its keeper."""
    below: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, IndexError):
            # the name of the program stands in brackets and may hold anything; state and parent follow
            parent = int(stat.read_text().rpartition(")")[2].split()[1])
            below.setdefault(parent, []).append(int(stat.parent.name))
    found = [root]
    for pid in found:
        found += below.get(pid, [])
    return found


def _resident_bytes(pid: int) -> int:
    """How much memory a process holds; 0 where it is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE_BYTES
    except (OSError, IndexError):
        return 0


_running: set[AgentProcess] = set()


def end_unused() -> None:
    """Let a command that ended before its first drive leave no empty folder of results."""
    for process in list(_running):
        process.end_unused()


@atexit.register
def _kill_all() -> None:
    """Kill all agents' processes when the benchmark ends."""
    for process in list(_running):
        process.kill()
