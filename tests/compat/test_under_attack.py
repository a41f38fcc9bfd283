"""Claims about hostile clients: what they send costs the server little, and the others next to nothing.

Waits are measured in the server's own CPU time, by what others got done meanwhile, or without what other processes take
(``lock_waits``): the clock of a busy machine says nothing.
"""

import contextlib
import math
import resource
import socket
import struct
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from threading import Event, Thread
from typing import Any

import carla
import psutil
import pytest
from typing_extensions import Self

import linden
from fakes import greedy_server
from fakes.one_road import OPENDRIVE as ONE_ROAD
from fakes.raw_client import RawClient, RawSubscriber
from lock_waits import LockWatch, held_up_s
from servers import RunningServer, running_server

LINDEN = (Path(linden.__file__).parent / "data" / "Linden.xodr").read_text("utf-8")
AT_ORIGIN = [[0.0, 0.0, 50.0], [0.0, 0.0, 0.0]]
PHYSICS_FIELDS = {"moi": 2, "mass": 11}
WITHOUT_WALLS = [2.0, 50.0, 0.0, 0.6, True, True, True]
WITH_WALLS = [2.0, 50.0, 1.0, 0.6, True, True, True]
GREEDY = {"channels": "4096", "points_per_second": "20000000"}
LONGEST_TICK_S = 0.1
"""What no work of another client may exceed in each of three tries. Seen at loads of 1 to 17 on two cores: 15 to 65 ms
beside walls round Linden, 3 to 37 ms beside a recording of 100,000 frames (docs/decisions/0095)."""
GONE = (EOFError, OSError, UnicodeDecodeError)

on_linux = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the clocks and limits of other processes are Linux's"
)


@pytest.fixture
def raw(server: RunningServer, world: carla.World) -> Iterator[RawClient]:
    """A client that speaks bytes, in the fresh episode of ``world``, which is synchronous."""
    assert world
    with RawClient(server.port, 120.0) as client:
        yield client


def rss_mib(server: RunningServer) -> float:
    return float(psutil.Process(server.process.pid).memory_info().rss / 2**20)


def cpu_s(server: RunningServer) -> float:
    times = psutil.Process(server.process.pid).cpu_times()
    return float(times.user + times.system)


class Meanwhile(Thread):
    """A well-behaved client that ticks as long as another does something; counts what it got done.

    ``worst_s`` is what the server took for its worst tick, other processes' load left out; see ``lock_waits``.
    """

    def __init__(self, server: RunningServer) -> None:
        super().__init__(daemon=True)
        self._server, self._has_begun, self._ends = server, Event(), Event()
        self.ticks, self.worst_s = 0, 0.0

    def run(self) -> None:
        clocks = LockWatch(self._server.process.pid)
        with RawClient(self._server.port, 120.0) as client:
            while not self._ends.is_set():
                before = clocks.read()
                client.call("tick_cue")
                self.ticks += 1
                self.worst_s = max(self.worst_s, held_up_s(before, clocks.read()))
                self._has_begun.set()

    def __enter__(self) -> Self:
        self.start()
        assert self._has_begun.wait(120)
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self.join(120)
        assert not self.is_alive()


def worst_tick_s(server: RunningServer, act: Callable[[], Any]) -> float:
    """Return for how long the server held up the worst tick beside an action, the least of three tries.

    The build of the scene in the background disturbs the first tries. A tick that the action blocks sees it in each.
    """
    worst_s = math.inf
    for _ in range(3):
        with Meanwhile(server) as others:
            act()
        assert others.ticks >= 5
        worst_s = min(worst_s, others.worst_s)
        if worst_s < LONGEST_TICK_S:
            break
    return worst_s


