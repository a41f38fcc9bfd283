"""Claims about whole runs with a page and a person, in a live simulator: a client takes the place of the browser."""

import contextlib
import json
import os
import select
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Origin

from basu.cli import main
from basu.errors import UserError
from basu.records.history import History
from basu.records.history.files import read_history
from basu_window.browser.page_input import PageInput
from basu_window.manual.inputs import Input
from linden_window import panes
from linden_window.link import PageLink
from servers import RunningServer

MEETER = """
class Meeter(AutonomousAgent):
    def setup(self):
        blueprint = self.world.get_blueprint_library().find("vehicle.audi.a2")
        pose = self.route.waypoints[12].transform
        pose.location.z += 0.3
        self.parked = self.world.spawn_actor(blueprint, pose)
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 90:
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.7)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3", "sensors": "config/sensors.json"}

    def destroy(self):
        self.parked.destroy()
"""
Runner = Callable[..., tuple[int, dict[str, Any], History]]
SENSORS = [
    {"type": "sensor.lidar.ray_cast", "id": "TOP", "z": 2.0, "points_per_second": 100000, "channels": 16},
    {"type": "sensor.other.gnss", "id": "GPS"},
    {"type": "sensor.other.imu", "id": "IMU"},
]
DRIVER = """
from basu.agents.builtin.{module} import {base}

class Driver({base}):
    steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > {end}:
            raise ValueError("enough")
        return super().run_step(sensor_data)

    def config(self):
        return {{"vehicle": "vehicle.tesla.model3", "sensors": {sensors!r}}}
"""


