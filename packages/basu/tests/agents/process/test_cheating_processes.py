"""Claims about agents that attack with their process: each such drive is the agent's failure, and leaves nothing."""

import contextlib
import os
import re
import socket
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from basu.agents.process import agent_process, confinement
from basu.agents.process.endings import Ending, ended_how, ended_outside, memory_bytes
from basu.agents.process.gate import closed_ports
from basu.agents.process.keeper import _Outputs
from basu.agents.process.remote_agent import AgentInProcess, RemoteAgent, find_agent
from basu.errors import AgentCrashedError, AgentInvalidControlError, AgentTimedOutError
from basu.traffic_ports import TRAFFIC_PORTS, free_traffic_port

AGENT = """
import json, os, resource, signal, socket, struct, subprocess, sys, threading, time
from pathlib import Path

CHANNEL = next(
    int(fd.name) for fd in Path("/proc/self/fd").iterdir()
    if int(fd.name) > 2 and fd.is_symlink() and os.readlink(fd).startswith("socket:")
)

def send(data):
    os.write(CHANNEL, struct.pack("<I", len(data)) + data)

def child(name):
    import basu.agents.process.child as module
    return getattr(module, name)

class Own(carla.VehicleControl):
    @property
    def throttle(self):
        return 10**400

class Cheat(AutonomousAgent):
    def setup(self): pass
    def run_step(self, sensor_data): return carla.VehicleControl()
    def get_initial_route_locations(self):
        DEED
        return [(1, 2, 3)]
    def config(self):
        return {"vehicle": "a"}
    def destroy(self): pass
"""
DEEDS = {
    "deep message": ("send(b'[' * 1_000_000); time.sleep(60)", "broke off its connection"),
    "endless messages": ("[send(b'[-1]') for _ in iter(int, 1)]", "took longer than its limit"),
    "broken answer": ("send(b'[3, \"failed\"]'); time.sleep(60)", "broke off its connection"),
    "unknown kind": ('send(b\'[3, "failed", "benchmark", "not me", ""]\'); time.sleep(60)', "failed: not me"),
    "blames the simulator": (
        'send(b\'[3, "failed", "simulator", "it is gone", ""]\'); time.sleep(60)',
        "failed: it is gone",
    ),
    "blames the set-up": ('send(b\'[3, "failed", "user", "wrong map", ""]\'); time.sleep(60)', "wrong map"),
    "no list of points": ("send(b'[3, \"done\", [[1, 2], 3]]'); time.sleep(60)", "gave no usable answer"),
    "unnamed signal": ("os.kill(os.getpid(), 40)", r"ended by the signal number 40"),
    "steers the terminal": (r"raise ValueError('\x1b[2J\x1b[Hpassed')", "ValueError: \ufffd.2J\ufffd.Hpassed"),
    "kills itself": ("os.kill(os.getpid(), signal.SIGKILL)", r"ended by the signal SIGKILL"),
    "simulator error": (
        "from basu.errors import SimulatorError; raise SimulatorError('the simulator ended')",
        "the simulator ended",
    ),
}


def found(folder: Path, deed: str, **options: object) -> AgentInProcess:
    path = folder / "cheat.py"
    path.write_text(AGENT.replace("DEED", deed))
    agent = find_agent(str(path), **options)  # type: ignore[arg-type]
    assert isinstance(agent, AgentInProcess)
    return agent


def cheat(folder: Path, deed: str, **options: object) -> RemoteAgent:
    return RemoteAgent(found(folder, deed, **options), 10.0, 0)


@pytest.mark.parametrize(("deed", "sentence"), DEEDS.values(), ids=DEEDS)
def test_whatever_comes_from_the_process_is_the_agents_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, deed: str, sentence: str
) -> None:
    monkeypatch.setattr("basu.agents.process.remote_agent.SETUP_LIMIT_S", 1.0)
    remote = cheat(tmp_path, deed)
    remote._setup_limit_s = 1.0
    with pytest.raises((AgentCrashedError, AgentTimedOutError), match=sentence):
        remote.own_route()
    remote._process.kill()


@pytest.mark.parametrize("answer", ["Own()", "None", "carla.VehicleControl(throttle=float('nan'))"])
def test_a_control_that_is_none_is_the_agents_failure(tmp_path: Path, answer: str) -> None:
    text = f"child('Child').step = lambda self, _: [*[10**400] * 3, 0, 0, 0, 0, False]; self.other = {answer}"
    remote = cheat(tmp_path, text)
    remote.own_route()
    remote._hears = True
    remote.ask(1, {})
    with pytest.raises(AgentInvalidControlError, match=r"no control: int too large"):
        remote.answer()


