"""The rows of the table of sensors.py: which sensors a car carries, and how long a frame is."""

from collections.abc import Mapping
from typing import NamedTuple

STEP_S = 0.05
TURN_S = 0.1
"""A frame in which a lidar of 10 Hz turns once."""
CAR = "vehicle.tesla.model3"
OTHERS = ("vehicle.audi.tt", "vehicle.lincoln.mkz_2020", "vehicle.nissan.patrol", "vehicle.mini.cooper_s", CAR)
THROTTLE = 0.3


class Sensor(NamedTuple):
    """What to attach to the roof: its blueprint, what it asks for, and where it looks to."""

    blueprint: str
    chosen: Mapping[str, str]
    yaw_deg: float = 0.0
    x_m: float = 0.5
    z_m: float = 2.0


class Row(NamedTuple):
    """A line of the table: its sensors, all measured in every frame."""

    name: str
    sensors: tuple[Sensor, ...]
    step_s: float = STEP_S


def camera(kind: str, width_px: int, height_px: int, yaw_deg: float = 0.0) -> Sensor:
    """Return a camera."""
    chosen = {"image_size_x": str(width_px), "image_size_y": str(height_px)}
    return Sensor(f"sensor.camera.{kind}", chosen, yaw_deg)


def lidar(kind: str, channels: int, points_per_s: int) -> Sensor:
    """Return a lidar of 10 Hz."""
    chosen = {
        "channels": str(channels),
        "points_per_second": str(points_per_s),
        "rotation_frequency": "10",
        "range": "100",
    }
    return Sensor(f"sensor.lidar.{kind}", chosen, z_m=2.4)


def rows() -> tuple[Row, ...]:
    """Return the lines of the table."""
    pictures = [
        Row(f"{kind} {width} x {height}", (camera(kind, width, height),))
        for kind in ("rgb", "depth", "semantic_segmentation")
        for width, height in ((800, 600), (1280, 720))
    ]
    around = Row("six rgb 800 x 600", tuple(camera("rgb", 800, 600, yaw_deg) for yaw_deg in range(0, 360, 60)))
    lidars = [
        Row("lidar, 32 channels, a turn", (lidar("ray_cast", 32, 560_000),), TURN_S),
        Row("lidar, 64 channels, a turn", (lidar("ray_cast", 64, 1_300_000),), TURN_S),
        Row("semantic lidar, 64, a turn", (lidar("ray_cast_semantic", 64, 1_300_000),), TURN_S),
    ]
    rig = Row(
        "rig: 3 rgb, lidar 64, radar, gnss, imu",
        (
            *(camera("rgb", 800, 600, yaw_deg) for yaw_deg in (-60.0, 0.0, 60.0)),
            lidar("ray_cast", 64, 1_300_000),
            Sensor("sensor.other.radar", {}, x_m=2.4, z_m=0.7),
            Sensor("sensor.other.gnss", {}),
            Sensor("sensor.other.imu", {}),
        ),
    )
    return (*pictures, around, *lidars, rig)


class Figures(NamedTuple):
    """What a frame of a row took, ms: by the clock, of the server's processor, and how many bytes came of it."""

    wall_ms: float
    server_ms: float
    mib: float


def head() -> str:
    """Return the head of the table."""
    return (
        f"{'sensors of a frame':<40}{'frame s':>8}{'wall ms':>9}{'frames/s':>10}{'real time':>11}"
        f"{'server ms':>11}{'MiB':>7}"
    )


def line(row: Row, found: Figures) -> str:
    """Return a line of the table; "real time" is simulated time by the clock's."""
    return (
        f"{row.name:<40}{row.step_s:>8.2f}{found.wall_ms:>9.2f}{1000.0 / found.wall_ms:>10.1f}"
        f"{1000.0 * row.step_s / found.wall_ms:>10.2f}x{found.server_ms:>11.1f}{found.mib:>7.2f}"
    )