@on_linux
def test_work_that_holds_the_lock_is_seen_in_the_worst_tick() -> None:
    greedy = (str(Path(greedy_server.__file__)),)
    with (
        running_server("--sync", program=greedy) as server,
        RawClient(server.port, 120.0) as raw,
        Meanwhile(server) as others,
    ):
        raw.call("copy_opendrive_to_file", ONE_ROAD, WITHOUT_WALLS)
    assert others.worst_s > LONGEST_TICK_S


@on_linux
def test_walls_round_linden_are_made_beside_the_ticks_of_others(server: RunningServer, raw: RawClient) -> None:
    raw.call("copy_opendrive_to_file", LINDEN, WITHOUT_WALLS)  # its facts are kept now
    before_s = cpu_s(server)
    raw.call("copy_opendrive_to_file", LINDEN, WITH_WALLS)
    assert cpu_s(server) - before_s < 4.0  # it took 12 s, and takes 1
    worst_s = worst_tick_s(server, partial(raw.call, "copy_opendrive_to_file", LINDEN, WITH_WALLS))
    assert worst_s < LONGEST_TICK_S


def test_a_message_of_empty_arrays_costs_some_hundred_megabytes_at_most(server: RunningServer, raw: RawClient) -> None:
    many = 4 * 1024 * 1024  # sixteen times as many as may come
    before_mib = rss_mib(server)
    with RawClient(server.port) as rude, pytest.raises(OSError):  # noqa: PT012 - one message in parts
        rude.socket.sendall(b"\x94\x00\x01\xa7version\xdc\x00\x10\x91\xc2")
        for _ in range(15):
            rude.socket.sendall(b"\xdd" + struct.pack(">I", many) + b"\x90" * many)
    assert raw.call("tick_cue") > 0
    assert rss_mib(server) - before_mib < 200.0


@on_linux
def test_arrays_are_given_back_in_a_fraction_of_a_second(server: RunningServer, raw: RawClient) -> None:
    many = 250_000
    half = b"\x94\x00\x01\xa7version\xdc\x00\x10\x91\xc2\xdd" + struct.pack(">I", many) + b"\x90" * (many - 1)
    worst_s = 0.0
    for _ in range(3):
        with RawClient(server.port) as rude, Meanwhile(server) as others:
            rude.socket.sendall(half)
            raw.call("version")
            rude.reset()
            raw.call("version")
        worst_s = max(worst_s, others.worst_s)
    assert worst_s < 0.2  # those of 4 Mi took 1.1 s


def test_half_received_arrays_of_many_clients_are_bounded_together(server: RunningServer, raw: RawClient) -> None:
    many = 225_000
    half = b"\x94\x00\x01\xa7version\xdc\x00\x10\x91\xc2\xdd" + struct.pack(">I", many) + b"\x90" * (many - 1)
    hoarders = [RawClient(server.port) for _ in range(6)]
    for hoarder in hoarders:
        with contextlib.suppress(OSError):
            hoarder.socket.sendall(half)
    while "too much to receive more" not in server.log():
        assert raw.call("tick_cue") > 0
    for hoarder in hoarders:
        hoarder.socket.close()


def test_a_picture_of_two_million_pixels_is_refused_and_the_client_goes_on(
    server: RunningServer, raw: RawClient
) -> None:
    pixels = [2, 2, [[9, 9, 9, 255]] * (1920 * 1080)]
    before_mib, before_s = rss_mib(server), cpu_s(server)
    with pytest.raises(RuntimeError, match="no texture can be applied to 'House_0'"):
        raw.call("apply_color_texture_to_objects", ["House_0"], 0, pixels)
    assert raw.call("tick_cue") > 0
    assert cpu_s(server) - before_s < 1.0
    assert rss_mib(server) - before_mib < 100.0


