"""Claims about the leaderboard's rules on sensors; each set that gains by breaking one is refused by a sentence."""

from dataclasses import replace
from typing import Any

import pytest

from basu.agents.sensor_file import SensorSpec, parse_sensors
from basu.conditions import LeaderboardTrack
from basu.errors import UserError
from basu_leaderboard.foreign_class import Dialect
from basu_leaderboard.provided.leaderboard_agent import Track
from basu_leaderboard.sensor_sets import translated
from basu_leaderboard.tracks import TrackRules, check_declared

CAMERA = {"type": "sensor.camera.rgb", "x": 1.0, "y": 0.0, "z": 2.0, "width": 800, "height": 600, "fov": 90}
LIDAR = {"type": "sensor.lidar.ray_cast", "x": 0.0, "y": 0.0, "z": 2.5}
RADAR = {"type": "sensor.other.radar", "x": 2.0, "y": 0.0, "z": 1.0, "horizontal_fov": 30, "vertical_fov": 30}
GNSS, IMU = {"type": "sensor.other.gnss"}, {"type": "sensor.other.imu"}
MAP = {"type": "sensor.opendrive_map", "reading_frequency": 1}
SPEED = {"type": "sensor.speedometer", "reading_frequency": 20}


def asked(*entries: dict[str, Any]) -> tuple[SensorSpec, ...]:
    """The sensors as the benchmark receives them from an adapted agent."""
    named = [{**entry, "id": f"S{number}"} for number, entry in enumerate(entries)]
    found = translated(named, Dialect.LEADERBOARD_2, "sensors() of An")
    pseudo = [{"id": name, "type": kind} for name, kind in found.pseudo.items()]
    return parse_sensors([*found.entries, *pseudo], "sensors() of An")


def refusal(track: LeaderboardTrack, *entries: dict[str, Any]) -> str:
    with pytest.raises(UserError) as refused:
        TrackRules(track).admit(asked(*entries), "sensors() of An")
    return str(refused.value)


FULL = (*[CAMERA] * 8, *[LIDAR] * 2, *[RADAR] * 4, GNSS, IMU, SPEED)


def test_the_largest_set_of_each_track_is_admitted_without_what_no_simulator_has() -> None:
    rules = TrackRules("MAP")
    admitted = rules.admit(asked(*FULL, MAP), "an agent")
    assert len(admitted) == 16
    assert rules.document()["sensors"] == [spec.type_id for spec in asked(*FULL, MAP)]
    assert len(TrackRules("SENSORS").admit(asked(*FULL), "an agent")) == 16
    assert len(TrackRules("SENSORS_QUALIFIER").admit(asked(*[CAMERA] * 4, LIDAR, RADAR, RADAR), "an agent")) == 7


@pytest.mark.parametrize(
    ("track", "sensors", "words"),
    [
        ("SENSORS", [CAMERA] * 9, "takes at most 8 sensor.camera.rgb, and these are 9; leave 1 out"),
        ("SENSORS_QUALIFIER", [CAMERA] * 5, "takes at most 4 sensor.camera.rgb"),
        ("MAP", [LIDAR] * 3, "takes at most 2 sensor.lidar.ray_cast"),
        ("MAP_QUALIFIER", [LIDAR] * 2, "takes at most 1 sensor.lidar.ray_cast"),
        ("SENSORS", [RADAR] * 5, "takes at most 4 sensor.other.radar"),
        ("SENSORS", [SPEED] * 2, "takes at most 1 sensor.speedometer"),
        ("MAP", [MAP] * 2, "takes at most 1 sensor.opendrive_map"),
        ("SENSORS", [MAP], "gives no map, and 'S0' (sensor.opendrive_map) is one"),
        ("SENSORS_QUALIFIER", [MAP], "gives no map"),
        ("SENSORS", [{**CAMERA, "type": "sensor.camera.depth"}], "has no sensor of the type of 'S0'"),
        ("MAP", [{**CAMERA, "type": "sensor.camera.semantic_segmentation"}], "has no sensor of the type"),
        ("MAP", [{"type": "sensor.other.collision"}], "has no sensor of the type"),
        ("SENSORS", [{**CAMERA, "z": 3.01, "x": 0.0}], "within 3 m of the vehicle's origin, and 'S0'"),
        ("MAP", [{**LIDAR, "x": 2.0, "y": 2.0, "z": 2.0}], "is 3.46 m away; mount it nearer"),
    ],
)  # fmt: skip
def test_a_set_that_breaks_a_rule_is_refused_with_the_rule(
    track: LeaderboardTrack, sensors: list[dict[str, Any]], words: str
) -> None:
    said = refusal(track, *sensors)
    assert said.startswith(f"sensors() of An: the leaderboard's track {track} ")
    assert words in said


def test_an_agent_that_changes_the_adapter_in_its_own_process_sees_no_farther() -> None:
    (lidar,) = asked(LIDAR)
    attributes = tuple((name, "300" if name == "range" else value) for name, value in lidar.attributes)
    with pytest.raises(UserError, match=r"sets range = 85 for every sensor\.lidar\.ray_cast, and 'S0' .* has 300"):
        TrackRules("SENSORS").admit((_with(lidar, attributes),), "an agent")
    without = tuple(pair for pair in lidar.attributes if pair[0] != "dropoff_general_rate")
    with pytest.raises(UserError, match=r"sets dropoff_general_rate = 0\.45"):
        TrackRules("SENSORS").admit((_with(lidar, without),), "an agent")
    (camera,) = asked(CAMERA)
    with pytest.raises(UserError, match="lets no agent set 'iso', and 'S0'"):
        TrackRules("SENSORS").admit((_with(camera, (*camera.attributes, ("iso", "50"))),), "an agent")
    (fix,) = asked(GNSS)
    exact = tuple((name, "0" if "stddev" in name else value) for name, value in fix.attributes)
    with pytest.raises(UserError, match="noise_alt_stddev"):
        TrackRules("SENSORS").admit((_with(fix, exact),), "an agent")


def _with(spec: SensorSpec, attributes: tuple[tuple[str, str], ...]) -> SensorSpec:
    return replace(spec, attributes=attributes)


def test_the_refusal_stands_in_the_document_of_the_run() -> None:
    rules = TrackRules("SENSORS")
    with pytest.raises(UserError):
        rules.admit(asked(MAP), "an agent")
    assert "gives no map" in str(rules.document()["refused"])


@pytest.mark.parametrize("declared", [Track.SENSORS, "SENSORS"])
def test_an_agent_takes_part_in_the_track_that_it_says(declared: object) -> None:
    check_declared(declared, "SENSORS", "An")
    with pytest.raises(UserError, match="An has track = 'SENSORS', and --leaderboard-track is MAP"):
        check_declared(declared, "MAP", "An")


def test_an_agent_without_a_track_gets_a_sentence() -> None:
    with pytest.raises(UserError, match="An has track = None"):
        check_declared(None, "MAP", "An")