NEEDS_FILES = pytest.mark.skipif(confinement.landlock_abi() == 0, reason="this kernel has no Landlock (Linux 5.13)")
NEEDS_SPACES = pytest.mark.skipif(
    subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; from basu.agents.process import namespaces; sys.exit(not namespaces.enter())",
        ],
        check=False,
    ).returncode
    != 0,
    reason="this system allows no namespaces of users",
)


@NEEDS_FILES
@pytest.mark.parametrize(
    "deed",
    ["Path({file!r}).write_text('')", "Path({file!r}).unlink()", "os.rename({file!r}, {file!r} + 'x')",
     "os.truncate({file!r}, 0)", "os.mkdir({file!r} + 'd')", "subprocess.run(['rm', {file!r}], check=True)"],
)  # fmt: skip
def test_an_agent_writes_nothing_but_its_own_folder(tmp_path: Path, deed: str) -> None:
    earlier = tmp_path / "result.json"
    earlier.write_text("{}")
    with pytest.raises(AgentCrashedError, match=r"PermissionError|Read-only file system|CalledProcessError"):
        cheat(tmp_path, deed.format(file=str(earlier))).own_route()
    assert earlier.read_text() == "{}"


@NEEDS_FILES
def test_ordinary_places_to_write_are_there_and_a_folder_may_be_given(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    deed = (
        "import tempfile; tempfile.TemporaryFile().write(b'1'); open('/dev/null', 'w').write('1'); "
        "Path(os.environ['BASU_AGENT_FOLDER'], 'a.txt').write_text('1'); "
        "Path(os.environ['NUMBA_CACHE_DIR'], 'a').mkdir(); "
        "__import__('multiprocessing').Lock(); "
        f"Path({str(tmp_path / 'mine' / 'kept.txt')!r}).write_text('1')"
    )
    remote = cheat(tmp_path, deed, writes=(str(tmp_path / "mine"),))
    assert remote.own_route()
    assert (tmp_path / "mine" / "kept.txt").read_text() == "1"
    own = remote._process._folder
    assert (own / "files" / "a.txt").exists()
    remote._process.kill()
    assert not own.exists()


ORPHAN = (
    "os.fork() or (os.setsid(), os.fork() and os._exit(0), signal.signal(signal.SIGTERM, signal.SIG_IGN), "
    "Path(os.environ['BASU_AGENT_FOLDER'], 'orphan').write_text('1'), time.sleep(3600)); "
    "os.wait(); \n        while not Path(os.environ['BASU_AGENT_FOLDER'], 'orphan').exists(): time.sleep(0.001)"
)


@pytest.mark.parametrize("spaces", [pytest.param(True, marks=NEEDS_SPACES), False], ids=["namespaces", "none"])
@pytest.mark.parametrize("end", ["", "os._exit(3)"], ids=["ended", "ends itself"])
def test_an_orphan_in_a_session_of_its_own_ends_with_the_agent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: str, *, spaces: bool
) -> None:
    if not spaces:
        start = agent_process.KEEPER.replace(
            "from basu.agents.process.keeper", "import basu.agents.process.namespaces as n; n.enter = lambda: False; "
            "from basu.agents.process.keeper"
        )  # fmt: skip
        monkeypatch.setattr(agent_process, "KEEPER", start)
    remote = cheat(tmp_path, f"{ORPHAN}\n        {end or 'pass'}")
    keeper = psutil.Process(remote._process._process.pid)
    below: list[psutil.Process] = []
    if end:
        with pytest.raises(AgentCrashedError, match=r"exit status 3"):
            remote.own_route()
    else:
        remote.own_route()
        below = keeper.children(recursive=True)
        assert len(below) >= 2
    remote._process.kill()
    assert not keeper.is_running()
    assert not [each for each in below if each.is_running() and each.status() != psutil.STATUS_ZOMBIE]
    assert not _commands(str(remote._process._folder / "files"))