def test_the_log_cannot_be_flooded(server: RunningServer, raw: RawClient) -> None:
    before = len(server.log())
    name = b"\xdb" + struct.pack(">I", 20_000_000) + b"\xff" * 20_000_000
    for rest in (b"\x91\xc3", b"\x90", b"\x91\x91\xc3"):
        with RawClient(server.port) as rude, contextlib.suppress(*GONE):
            rude.socket.sendall(b"\x94\x00\x01" + name + rest)
            rude.answer()
    for _ in range(300):
        with socket.create_connection(("127.0.0.1", server.port)) as rude_socket:
            rude_socket.sendall(b"\xc1")
    for number in range(300):
        step = [True, 1.0 + number / 1e4]
        raw.call("set_episode_settings", [True, False, step, True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True])
    assert raw.call("version") == "0.9.16"
    assert len(server.log()) - before < 20_000


@pytest.mark.parametrize("far", ["1e308", "1e6", "9000"])
def test_a_crosswalk_without_end_is_refused_or_painted_as_far_as_it_goes(
    server: RunningServer, raw: RawClient, far: str
) -> None:
    corners = "".join(f'<cornerLocal u="{u}" v="{v}" z="0" height="0"/>' for u, v in ((0, 0), (far, 0), (far, 3)))
    outline = f"<outline>{corners}</outline>"
    thing = f'<object id="9999" name="Crosswalk" type="crosswalk" s="1" t="0" hdg="0">{outline}</object>'
    text = LINDEN.replace("<objects>", f"<objects>{thing}", 1)
    assert text != LINDEN
    if far != "9000":
        with pytest.raises(RuntimeError, match=f"attribute 'u' of <cornerLocal> is '{far}'"):
            raw.call("copy_opendrive_to_file", text, WITHOUT_WALLS)
        return
    raw.call("copy_opendrive_to_file", text, WITHOUT_WALLS)
    raw.call("load_new_episode", "OpenDriveMap", False, 0xFFFF)
    lidar = raw.call("spawn_actor", [0, "sensor.lidar.ray_cast", []], AT_ORIGIN)
    stream_id = int.from_bytes(lidar[5][:4], "little")
    raw.call("get_sensor_token", stream_id)  # so that the tick waits for the subscriber
    with RawSubscriber(server.streaming_port, stream_id) as listener:
        listener.socket.settimeout(120.0)
        raw.call("tick_cue")
        assert listener.message()


@pytest.mark.parametrize("length", ["1e-300", "1e-5", "1e300"])
def test_a_road_of_any_length_is_read_or_refused(raw: RawClient, length: str) -> None:
    plan = f'<planView><geometry s="0" x="0" y="0" hdg="0" length="{length}"><line/></geometry></planView>'
    lanes = (
        '<lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right><lane id="-1" type="driving">'
        '<width sOffset="0" a="3.5"/></lane></right></laneSection></lanes>'
    )
    text = f'<OpenDRIVE><header/><road id="1" junction="-1" length="{length}">{plan}{lanes}</road></OpenDRIVE>'
    try:
        raw.call("copy_opendrive_to_file", text, WITH_WALLS)
    except RuntimeError as error:
        assert "internal error" not in str(error)  # noqa: PT017 - it may be read as well
        assert length != "1e-5"


@pytest.mark.parametrize("number", [1e-40, 3.4e38, -3.4e38, 0.0])
@pytest.mark.parametrize("field", sorted(PHYSICS_FIELDS))
def test_no_physics_control_makes_a_pose_that_is_none(
    world: carla.World, raw: RawClient, field: str, number: float
) -> None:
    points = raw.call("get_map_info")[1]
    car = raw.call("spawn_actor", [0, "vehicle.tesla.model3", []], points[0])[0]
    control = raw.call("get_physics_control", car)
    control[PHYSICS_FIELDS[field]] = number
    with pytest.raises(RuntimeError, match=field):
        raw.call("apply_physics_control", car, control)
    for _ in range(20):
        raw.call("tick_cue")
    world.tick()
    where = world.get_snapshot().find(car).get_transform().location
    assert abs(where.x) + abs(where.y) + abs(where.z) < 1e5


