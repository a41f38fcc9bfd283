"""The connection to a simulator: a ``linden serve`` of our own that ends with us, or a server at an address.

The benchmark knows two things of ``linden``: the command that starts it, and the line it prints when it is ready.
"""

from __future__ import annotations

import contextlib
import queue
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import deque
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import carla

from basu.agents.process.gate import Gates, Relay
from basu.errors import SimulatorError, UserError
from basu.home import replaced_home
from basu.parent_end import end_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import IO

    from basu.conditions import SimulatorSpec

GATE = '{"gate"'  # begins an answer of the gate
READY = re.compile(r"ready, rpc port (\d+)")
START_LIMIT_S = 600.0  # a first start compiles kernels, on a machine that may be busy with other things
END_LIMIT_S = 10.0
LAST_WORDS_S = 2.0  # for the pipes of an ended server to run empty
LAST_LINES = 20  # of a server's log, kept to explain its end
UPLOADED_NAME = "OpenDriveMap"  # CARLA's name of a map that a client sent
LONG_CALL_LIMIT_S = 300.0  # wall time of a map's load: Unreal meshes a town's roads in minutes; a busy machine is slow
UPLOAD_VERTEX_M, UPLOAD_PIECE_M, UPLOAD_BESIDE_M = 2.0, 50.0, 0.6  # CARLA's own defaults, PythonAPI/util/config.py


@dataclass(frozen=True, slots=True)
class Simulator:
    """A simulator that answers."""

    client: carla.Client
    address: tuple[str, int]
    own: bool
    why_gone: Callable[[], str | None]  # why it does not answer any more, in words; None while it does
    ended: Callable[[], bool]  # whether its process is seen to have ended; asks it nothing
    timeout_s: float = 20.0  # of wall time, for an answer of the simulator
    gates: Gates | None = None  # for agents in processes of their own; None: they connect to the simulator itself
    uploaded: str | None = None  # the town of the map that BASU sent; the simulator calls it by UPLOADED_NAME

    def long_call(self) -> contextlib.AbstractContextManager[None]:
        """Return a context in which calls may take as long as the load of a map on a busy machine."""
        return _longer_timeout(self.client, self.timeout_s)

    def map_name(self, town: str) -> str:
        """The name by which the simulator knows a town."""
        return UPLOADED_NAME if town == self.uploaded else town


@contextlib.contextmanager
def _longer_timeout(client: carla.Client, usual_s: float) -> Iterator[None]:
    """Let a client wait for ``LONG_CALL_LIMIT_S`` if its usual timeout is shorter."""
    client.set_timeout(max(usual_s, LONG_CALL_LIMIT_S))
    try:
        yield
    finally:
        client.set_timeout(usual_s)


@contextlib.contextmanager
def simulator_for(spec: SimulatorSpec) -> Iterator[Simulator]:
    """The simulator at --host, or one of our own that is ended in every case.

    Raises:
        UserError: no server answers at --host.
        SimulatorError: our own did not start.
    """
    if spec.host is not None:
        print(f"basu: connecting to the simulator at {spec.host}:{spec.port}", file=sys.stderr, flush=True)
        client = connect(spec.host, spec.port, spec.timeout_s)
        address = (spec.host, spec.port)
        town = None if spec.upload_map is None else upload(client, spec.upload_map, spec.timeout_s)
        relay = Relay([*linden_command(), "gate", "--host", spec.host, "--port", str(spec.port)])
        try:
            yield Simulator(
                client,
                address,
                own=False,
                why_gone=lambda: _silence(client, spec),
                ended=lambda: False,
                timeout_s=spec.timeout_s,
                gates=None if spec.is_open else Gates(relay),
                uploaded=town,
            )
        finally:
            relay.end()
        return
    server = _early.pop() if _early else own_server(spec)
    try:
        server.await_ready()
        client = connect("127.0.0.1", server.port, spec.timeout_s)
        yield Simulator(
            client,
            ("127.0.0.1", server.port),
            own=True,
            why_gone=server.gone,
            ended=server.ended,
            timeout_s=spec.timeout_s,
            gates=None if spec.is_open else Gates(server),
        )
    finally:
        server.end()