def _commands(text: str) -> list[str]:
    """The names of the processes that have a folder of an agent as theirs."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get("BASU_AGENT_FOLDER") == text:
                found.append(process.name())
    return found


@NEEDS_SPACES
@pytest.mark.parametrize(
    "deed",
    ["resource.prlimit({pid}, resource.RLIMIT_NOFILE, (0, 0))", "os.sched_setaffinity({pid}, [0])",
     "os.setpriority(os.PRIO_PROCESS, {pid}, 19)", "os.kill({pid}, 0)"],
)  # fmt: skip
def test_other_processes_can_be_neither_limited_nor_seen(tmp_path: Path, deed: str) -> None:
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        before = psutil.Process(other.pid).rlimit(psutil.RLIMIT_NOFILE)
        with pytest.raises(AgentCrashedError, match=r"ProcessLookupError"):
            cheat(tmp_path, deed.format(pid=other.pid)).own_route()
        assert psutil.Process(other.pid).rlimit(psutil.RLIMIT_NOFILE) == before
        other.communicate(b"\n")


def test_output_is_bounded_in_each_run_and_steers_no_terminal(tmp_path: Path) -> None:
    path = tmp_path / "cheat.py"
    path.write_text(AGENT.replace("DEED", "os.write(1, b'x' * 30_000_000); os.write(2, b'\\x1b[2Jlast words')"))
    program = (
        "from basu.agents.process.remote_agent import RemoteAgent, find_agent\n"
        f"found = find_agent({str(path)!r})\n"
        "for _ in range(2): remote = RemoteAgent(found, 10.0, 0); remote.own_route()\n"
        "remote._process.kill()"
    )
    done = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    assert 0 < len(done.stdout) <= 2 << 20
    assert done.stderr.count(b"the agent wrote more than 1 MB in this run") == 2
    assert done.stderr.count(b"?[2Jlast words") == 2


def test_the_end_of_an_agent_with_children_ends_no_other_process(tmp_path: Path) -> None:
    """An agent's children have numbers in their namespace that other processes have outside it."""
    with contextlib.ExitStack() as others:
        remote = cheat(tmp_path, "[subprocess.Popen(['sleep', '60']) for _ in range(60)]")
        started = [others.enter_context(subprocess.Popen(["sleep", "60"])) for _ in range(60)]
        remote.own_route()
        remote._process.kill()
        ended = [each.pid for each in started if each.poll() is not None]
        for each in started:
            each.kill()
    assert ended == []


def test_a_control_character_in_two_parts_steers_no_terminal() -> None:
    agents_end, keepers_end = os.pipe()[::-1]
    shown, written = os.pipe()
    outputs = _Outputs([keepers_end, os.pipe()[0]])
    outputs.open[keepers_end] = written
    for part in (b"caf\xc3", b"\xa9 \xc2", b"\x9b2J \xc2", b"\xb5m"):
        os.write(agents_end, part)
        assert outputs.pass_on(keepers_end)
    assert os.read(shown, 100) == "café ?2J µm".encode()


def test_the_confinement_that_holds_is_known_and_said(tmp_path: Path) -> None:
    agent = found(tmp_path, "pass")
    parts = agent.process().confinement
    assert parts is not None
    assert set(agent.confinement) == set(parts) <= set(confinement.MEANINGS)
    assert ("files" in parts) == (confinement.landlock_abi() > 0)
    assert confinement.sentence(()) == "nothing confines it here"


def test_memory_that_is_spread_over_processes_counts_together(tmp_path: Path) -> None:
    """Six processes with a tenth of the memory each looked like one that held little."""
    hold = "import time; held = bytearray(40_000_000); print(1, flush=True); time.sleep(60)"
    deed = (
        f"started = [subprocess.Popen([sys.executable, '-c', {hold!r}], stdout=subprocess.PIPE) for _ in range(6)]; "
        "[each.stdout.readline() for each in started]; os.kill(os.getpid(), signal.SIGKILL)"
    )
    with pytest.raises(AgentCrashedError, match="SIGKILL") as raised:
        cheat(tmp_path, deed).own_route()
    held = re.search(r"at most it held ([\d.]+) GB", str(raised.value))
    assert held is not None
    assert float(held[1]) > 6 * 0.04 + 0.05  # the six together, and the agent's own process


NEEDS_PORTS = pytest.mark.skipif(
    confinement.landlock_abi() < confinement.ABI_WITH_PORTS, reason="this kernel's Landlock has no ports (Linux 6.7)"
)


@NEEDS_PORTS
def test_an_agent_that_scans_for_the_simulator_finds_the_gate_alone(tmp_path: Path) -> None:
    """At --host the simulator's own port was open to every program of the machine."""
    with socket.socket() as simulator, socket.socket() as gate:
        for each in (simulator, gate):
            each.bind(("127.0.0.1", 0))
            each.listen()
        own, free = (each.getsockname()[1] for each in (simulator, gate))
        deed = (
            "probe = lambda port: socket.socket().connect_ex(('127.0.0.1', port)) == 0; "
            f"open_ports = [port for port in ({own}, {free}) if probe(port)]; "
            f"by_child = subprocess.run([sys.executable, '-c', 'import socket; "
            f'print(socket.socket().connect_ex(("127.0.0.1", {own})))\'], capture_output=True).stdout; '
            "raise ValueError(f'found {open_ports}, by a child {by_child}')"
        )
        agent = found(tmp_path, deed, closed_ports=(own,))
        with pytest.raises(AgentCrashedError, match=rf"found \[{free}\], by a child b'13"):
            RemoteAgent(agent, 10.0, 0).own_route()
        assert confinement.PORTS in agent.confinement
        assert confinement.PORTS not in found(tmp_path, "pass").confinement