def test_a_chain_of_attachments_of_any_length_can_be_destroyed(raw: RawClient) -> None:
    link = [0, "util.actor.empty", []]
    chain = [raw.call("spawn_actor", link, AT_ORIGIN)[0]]
    for _ in range(1200):
        chain.append(raw.call("spawn_actor_with_parent", link, AT_ORIGIN, chain[-1], 0, "")[0])
    raw.call("tick_cue")
    assert raw.call("destroy_actor", chain[0]) is True
    assert raw.call("tick_cue") > 0


def write_empty_frames(path: Path, frames: int) -> None:
    """A recording in which nothing happens."""
    head = struct.pack("<HH", 1, 14) + b"CARLA_RECORDER" + struct.pack("<qH", 0, 6) + b"Linden"
    body = [
        struct.pack("<BIQdd", 0, 24, number + 1, 0.05, 0.05 * number) + struct.pack("<BI", 1, 0)
        for number in range(frames)
    ]
    path.write_bytes(head + b"".join(body))


@on_linux
def test_a_recording_of_fifty_thousand_frames_is_read_beside_the_ticks_of_others(
    server: RunningServer, raw: RawClient
) -> None:
    path = Path(raw.call("start_recorder", "long.log", False))
    raw.call("stop_recorder")
    write_empty_frames(path, 50_000)
    for call in (
        ("show_recorder_file_info", "long.log", False),
        ("replay_file", "long.log", -1.0, 0.0, 0, False, AT_ORIGIN),
    ):
        assert worst_tick_s(server, partial(raw.call, *call)) < LONGEST_TICK_S
    raw.call("stop_replayer", False)
    path.unlink()


@on_linux
def test_the_scene_of_a_map_is_made_beside_the_ticks_of_others(server: RunningServer, raw: RawClient) -> None:
    def look_at_linden() -> None:
        for town in ("OpenDriveMap", "Linden"):
            raw.call("load_new_episode", town, True, 0xFFFF)
            camera = raw.call("spawn_actor", [0, "sensor.camera.rgb", []], AT_ORIGIN)
            for _ in range(12):  # each answer waits a while for the scene
                raw.call("version")
            assert raw.call("destroy_actor", camera[0]) is True

    raw.call("copy_opendrive_to_file", ONE_ROAD, WITHOUT_WALLS)
    assert worst_tick_s(server, look_at_linden) < LONGEST_TICK_S


@on_linux
def test_a_server_without_memory_refuses_and_goes_on() -> None:
    with running_server("--sync") as server, RawClient(server.port, 120.0) as raw, RawClient(server.port) as other:
        for step_s in (0.05, 10.0):
            raw.call("set_episode_settings", [True, False, [True, step_s], True, 0.1, 1, 0.0, True, 1.0, 1.0, True])
            if step_s < 1.0:
                greedy = [[attribute, 1, value] for attribute, value in GREEDY.items()]
                lidar = raw.call("spawn_actor", [0, "sensor.lidar.ray_cast_semantic", greedy], AT_ORIGIN)
                stream_id = int.from_bytes(lidar[5][:4], "little")
                raw.call("get_sensor_token", stream_id)  # so that the tick waits for the subscriber
                listener = RawSubscriber(server.streaming_port, stream_id)
                raw.call("tick_cue")  # with what it looks at built
        limit = psutil.Process(server.process.pid).memory_info().vms + 60 * 2**20
        resource.prlimit(server.process.pid, resource.RLIMIT_AS, (limit, limit))
        with pytest.raises(RuntimeError, match="tick_cue is refused: the server's memory does not suffice"):
            raw.call("tick_cue")
        for _ in range(3):
            with RawClient(server.port, 120.0) as rude, contextlib.suppress(*GONE):
                rude.socket.sendall(rude.request("copy_opendrive_to_file", "<a>" * 20_000_000, []))
                rude.answer()
        listener.socket.close()
        assert raw.call("destroy_actor", lidar[0]) is True
        assert other.call("tick_cue") > 1
        assert server.process.poll() is None
