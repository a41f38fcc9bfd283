"""Claims about the figures of a drive in the page."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.managers.base_manager import Ego
from basu_window.browser.pace import Meter
from basu_window.browser.readings import (
    GRAVITY_MPS2,
    DriveSetting,
    Fix,
    Inertial,
    Readings,
    clock,
    felt,
    fix_of,
    heading_deg,
    note_of,
    sensor_words,
    signed,
    true_latitude_deg,
    weather_words,
)
from linden_window.measured import compass_point

STILL = Ego(*[0.0] * 15)


@pytest.mark.parametrize(
    ("yaw_deg", "heading", "point"), [(0, 90, "E"), (-90, 0, "N"), (90, 180, "S"), (180, 270, "W"), (-135, 315, "NW")]
)
def test_the_compass_counts_from_north(yaw_deg: float, heading: float, point: str) -> None:
    assert heading_deg(math.radians(yaw_deg)) == pytest.approx(heading)
    assert compass_point(heading) == point


def test_just_west_of_north_is_north() -> None:
    assert compass_point(359.0) == "N"


def test_what_is_felt_is_in_the_vehicles_axes_and_has_gravity() -> None:
    assert felt(STILL).acceleration_mps2 == (0.0, 0.0, GRAVITY_MPS2)
    south = STILL._replace(yaw_rad=math.pi / 2, acceleration_y_mps2=2.0, acceleration_x_mps2=1.0)
    ahead, right, _ = felt(south).acceleration_mps2
    assert (ahead, right) == pytest.approx((2.0, -1.0))  # driving south, the east is on the left
    assert felt(STILL._replace(angular_velocity_z_radps=math.pi)).spin_degps[2] == pytest.approx(180.0)


def test_figures_are_written_for_readers() -> None:
    assert clock(125.04) == "2:05.0"
    assert signed((-0.04, 0.26, -1.0)) == "+0.0, +0.3, -1.0"


HEAD = (
    '<OpenDRIVE><header revMajor="1" revMinor="4"><geoReference><![CDATA[+proj=tmerc +lat_0=40.0 +lon_0=-83.0 '
    "+k=0.9996 +x_0=0 +y_0=0 +ellps=WGS84 +units=m]]></geoReference></header>"
    '<road name="r" length="10" id="1" junction="-1"><planView><geometry s="0" x="0" y="0" hdg="0" length="10"><line/>'
    '</geometry></planView><lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right><lane id="-1" '
    'type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/></lane></right></laneSection></lanes></road>'
    "</OpenDRIVE>"
)


def test_the_clients_latitude_grows_southwards_and_ours_does_not() -> None:
    town = carla.Map("town", HEAD)
    north = carla.Location(0.0, -1000.0, 0.0)  # CARLA's y points south
    wire = town.transform_to_geolocation(north)
    assert wire.latitude < 40.0, "the official client mirrors; where it does not any more, this page can go"
    assert fix_of(town, wire, north).latitude_deg == pytest.approx(40.0 + 1000.0 / 111_195.0, abs=1e-4)


def test_a_receivers_noise_stays_in_its_true_latitude() -> None:
    town = carla.Map("town", HEAD)
    exact = town.transform_to_geolocation(carla.Location(300.0, 500.0, 0.0)).latitude
    shown = [true_latitude_deg(town, exact + noise, 300.0, 500.0) for noise in (0.0, 1e-5)]
    assert shown[1] - shown[0] == pytest.approx(1e-5)
    assert shown[0] < 40.0


def test_a_client_that_has_latitude_grow_northwards_is_left_as_it_is() -> None:
    town: Any = SimpleNamespace(transform_to_geolocation=lambda at: SimpleNamespace(latitude=40.0 - at.y / 111_195.0))
    assert true_latitude_deg(town, 40.1, 0.0, -11_119.5) == 40.1


def test_a_preset_has_its_name_and_other_weather_its_figures() -> None:
    assert weather_words(carla.WeatherParameters.WetCloudySunset) == "WetCloudySunset"
    own = carla.WeatherParameters(sun_altitude_angle=-6.0, fog_density=10.0, precipitation=0.0)
    assert weather_words(own) == "sun -6°, fog 10 %"


def test_a_sensor_set_is_known_by_kinds() -> None:
    types = {
        "A": "sensor.camera.rgb",
        "B": "sensor.camera.depth",
        "C": "sensor.lidar.ray_cast",
        "D": "sensor.other.imu",
    }
    assert sensor_words(types) == "2 cameras, lidar, IMU"
    assert sensor_words({}) == "none"


def test_rates_are_those_of_the_last_two_seconds() -> None:
    meter = Meter()
    for n in range(41):
        meter.tick(n * 0.5)
    for n in range(101):
        meter.tick(20.0 + n * 0.02)
    assert meter.ticks_per_s == pytest.approx(50.0, rel=0.02)
    assert Meter().ticks_per_s == 0.0


SHOWN = Readings(
    vehicle="vehicle.tesla.model3",
    driver="agent",
    setting=DriveSetting("Linden", "leap", "ClearSunset", "3 cameras, lidar, GNSS, IMU"),
    traffic=(40, 12),
    ticks_per_s=21.4,
    real_time=1.07,
    simulated_s=65.0,
    wall_s=13.0,
    speed_mps=13.0,
    limit_mps=11.176,
    gear=-1,
    control=carla.VehicleControl(throttle=0.5, steer=-0.25, hand_brake=True, reverse=True),
    heading_deg=44.0,
    at_m=(1.0, 2.0, 3.0),
    fix=Fix(39.99, -82.97, 249.0),
    inertial=Inertial((0.0, 0.0, 9.81), (0.0, 0.0, 0.0)),
    lateral_m=-0.1,
    impulses_ns=(0.0, 120.04),
    tally=("1 x collision static",),
    nearby=tuple((f"vehicle.audi.tt{n}", 5.0 + n) for n in range(16)),
)


def lines_of(shown: Readings) -> dict[str, dict[str, Any]]:
    return {line["name"]: line for group in note_of(shown, "basic")["groups"] for line in group["lines"]}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("driver", "agent (basic)"),
        ("map, route", "Linden, leap"),
        ("weather", "ClearSunset"),
        ("sensors", "3 cameras, lidar, GNSS, IMU"),
        ("traffic", "40 vehicles, 12 walkers"),
        ("speed", "29 mph, 47 km/h"),
        ("limit", "25 mph"),
        ("throttle", "0.50"),
        ("steer", "-0.25"),
        ("gear", "R, reverse, hand brake"),
        ("heading", "44° NE"),
        ("location", "1.0, 2.0, 3.0 m"),
        ("GNSS", "39.990000° N, 82.970000° W"),
        ("acceleration", "+0.0, +0.0, +9.8 m/s²"),
        ("turn rate", "+0.0, +0.0, +0.0 °/s"),
        ("off the route", "-0.10 m"),
        ("simulated, wall", "1:05.0, 0:13.0"),
        ("server", "21 steps/s, 1.1x real time"),
        ("audi.tt0", "5 m"),
    ],
)
def test_each_figure_has_a_line(name: str, value: str) -> None:
    assert lines_of(SHOWN)[name]["value"] == value


def test_the_five_nearest_actors_the_collisions_and_the_tally_are_in_the_note() -> None:
    note = note_of(SHOWN, "basic")
    assert len(note["groups"][-1]["lines"]) == 5
    assert (note["impulses"], note["tally"]) == ([0.0, 120.0], ("1 x collision static",))


def test_the_limit_turns_red_where_it_is_exceeded() -> None:
    assert lines_of(SHOWN)["speed"]["bad"]
    assert not lines_of(SHOWN._replace(speed_mps=11.0))["speed"]["bad"]
    free = lines_of(SHOWN._replace(limit_mps=None))
    assert (free["limit"]["value"], free["speed"]["bad"]) == ("none", False)
