"""Claims about what the instruments show."""

import math

import pytest

from basu.managers.base_manager import Ego
from basu.output.hud.panel import clock, signed
from basu.output.hud.readings import GRAVITY_MPS2, compass_point, felt, heading_deg

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