class Page:
    """A page without a browser: it connects when the port is open, sends its orders, and keeps what arrives."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.orders: list[dict[str, Any]] = []
        self.notes: list[dict[str, Any]] = []
        self.panes: list[dict[str, Any]] = []
        self.frames = 0
        self._thread: threading.Thread | None = None
        start = PageLink.start

        def started(*options: str, **places: Any) -> PageLink:
            link = start(*options, **places)
            self._thread = threading.Thread(target=self._read, args=(link.address,))
            self._thread.start()
            with socket.socket(fileno=os.dup(link.fileno())) as waiting:
                until_s = time.monotonic() + 60.0
                while time.monotonic() < until_s:
                    readable, _, _ = select.select([waiting], [], [], 1.0)
                    if readable and waiting.recv(65536, socket.MSG_PEEK).count(b"\n") > len(self.orders):
                        break  # the number of pages and all orders: the drive begins with them
            return link

        monkeypatch.setattr(PageLink, "start", started)

    def _read(self, address: str) -> None:
        origin = address.rsplit("/", 2)[0]
        with connect(address.replace("http", "ws") + "live", origin=Origin(origin), max_size=None) as page:
            for order in self.orders:
                page.send(json.dumps(order))
            with contextlib.suppress(ConnectionClosed):
                while True:
                    self._keep(page.recv())

    def _keep(self, message: str | bytes) -> None:
        if isinstance(message, str):
            self.notes.append(json.loads(message))
        elif int.from_bytes(message[:4], "little") == panes.MAGIC:
            self.panes.append(json.loads(message[8 : 8 + int.from_bytes(message[4:8], "little")]))
        else:
            self.frames += 1

    def of(self, kind: str) -> list[dict[str, Any]]:
        if self._thread is not None:
            self._thread.join(30)
        return [note for note in self.notes if note["type"] == kind]


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Page:
    return Page(monkeypatch)


@pytest.fixture
def run(simulator: RunningServer, tmp_path: Path, route_file: Path) -> Runner:
    """``basu run`` in this process, at the shared simulator: exit code, result and record."""

    def at(agent: object, *options: str) -> tuple[int, dict[str, Any], History]:
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        output = tmp_path / "runs"
        words = [*address, "--routes", str(route_file), "--output", str(output), "--in-process", *options]
        code = main(["run", str(agent), *words])
        folder = output / "latest"
        return code, json.loads((folder / "result.json").read_text()), read_history(folder)

    return at


def driver(folder: Path, *, end: int, human: bool = False, sensors: list[dict[str, Any]] | None = None) -> Path:
    """Return the file of an agent that ends after so many steps."""
    module, base = ("basic", "HumanAgent") if human else ("baselines", "ForwardAgent")
    path, set_of_sensors = folder / "driver.py", folder / "sensors.json"
    set_of_sensors.write_text(json.dumps(sensors or []))
    path.write_text(DRIVER.format(module=module, base=base, end=end, sensors=str(set_of_sensors)))
    return path


def script(monkeypatch: pytest.MonkeyPatch, orders: dict[int, dict[str, Any]]) -> None:
    """Let the page with the wheel send these orders before the ticks that they name."""
    read = PageInput.read

    def scripted(self: PageInput, tick: int) -> Input:
        if tick in orders:
            self.take({"order": "drive", "page": 1, **orders[tick]})
        return read(self, tick)

    monkeypatch.setattr(PageInput, "read", scripted)


@pytest.mark.slow
def test_a_run_is_the_same_with_and_without_a_page_and_its_sensors(run: Runner, page: Page, tmp_path: Path) -> None:
    path = tmp_path / "meeter.py"
    path.write_text(MEETER)
    page.orders = [{"order": "sensors", "names": ["GNSS", "COLLISION", 7, "no such sensor"]}]
    _, _, without = run(path)
    _, result, watched = run(path, "--watch")
    assert result["infractions"], "there is something to be told"
    assert watched.frames.tobytes() == without.frames.tobytes()
    for name in ("tick", "x_m", "y_m", "z_m", "yaw_rad", "velocity_x_mps", "velocity_y_mps"):
        assert np.array_equal(watched.others[name], without.others[name])  # ids go on counting in one server
    assert [event.tick for event in watched.collisions] == [event.tick for event in without.collisions]
    assert page.of("readings")
    assert page.of("marks")[-1]["marks"]


def test_sensors_that_a_page_asks_for_are_sent_and_no_others(run: Runner, page: Page, tmp_path: Path) -> None:
    page.orders = [{"order": "sensors", "names": ["TOP", "GPS"]}]
    run(driver(tmp_path, end=60, sensors=SENSORS), "--watch")
    (told,) = page.of("sensors")
    assert [sensor["name"] for sensor in told["sensors"]] == ["TOP", "GPS", "IMU"]
    assert {(pane["name"], pane["kind"]) for pane in page.panes} == {("TOP", "points"), ("GPS", "lines")}
    assert max(pane.get("count", 0) for pane in page.panes) > 100
    lines = {line["name"]: line["value"] for pane in page.panes if pane["kind"] == "lines" for line in pane["lines"]}
    assert lines["Latitude"].endswith("° N")


def test_p_takes_over_from_any_agent_and_gives_back(
    run: Runner, page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(
        monkeypatch,
        {
            9: {"held": ["brake"]},
            10: {"held": ["brake"], "strikes": ["autopilot"]},
            19: {"held": []},
            20: {"strikes": ["autopilot"]},
        },
    )
    _, result, history = run(driver(tmp_path, end=30), "--watch")
    manual = history.frames["manual"]
    assert np.flatnonzero(manual).tolist() == list(range(10, 20))
    assert (history.frames["applied_throttle"][10:19] == 0.0).all()
    assert history.frames["applied_brake"][12] > 0.5
    assert history.frames["applied_throttle"][25] == pytest.approx(0.9)
    assert result["disengagements"]["number"] == 1
    assert page.of("route")[0]["controls"] is not None


def test_escape_ends_the_run_and_all_is_written(run: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script(monkeypatch, {9: {"strikes": ["quit"]}})
    code, result, history = run(driver(tmp_path, end=30), "--watch")
    assert (code, result["status"]) == (130, "Interrupted")
    assert len(history.frames) == 10


@pytest.mark.usefixtures("page")
def test_what_a_person_drives_can_be_recorded_and_played(
    run: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script(
        monkeypatch,
        {
            1: {"held": ["throttle"]},
            10: {"held": ["throttle", "left"]},
            16: {"held": ["throttle"]},
            24: {"held": ["hand_brake"]},
            28: {"held": []},
            30: {"strikes": ["autopilot"]},
        },
    )
    agent = driver(tmp_path, end=34, human=True)
    session = tmp_path / "session.json"
    _, driven, live = run(agent, "--watch", "--record-keys", str(session))
    _, _, played = run(agent, "--keys", str(session))
    assert live.frames.tobytes() == played.frames.tobytes()
    assert live.frames["manual"].tolist() == [1] * 30 + [0] * 5
    assert live.frames["applied_hand_brake"][24:28].all()
    assert live.frames["applied_steer"].min() == pytest.approx(-0.15, abs=0.03)
    assert driven["meta"]["wall_s"] > 1.3, "with a person, time passes as it does"


def test_keys_of_another_route_are_refused(run: Runner, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UserError):  # nothing was driven, so there is no record
        run("human", "--keys", "data/human_session.json")
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert result["status"] == "SetupFailed"
    assert "recorded with route 1, and this run has piece" in result["message"]
    assert main(["run", "human", "--keys", "nowhere.json"]) == 2
    assert "session of keys 'nowhere.json' was not found" in capsys.readouterr().err


@pytest.mark.slow
def test_the_session_of_the_experiment_arrives_and_is_three_times_too_fast(
    simulator: RunningServer, tmp_path: Path
) -> None:
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    assert (
        main(["run", "human", "--in-process", *address, "--keys", "data/human_session.json", "--output", str(tmp_path)])
        == 0
    )
    result = json.loads((tmp_path / "latest" / "result.json").read_text())
    assert [found["kind"] for found in result["infractions"]] == ["speeding"] * 3
    assert result["scores"]["path_following"] >= 0.98
    assert result["scores"]["infraction"] == pytest.approx(0.512)
    assert result["disengagements"]["number"] == 0
