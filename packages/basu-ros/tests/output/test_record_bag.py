"""A bag of a run's record, and the record of a bag."""

from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from basu.cli import main
from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.records.history.files import read_history, write_history
from basu_ros.bag_track import read_track
from basu_ros.output.record_bag import write_record
from basu_ros.output.track_record import Shape, record_of
from fakes.drives import VEHICLE, hit
from fakes.one_road import one_road
from fakes.rides import braked, eastward, ride
from fakes.run_records import crashing
from linden_ros2.types import Generation

SHAPE = Shape(VEHICLE.front_m, VEHICLE.rear_m, VEHICLE.width_m)


def test_events_and_frames_lie_at_their_times(tmp_path: Path) -> None:
    history = crashing()
    write_record(history, tmp_path / "bag", Generation.ROS_2)
    with AnyReader([tmp_path / "bag"]) as reader:
        counts = {each.topic: each.msgcount for each in reader.connections}
        hits = [each for each in reader.connections if each.topic == "/carla/hero/collision"]
        times = [at for _, at, _ in reader.messages(connections=hits)]
    ticks = len(history.frames)
    assert counts["/carla/hero/odometry"] == counts["/carla/hero/vehicle_control_cmd"] == counts["/clock"] == ticks
    assert times == [round(hit(133).tick * 0.05 * 1e9)]


@pytest.mark.parametrize("generation", Generation)
def test_a_record_comes_back_out_of_its_bag(generation: Generation, tmp_path: Path) -> None:
    history = ride(8.0, eastward(braked(6.0, 4.0, 2.5), 8.0, throttle=0.5))
    path = tmp_path / ("drive.bag" if generation is Generation.ROS_1 else "drive")
    write_record(history, path, generation)
    again = record_of(read_track(path), SHAPE, carla_map=None, description=None, town="")
    for name in ("t_s", "x_m", "y_m", "yaw_rad", "velocity_x_mps", "velocity_y_mps"):
        assert again.frames[name] == pytest.approx(history.frames[name], abs=1e-6), name
    assert again.frames["throttle"] == pytest.approx(history.frames["throttle"], abs=1e-6)
    assert again.facts.route.length_m == pytest.approx(history.frames["x_m"][-1], abs=0.01)


def test_a_bag_s_drive_is_judged_for_its_comfort(tmp_path: Path) -> None:
    """Harsh braking and gentle braking differ in their bags as in their records."""
    felt = []
    for braking_mps2 in (6.0, 0.8):
        history = ride(14.0, eastward(braked(8.0, 3.0, braking_mps2), 14.0))
        path = tmp_path / f"{braking_mps2}"
        write_record(history, path, Generation.ROS_2)
        again = record_of(read_track(path), SHAPE, carla_map=None, description=None, town="")
        felt.append(judge(Outcome(Status.COMPLETED, ""), again).document()["passengers"]["comfort_score"])
    harsh, gentle = felt
    assert (gentle, harsh) == (1.0, pytest.approx(0.80, abs=0.03))


def test_with_a_map_lanes_and_limits_are_known(tmp_path: Path) -> None:
    town = one_road()
    start = town.generate_waypoints(5.0)[0].transform
    yaw = np.radians(start.rotation.yaw)

    def along(t_s: float) -> dict[str, float]:
        away = 5.0 * t_s
        return {
            "x_m": start.location.x + away * np.cos(yaw) - 0.5 * np.sin(yaw),
            "y_m": start.location.y + away * np.sin(yaw) + 0.5 * np.cos(yaw),
            "yaw_rad": yaw,
            "velocity_x_mps": 5.0 * np.cos(yaw),
            "velocity_y_mps": 5.0 * np.sin(yaw),
        }

    write_record(ride(3.0, along), tmp_path / "drive", Generation.ROS_2)
    again = record_of(read_track(tmp_path / "drive"), SHAPE, carla_map=town, description=None, town="One")
    assert again.frames["lane_offset_m"] == pytest.approx(np.full(60, 0.5), abs=0.01)
    assert set(again.frames["lane_type"].tolist()) == {2}
    assert np.isfinite(again.facts.route.lane_width_m).all()


def test_the_point_of_the_odometry_may_be_the_rear_axle(tmp_path: Path) -> None:
    write_record(ride(2.0, eastward(lambda _: 5.0, 2.0)), tmp_path / "drive", Generation.ROS_2)
    again = record_of(
        read_track(tmp_path / "drive"), SHAPE._replace(origin_m=1.4), carla_map=None, description=None, town=""
    )
    assert again.frames["x_m"][0] == pytest.approx(1.4)


def test_the_commands_lead_from_a_run_to_a_bag_and_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = tmp_path / "run"
    run.mkdir()
    write_history(run, crashing())
    for name in ("drive", "drive.mcap", "drive.bag"):
        bag, back = tmp_path / name, tmp_path / f"of-{name}"
        assert main(["ros", "bag", str(run), "-o", str(bag)]) == 0
        assert bag.is_dir() == (name == "drive")
        assert main(["ros", "read", str(bag), "-o", str(back)]) == 0
        assert read_history(back).frames["x_m"][-1] == pytest.approx(crashing().frames["x_m"][-1])
        assert main(["score", str(back)]) == 0
    said = capsys.readouterr()
    assert "without --map nothing is known of lanes" in said.err
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["bag", "RUN", "-o", "RUN"], "exists already; name another place"),
        (["bag", "none", "-o", "x"], "is no run folder"),
        (["read", "none", "-o", "x"], "is not there"),
        (["read", "RUN", "-o", "RUN"], "exists already"),
        (["read", "RUN", "-o", "x"], "cannot be read"),
        (["read", "RUN", "-o", "x", "--routes", "r.xml"], "give the map with --map"),
        (["read", "RUN", "-o", "x", "--width", "-1"], "lengths in m, above 0"),
    ],
)
def test_what_cannot_be_done_is_a_sentence(
    words: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "RUN").mkdir()
    write_history(tmp_path / "RUN", crashing())
    assert main(["ros", *words]) == 2
    assert says in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["RUN"]
