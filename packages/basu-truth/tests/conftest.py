"""A truth without a simulator, and a staged run with its export."""

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from basu.cli import main
from basu_truth.truth import Pose, Rectangle, SeenObject, Sensor, Truth, TruthFrame, write_truth
from staged_run import stage

CLEAR = {"sun_altitude_angle": 45.0, "precipitation": 0.0, "fog_density": 2.0}
NIGHT_RAIN = {"sun_altitude_angle": -30.0, "precipitation": 60.0, "fog_density": 0.0}
FRAMES = 6


@pytest.fixture
def truth() -> Truth:
    """Return two cars and a walker before a camera and a lidar in six frames, the last three at night in rain."""
    seen = [
        _seen(frame, sensor, track, category, place)
        for frame in range(1, FRAMES + 1)
        for sensor in ("FRONT", "TOP")
        for place, (track, category) in enumerate(((7, "car"), (8, "car"), (9, "pedestrian")))
    ]
    return Truth(
        run="made",
        town="Linden",
        step_s=0.05,
        every=1,
        sensors=(
            Sensor(
                id="FRONT",
                type_id="sensor.camera.rgb",
                pose=Pose(2.0, 0.0, 2.0, 0.0, 0.0, 0.0),
                width_px=640,
                height_px=400,
                fov_deg=90.0,
            ),
            Sensor(id="TOP", type_id="sensor.lidar.ray_cast", pose=Pose(0.0, 0.0, 3.0, 0.0, 0.0, 0.0)),
        ),
        frames=tuple(
            TruthFrame(
                number=number,
                t_s=round(0.05 * (number - 1), 6),
                ego=Pose(0.5 * number, 0.0, 0.0, 0.0, 0.0, 0.0),
                weather=CLEAR if number <= FRAMES // 2 else NIGHT_RAIN,
            )
            for number in range(1, FRAMES + 1)
        ),
        objects=tuple(seen),
    )


def _seen(frame: int, sensor: str, track: int, category: str, place: int) -> SeenObject:
    """Return an object: the first 10 m away and whole, the second 30 m and half hidden, the third 90 m and whole."""
    distance_m = (10.0, 30.0, 90.0)[place]
    box = Pose(0.5 * frame + 2.0 + distance_m, -4.0 + 4.0 * place, 1.0, 0.0, 0.0, 10.0)
    of_lidar = sensor == "TOP"
    in_sensor = box._replace(x_m=distance_m + (2.0 if of_lidar else 0.0), z_m=-2.0 if of_lidar else -1.0)
    object_ = SeenObject(
        frame=frame,
        sensor=sensor,
        track=track,
        category=category,
        model="vehicle.audi.a2",
        box=box,
        box_in_sensor=in_sensor,
        size_m=(4.0, 1.8, 1.5) if category == "car" else (0.4, 0.4, 1.8),
        velocity_mps=(1.0, 0.5, 0.0),
        distance_m=distance_m,
        visible=100,
        whole=200 if place == 1 else 100,
    )
    if of_lidar:
        return replace(object_, cloud_points=60)
    rectangle = Rectangle(60.0 + 150.0 * place, 100.0, 50.0, 40.0)
    return replace(object_, rectangle=rectangle, whole_rectangle=rectangle, truncation=0.0)


@pytest.fixture
def folder(tmp_path: Path, truth: Truth) -> Path:
    """Return an export that has the truth alone."""
    place = tmp_path / "export"
    place.mkdir()
    write_truth(place, truth)
    return place


@pytest.fixture(scope="session")
def staged(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the staged run."""
    place = tmp_path_factory.mktemp("staged")
    stage(place)
    return place


@pytest.fixture(scope="session")
def exported(staged: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what exports the staged run in a format, each format once."""

    @functools.cache
    def export(name: str) -> Path:
        folder = tmp_path_factory.mktemp("exports") / name
        words = [
            "truth",
            "export",
            str(staged),
            "--format",
            name,
            "-o",
            str(folder),
            "--every",
            "1",
            "--timeout",
            "120",
        ]
        assert main(words) == 0
        return folder

    return export