_early: list[OwnServer] = []  # at most one: a server that started ahead of its run


@contextlib.contextmanager
def started_early(spec: SimulatorSpec, workers: int = 1) -> Iterator[None]:
    """Start our own server, if the run needs one, while this process still imports; ``simulator_for`` takes it over."""
    if spec.host is None and workers == 1:
        _early.append(own_server(spec))
    try:
        yield
    finally:
        while _early:  # no run took it over: the run could not begin
            _early.pop().end()


def own_server(spec: SimulatorSpec) -> OwnServer:
    """Start a server of our own, which need not be ready yet."""
    return OwnServer(spec.recordings, spec.maps, gates=not spec.is_open, wait=False)


def _silence(client: carla.Client, spec: SimulatorSpec) -> str | None:
    """Check that a simulator of another owner still answers."""
    try:
        client.get_server_version()
    except RuntimeError:
        return f"the simulator at {spec.host}:{spec.port} does not answer any more"
    return None


class OwnServer:
    """A ``linden serve`` of our own, on ports that the system chose, still until the first tick."""

    def __init__(
        self, recordings: Path | None = None, maps: Sequence[Path] = (), *, gates: bool = False, wait: bool = True
    ) -> None:
        """Start it, and wait for its ready line unless ``wait`` is false.

        With ``gates`` it accepts connections of this process and, behind a gate, of an agent's, and no others.

        It may write logs below the folder ``recordings``, and offers each .xodr file of the folders ``maps``.

        Raises:
            SimulatorError: it ended, or was not ready in time.
        """
        command = [*linden_command(), "serve", "--port", "0", "--sync"]
        if recordings is not None:
            command += ["--recordings", str(recordings.resolve())]
        command += ["--gates"] if gates else []
        command += [word for folder in maps for word in ("--maps", str(folder.resolve()))]
        self._process = subprocess.Popen(  # noqa: S603 - our own command, arguments of our own
            command,
            stdin=subprocess.PIPE if gates else subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,  # Ctrl-C is for us; we end the server when the run is written
            preexec_fn=partial(end_with_parent, signal.SIGTERM),  # noqa: PLW1509 - one prctl call, no lock
        )
        self._port: int | None = None
        self._spoke = threading.Event()
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()  # of the gate
        self._log: deque[str] = deque(maxlen=LAST_LINES)
        self._readers = [
            threading.Thread(target=self._read, args=(stream,), name="basu-server-log", daemon=True)
            for stream in (self._process.stdout, self._process.stderr)
        ]
        for reader in self._readers:
            reader.start()
        if wait:
            self.await_ready()

    def await_ready(self) -> None:
        """Wait for its ready line; end it where there is none.

        Raises:
            SimulatorError: it ended, or was not ready in time.
        """
        try:
            self.port = self._wait_until_ready()
        except BaseException:
            self.end()
            raise

    @property
    def pid(self) -> int:
        """The number of its process."""
        return self._process.pid

    def send_order(self, line: str) -> None:
        """Send an order for the gate.

        Raises:
            OSError: the server has ended.
        """
        assert self._process.stdin is not None, "it was started with gates"
        self._process.stdin.write(line)
        self._process.stdin.flush()

    def answer(self) -> str:
        """Return the next answer of the gate; empty where the server has ended."""
        return self._answers.get()

    def ended(self) -> bool:
        """Whether it runs no more; costs a microsecond."""
        return self._process.poll() is not None

    def gone(self) -> str | None:
        """Why it is gone, in words; None while it runs."""
        code = self._process.poll()
        if code is None:
            return None
        for reader in self._readers:
            reader.join(LAST_WORDS_S)
        last = f": {self._log[-1]}" if self._log else ""
        if code >= 0:
            return f"the simulator ended by itself (exit status {code}){last}"
        name = signal.Signals(-code).name
        because = " (as the system does when memory runs out)" if -code == signal.SIGKILL else ""
        return f"the simulator was ended by the signal {name}{because}{last}"

    def end(self) -> None:
        """End it; in good order if it lets us."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)
            try:
                self._process.wait(END_LIMIT_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        for reader in self._readers:  # each closes its pipe
            reader.join(LAST_WORDS_S)

    def _wait_until_ready(self) -> int:
        deadline = time.monotonic() + START_LIMIT_S
        while self._port is None:
            if (reason := self.gone()) is not None:
                raise SimulatorError(reason)
            if time.monotonic() > deadline:
                raise SimulatorError(f"the simulator was not ready within {START_LIMIT_S:.0f} s")
            self._spoke.wait(0.05)
            self._spoke.clear()
        return self._port

    def _read(self, stream: IO[str] | None) -> None:
        """Take what the server says until it ends: its port, its progress, its last words."""
        assert stream is not None, "both streams are pipes"
        with stream:
            for line in stream:
                text = line.rstrip()
                if text.startswith(GATE):
                    self._answers.put(text)
                    continue
                if (found := READY.search(text)) is not None:
                    self._port = int(found.group(1))
                else:
                    self._log.append(text)
                    if self._port is None:
                        print(text, file=sys.stderr, flush=True)  # a first start says what it is doing
                self._spoke.set()
        self._spoke.set()
        self._answers.put("")  # it speaks no more


def upload(client: carla.Client, file: Path, timeout_s: float) -> str:
    """Send an OpenDRIVE map, let the simulator make a world of it, and return the town: the file's name.

    The world has roads without walls beside them, no houses, and the lights and signs of the map.

    Raises:
        UserError: the file cannot be read, or is no OpenDRIVE.
        SimulatorError: the simulator makes no world of it.
    """
    try:
        text = file.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"--upload-map {file} cannot be read: {error}; name an OpenDRIVE file") from None
    if "<OpenDRIVE" not in text:
        raise UserError(f"--upload-map {file} is no OpenDRIVE; `linden map build -o Linden.xodr` writes Linden's")
    print(f"basu: sending {file} to the simulator", file=sys.stderr, flush=True)
    shape = carla.OpendriveGenerationParameters(
        vertex_distance=UPLOAD_VERTEX_M,
        max_road_length=UPLOAD_PIECE_M,
        wall_height=0.0,
        additional_width=UPLOAD_BESIDE_M,
        smooth_junctions=True,
        enable_mesh_visibility=True,
    )
    try:
        with _longer_timeout(client, timeout_s):
            client.generate_opendrive_world(text, shape)
    except RuntimeError as error:
        raise SimulatorError(f"the simulator made no world of {file}: {reason(error)}") from error
    return file.stem


def reason(error: RuntimeError) -> str:
    """Return the text of an error of CARLA's client; if the error is a timeout, with the option that extends it."""
    text = str(error)
    return f"{text}; if the machine is busy, wait longer with --timeout S" if "time-out" in text else text


def linden_command() -> list[str]:
    """How to start ``linden`` in this environment."""
    beside = Path(sys.executable).with_name("linden")
    if beside.is_file():
        return [str(beside)]
    found = shutil.which("linden")
    return [found] if found is not None else [sys.executable, "-m", "linden.cli"]


def connect(host: str, port: int, timeout_s: float) -> carla.Client:
    """A client that has been answered.

    A port that nothing listens at is refused at once: CARLA's client would ask it for the whole time-out.

    Raises:
        UserError: no server answers there.
    """
    try:
        socket.create_connection((host, port), timeout_s).close()
    except OSError as error:
        raise UserError(
            f"no simulator answers at {host}:{port}; start one with `linden serve`, or leave out --host ({error})"
        ) from error
    try:
        client = carla.Client(host, port)
        home = replaced_home()
        if home is not None:
            client.set_files_base_folder(str(home))
        client.set_timeout(timeout_s)
        client.get_server_version()
    except RuntimeError as error:
        raise UserError(
            f"no simulator answers at {host}:{port}; start one with `linden serve`, or leave out --host ({error})"
        ) from error
    return client
