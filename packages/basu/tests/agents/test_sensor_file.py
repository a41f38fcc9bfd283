"""Claims about sensor sets: the leaderboard's fields, attributes as blueprints spell them, sentences for mistakes."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.agents.sensor_file import check_sensors, parse_sensors, read_sensors
from basu.errors import UserError

GNSS = {"type": "sensor.other.gnss", "id": "GPS", "x": 0.7, "y": -0.4, "z": 1.6}


class Attribute:
    def __init__(self, name: str) -> None:
        self.id = name


class Blueprint(list[Attribute]):
    def __init__(self, blueprint_id: str, *attributes: str) -> None:
        super().__init__(Attribute(name) for name in attributes)
        self.id = blueprint_id


class Library:
    def filter(self, _wildcard: str) -> list[Blueprint]:
        return [Blueprint("sensor.other.gnss", "role_name", "noise_seed"), Blueprint("sensor.other.imu")]


def written(folder: Path, document: Any) -> Path:
    path = folder / "sensors.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return path


def test_a_set_is_a_list_or_stands_under_sensors(tmp_path: Path) -> None:
    (bare,) = read_sensors(written(tmp_path, [GNSS]))
    (named,) = read_sensors(written(tmp_path, {"sensors": [GNSS]}))
    assert bare == named
    assert (bare.type_id, bare.id, bare.x_m, bare.y_m, bare.z_m, bare.yaw_deg) == (
        GNSS["type"],
        "GPS",
        0.7,
        -0.4,
        1.6,
        0.0,
    )
    assert bare.attributes == ()


def test_other_fields_are_attributes_in_the_spelling_of_blueprints(tmp_path: Path) -> None:
    entry = {**GNSS, "noise_seed": 7, "sensor_tick": 0.1, "flag": True}
    (spec,) = read_sensors(written(tmp_path, [entry]))
    assert spec.attributes == (("noise_seed", "7"), ("sensor_tick", "0.1"), ("flag", "true"))


@pytest.mark.parametrize(
    ("name", "ids"),
    [
        ("sensors.json", ["GNSS", "IMU", "COLLISION", "LANE_INVASION"]),
        ("rig.json", ["LEFT", "FRONT", "RIGHT", "LIDAR", "RADAR", "GNSS", "IMU"]),
    ],
)
def test_the_sets_that_come_with_basu_can_be_read(name: str, ids: list[str]) -> None:
    path = Path(__file__).parents[4] / "packages" / "basu" / "src" / "basu" / "config" / name
    assert [spec.id for spec in read_sensors(path)] == ids


def test_the_leaderboards_names_stand_for_attributes() -> None:
    camera = {"type": "sensor.camera.rgb", "id": "FRONT", "width": 800, "height": 600, "fov": 100}
    radar = {"type": "sensor.other.radar", "id": "RADAR", "fov": 30}
    seen, echoes = parse_sensors([camera, radar], "sensors() of Test")
    assert seen.attributes == (("image_size_x", "800"), ("image_size_y", "600"), ("fov", "100"))
    assert echoes.attributes == (("horizontal_fov", "30"), ("vertical_fov", "30"))


@pytest.mark.parametrize(
    ("document", "sentence"),
    [
        pytest.param("{", "is no JSON", id="no JSON"),
        pytest.param({"x": 1}, "holds no list of sensors", id="no list"),
        pytest.param([{"type": "sensor.other.gnss"}], "sensor 1 needs a 'type' and an 'id'", id="no id"),
        pytest.param(["gnss"], "sensor 1 needs a 'type' and an 'id'", id="no entry"),
        pytest.param([{**GNSS, "x": "left"}], "sensor 'GPS' has x = 'left'; it must be a number", id="no number"),
        pytest.param([GNSS, GNSS], "the id 'GPS' is given twice", id="double"),
    ],
)
def test_a_mistake_gets_a_sentence(tmp_path: Path, document: Any, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        read_sensors(written(tmp_path, document))


def test_a_missing_file_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_sensors(tmp_path / "none.json")


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ({**GNSS, "type": "sensor.other.gns"}, "which the simulator does not have; did you mean 'sensor.other.gnss'"),
        ({**GNSS, "noise_sed": 1}, "has no attribute 'noise_sed'; did you mean 'noise_seed'"),
    ],
)
def test_what_the_simulator_does_not_have_gets_a_sentence(tmp_path: Path, entry: Any, sentence: str) -> None:
    path = written(tmp_path, [entry])
    with pytest.raises(UserError, match=sentence):
        check_sensors(read_sensors(path), Library(), f"sensor file {path}")
