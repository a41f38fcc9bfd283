"""Claims about looking on at a run in a live simulator: it is shown whole, it is not changed, and it plays again."""

import contextlib
import io
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import carla
import numpy as np
import pytest

from basu.cli import main
from basu.records.history.files import read_history
from basu.records.recording_files import MAP_FILE, read_map
from basu_carla_log import read_log
from basu_carla_log.metrics_log import MetricsLog
from basu_carla_log.server_replay import Progress, Where, play
from fakes.rerun_files import read_rrd
from servers import RunningServer, running_server

AGENT = """
class Looking(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 24:
            raise ValueError("enough")
        assert sensor_data["GPS"][0]
        return carla.VehicleControl(throttle=0.6)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3"}

    def sensors(self):
        lidar = {"range": 30, "rotation_frequency": 20, "channels": 8, "points_per_second": 20000}
        eye = {"x": 1.5, "z": 2.0, "width": 64, "height": 48, "fov": 90}
        return [
            {"type": "sensor.camera.rgb", "id": "EYE", **eye},
            {"type": "sensor.camera.depth", "id": "DEPTH", **eye},
            {"type": "sensor.lidar.ray_cast", "id": "LIDAR", "z": 2.4, **lidar},
            {"type": "sensor.other.gnss", "id": "GPS"},
        ]
"""


ROUTE = "routes/linden_short.xml"


class Runs(NamedTuple):
    """The same drive twice."""

    unseen: Path
    seen: Path  # with --viewer and --record
    log: Path
    said: str
    server: RunningServer


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runs]:
    """Two short runs at a server that may write logs; without a screen, so no window opens in a test."""
    folder = tmp_path_factory.mktemp("live")
    (folder / "looking.py").write_text(AGENT)
    with (
        running_server("--recordings", str(folder)) as server,
        pytest.MonkeyPatch.context() as patch,
        io.StringIO() as said,
    ):
        for name in ("DISPLAY", "WAYLAND_DISPLAY"):
            patch.delenv(name, raising=False)
        address = ["--host", "127.0.0.1", "--port", str(server.port)]
        folders = []
        for options in ([], ["--viewer", "--record"]):
            output = folder / f"runs-{len(folders)}"
            with contextlib.redirect_stdout(said):
                main(
                    ["run", str(folder / "looking.py"), *address, "--routes", ROUTE, "--output", str(output), *options]
                )
            folders.append((output / "latest").resolve())
        (log,) = folder.glob("*.log")
        yield Runs(folders[0], folders[1], log, said.getvalue(), server)


def test_a_run_is_shown_whole_and_not_changed_by_it(runs: Runs) -> None:
    assert (runs.seen / "history.parquet").read_bytes() == (runs.unseen / "history.parquet").read_bytes()
    assert "run.rrd in the result folder (kept, as there is no screen here to show it on)" in runs.said
    history, found = read_history(runs.seen), read_rrd(runs.seen / "run.rrd")
    answered = len(history.frames) - 1  # in its last tick the agent fails, and no viewer looks any more
    assert len(found["/world/ego"]) == answered == 24
    last = found["/world/ego"][-1].values["Transform3D:translation"][0]
    end = history.frames[answered - 1]
    np.testing.assert_allclose(last, [end["x_m"], -end["y_m"], end["z_m"]], rtol=1e-6)
    assert len(found["/world/map/lanes"][0].values["LineStrips3D:strips"]) > 100
    assert {"/world/route", "/signals/score/driving", "/signals/control/throttle"} <= found.keys()


def test_what_sensors_saw_is_shown_ten_times_a_second(runs: Runs) -> None:
    found = read_rrd(runs.seen / "run.rrd")
    pictures = found["/cameras/EYE"]
    np.testing.assert_allclose([row.t_s for row in pictures], np.arange(12) * 0.1, atol=1e-6)
    assert pictures[0].values["EncodedImage:media_type"] == ["image/jpeg"]
    assert found["/cameras/DEPTH"][0].values["DepthImage:meter"] == [10.0]
    points = np.array(found["/world/sensors/LIDAR/points"][3].values["Points3D:positions"])
    assert 100 < len(points) <= 1000
    ground = points[points[:, 2] < -2.0]  # the road below a lidar that hangs 2.4 m above it
    np.testing.assert_allclose(np.median(ground[:, 2]), -2.4, atol=0.2)


def test_the_log_has_the_places_of_the_record_to_the_last_bit_and_its_map(runs: Runs) -> None:
    history = read_history(runs.seen)
    arrays = MetricsLog(read_log(runs.log)).get_actor_arrays("hero")
    places = np.column_stack([history.frames[name] for name in ("x_m", "y_m", "z_m")])
    np.testing.assert_array_equal(arrays.location_m[: len(places)], places)
    assert read_map(runs.seen / MAP_FILE, "Linden").get_waypoint(carla.Location(*places[0])) is not None


def test_a_recorded_run_plays_again_for_any_client(runs: Runs) -> None:
    log = read_log(runs.log)
    (hero,) = log.ids_of(role_name="hero")
    recorded = MetricsLog(log).get_actor_arrays(hero).location_m
    watcher = carla.Client("127.0.0.1", runs.server.port).get_world()
    seen, ended = list[tuple[float, float, float]](), threading.Event()

    def look(snapshot: carla.WorldSnapshot) -> None:
        actor = snapshot.find(hero)
        if actor is not None:
            at = actor.get_transform().location
            seen.append((at.x, at.y, at.z))
            if len(seen) == len(recorded):
                ended.set()

    ready, shown = list[str](), list[int]()
    where = Where("127.0.0.1", runs.server.port, 20.0)
    callback = watcher.on_tick(look)
    try:
        play(log, where, speed=0.0, progress=Progress(ready.append, shown.append))
        assert ended.wait(20.0), f"{len(seen)} of {len(recorded)} frames arrived"
    finally:
        watcher.remove_on_tick(callback)
    assert ready == [f"127.0.0.1:{runs.server.port}"]
    assert sum(shown) == log.frames
    np.testing.assert_array_equal(np.array(seen[: len(recorded)]), recorded)
