"""Claims about BASU's sensors in the fields of a host, which insists on all of them."""

import logging

import pytest

from basu.agents.export.sensor_set import theirs
from basu.agents.leaderboard.foreign import Dialect
from basu.agents.leaderboard.sensor_sets import LIDAR_OF_SCENARIO_RUNNER, translated
from basu.agents.sensor_file import parse_sensors, read_sensors
from basu.utils.packaged import PACKAGE_FOLDER

RIG = read_sensors(PACKAGE_FOLDER / "config" / "rig.json")
POSE = {"x": 0.0, "y": 0.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}


def test_every_entry_has_its_whole_pose() -> None:
    entries, _ = theirs(RIG)
    assert len(entries) == len(RIG)
    assert all(entry.keys() >= POSE.keys() for entry in entries)


def test_what_is_told_is_what_the_leaderboards_agents_tell() -> None:
    entries, _ = theirs(RIG)
    for dialect in Dialect:
        assert len(translated(entries, dialect, "the rig").entries) == len(RIG)
    (lidar,) = (entry for entry in entries if entry["type"] == "sensor.lidar.ray_cast")
    assert lidar.keys() >= set(LIDAR_OF_SCENARIO_RUNNER)


def test_a_camera_without_size_has_carlas() -> None:
    ((camera,), _) = theirs(parse_sensors([{"type": "sensor.camera.rgb", "id": "C", "fov": 70}], "s"))
    assert camera == {"type": "sensor.camera.rgb", "id": "C", **POSE, "width": 800, "height": 600, "fov": 70.0}


def test_a_radar_has_both_its_angles() -> None:
    ((radar,), _) = theirs(parse_sensors([{"type": "sensor.other.radar", "id": "R", "horizontal_fov": 40}], "s"))
    assert (radar["horizontal_fov"], radar["vertical_fov"]) == (40.0, 30.0)


def test_what_the_host_does_not_serve_is_left_out_and_logged(caplog: pytest.LogCaptureFixture) -> None:
    specs = parse_sensors(
        [{"type": "sensor.other.collision", "id": "BUMP"}, {"type": "sensor.other.gnss", "id": "G"}], "s"
    )
    with caplog.at_level(logging.WARNING, logger="basu"):
        entries, served = theirs(specs)
    assert [entry["id"] for entry in entries] == list(served) == ["G"]
    assert "the host serves no sensor.other.collision: sensor 'BUMP' is left out" in caplog.text