@NEEDS_PORTS
def test_an_agent_cannot_take_a_closed_port_for_itself(tmp_path: Path) -> None:
    """An agent that held every port of a range left none to the benchmark, which then blamed the set-up."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    deed = (
        "s = socket.socket(); "
        f"s.bind(('127.0.0.1', 0)); t = socket.socket(); t.bind(('127.0.0.1', {port})); raise ValueError('took it')"
    )
    with pytest.raises(AgentCrashedError, match="Permission denied"):
        RemoteAgent(found(tmp_path, deed, closed_ports=(port,)), 10.0, 0).own_route()
    with pytest.raises(AgentCrashedError, match="took it"):
        RemoteAgent(found(tmp_path, deed), 10.0, 0).own_route()


@NEEDS_SPACES
def test_an_agent_sees_no_results_and_not_where_its_drive_is_written(tmp_path: Path) -> None:
    """Names of folders said which case was driven, and the settings of a matrix which ones follow."""
    output = tmp_path / "runs"
    (output / "pedestrian_crossing_1").mkdir(parents=True)
    (tmp_path / "agent").mkdir()
    deed = f"raise ValueError('found ' + repr(os.listdir({str(output)!r})))"
    agent = found(tmp_path / "agent", deed, output=output)
    with pytest.raises(AgentCrashedError, match=r"found \[\]"):
        RemoteAgent(agent, 10.0, 0).own_route()
    assert confinement.RESULTS in agent.confinement
    deed = f"import ctypes; ctypes.CDLL(None).umount2({str(output)!r}.encode(), 2); {deed}"
    with pytest.raises(AgentCrashedError, match=r"found \[\]"):
        RemoteAgent(found(tmp_path / "agent", deed, output=output), 10.0, 0).own_route()
    assert (output / "pedestrian_crossing_1").is_dir()


REMEMBERED = {
    "shared memory": ("Path('/dev/shm/basu-cheat').write_text('x')", "Path('/dev/shm/basu-cheat').exists()"),
    "segment of System V": (
        "import ctypes; ctypes.CDLL(None).shmget(0xBA50, 4096, 0o1600)",
        "__import__('ctypes').CDLL(None).shmget(0xBA50, 4096, 0o600) >= 0",
    ),
    "queue of System V": (
        "import ctypes; ctypes.CDLL(None).msgget(0xBA50, 0o1600)",
        "__import__('ctypes').CDLL(None).msgget(0xBA50, 0o600) >= 0",
    ),
    "key of the user": (
        "import ctypes; ctypes.CDLL(None).syscall(248, b'user', b'basu-cheat', b'x', 1, -4)",  # add_key, user's ring
        "__import__('ctypes').CDLL(None).syscall(250, 10, -4, b'user', b'basu-cheat', 0) >= 0",  # KEYCTL_SEARCH
    ),
    "time of a file": ("os.utime(FILE, (1, 1))", "os.stat(FILE).st_mtime == 1"),
    "permission of a file": ("os.chmod(FILE, 0o640)", "os.stat(FILE).st_mode & 0o777 == 0o640"),
    "attribute of a file": ("os.setxattr(FILE, 'user.basu', b'x')", "'user.basu' in os.listxattr(FILE)"),
}
"""What an agent may do to remember a drive beside its process, and how the next one finds it."""


@NEEDS_SPACES
@pytest.mark.parametrize(("leave", "look"), REMEMBERED.values(), ids=REMEMBERED)
def test_nothing_that_an_agent_leaves_reaches_its_next_process(tmp_path: Path, leave: str, look: str) -> None:
    (tmp_path / "file").touch(0o600)
    file = repr(str(tmp_path / "file"))
    first = found(tmp_path, leave.replace("FILE", file))
    with contextlib.suppress(AgentCrashedError):
        RemoteAgent(first, 10.0, 0).own_route()
    assert confinement.MEMORY in first.confinement
    first.process().kill()
    second = found(tmp_path, f"raise ValueError('found ' + str({look.replace('FILE', file)}))")
    with pytest.raises(AgentCrashedError, match="found False"):
        RemoteAgent(second, 10.0, 0).own_route()


def test_a_folder_that_holds_the_agent_is_not_hidden_from_it(tmp_path: Path) -> None:
    agent = found(tmp_path, "pass", output=tmp_path)
    assert agent.bounds.hidden == ()
    assert confinement.RESULTS not in agent.confinement


@NEEDS_SPACES
def test_a_folder_of_results_that_was_made_for_a_process_goes_with_it(tmp_path: Path) -> None:
    output = tmp_path / "runs"
    (tmp_path / "agent").mkdir()
    agent = found(tmp_path / "agent", "pass", output=output)
    assert output.is_dir()
    agent.process().kill()
    assert not output.exists()


OTHER_WAYS = {
    "plain": "s = socket.socket(); s.connect(PLACE)",
    "multipath": "s = socket.socket(socket.AF_INET, socket.SOCK_STREAM, 262); s.connect(PLACE)",
    "multipath of version 6": "s = socket.socket(socket.AF_INET6, socket.SOCK_STREAM, 262); s.connect(PLACE)",
    "with the first data": "s = socket.socket(); s.sendto(b'x', socket.MSG_FASTOPEN, PLACE)",
    "with the first message": "s = socket.socket(); s.sendmsg([b'x'], [], socket.MSG_FASTOPEN, PLACE)",
    "another kind of socket": "s = socket.socket(43, socket.SOCK_STREAM); s.connect(PLACE)",
    "turned into another kind": "s = socket.socket(); s.setsockopt(socket.IPPROTO_TCP, 31, b'smc'); s.connect(PLACE)",
    "raw packets": "s = socket.socket(socket.AF_INET, socket.SOCK_RAW, 6); s.sendto(b'x', PLACE)",
    "packets of a device": "s = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM); s.send(b'x')",
}


@NEEDS_PORTS
@pytest.mark.parametrize("way", OTHER_WAYS.values(), ids=OTHER_WAYS)
def test_no_other_kind_of_socket_reaches_a_closed_port(tmp_path: Path, way: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        port = server.getsockname()[1]
        deed = way.replace("PLACE", f"('127.0.0.1', {port})") + "; raise ValueError('reached it')"
        with pytest.raises(AgentCrashedError, match=r"PermissionError|OSError"):
            RemoteAgent(found(tmp_path, deed, closed_ports=(port,)), 10.0, 0).own_route()
        with pytest.raises(TimeoutError):
            server.accept()


@NEEDS_PORTS
def test_no_ring_of_the_kernel_makes_calls_past_the_filter(tmp_path: Path) -> None:
    deed = (
        "import ctypes; l = ctypes.CDLL(None, use_errno=True); r = l.syscall(425, 1, ctypes.create_string_buffer(120))"
    )
    deed += "; raise ValueError(f'ring {r}, error {ctypes.get_errno()}')"
    with pytest.raises(AgentCrashedError, match="ring -1, error 38"):
        RemoteAgent(found(tmp_path, deed, closed_ports=(1,)), 10.0, 0).own_route()


def test_ports_do_not_hold_where_the_filter_cannot_be_set() -> None:
    words = """if True:
        from basu.agents.process import confinement, socket_filter
        socket_filter.MACHINES.clear()
        print(confinement.confine([], closed_ports=[1]))"""
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert confinement.PORTS not in done.stdout


def test_ports_are_closed_for_a_simulator_that_is_not_ours() -> None:
    assert closed_ports("10.0.0.1", 2000, is_open=False) == (2000, 2001, 2002, *TRAFFIC_PORTS)
    assert closed_ports("10.0.0.1", 2000, is_open=True) == ()


def test_ports_of_traffic_managers_are_closed_on_every_simulator() -> None:
    assert closed_ports(None, 2000, is_open=False) == tuple(TRAFFIC_PORTS)
    ports = [free_traffic_port() for _ in range(3)]
    assert len(set(ports)) == 3
    assert set(ports) <= set(TRAFFIC_PORTS)


def test_only_a_record_of_the_kernel_excuses_a_kill_and_no_agent_that_used_the_memory_up() -> None:
    small = Ending(-9, 100_000_000)
    assert not ended_outside(small, oom_kills=0)
    assert ended_outside(small, oom_kills=1)
    assert not ended_outside(Ending(-9, memory_bytes()), oom_kills=1)
    assert not ended_outside(Ending(-15, 100_000_000), oom_kills=1)
    assert re.search(r"SIGKILL \(Killed\); at most it held 0.10 GB", ended_how(small))
    assert "number 40" in ended_how(Ending(-40))
