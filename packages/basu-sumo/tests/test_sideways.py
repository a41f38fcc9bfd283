"""Claims about what is shown of vehicles that SUMO moves aside within one step."""

import itertools
import math

import pytest

from basu_sumo.frames import Pose
from basu_sumo.sideways import Sideways

STEP_S = 0.05


def shown(places_m: list[tuple[float, float]], yaw_deg: float = 0.0) -> list[Pose]:
    sideways = Sideways(STEP_S)
    yaw = math.radians(yaw_deg)
    turned = [(x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)) for x, y in places_m]
    return [sideways.shown("one", Pose(x_m, y_m, 0.0, 0.0, yaw_deg)) for x_m, y_m in turned]


def steps_m(poses: list[Pose]) -> list[float]:
    return [math.dist(one[:2], other[:2]) for one, other in itertools.pairwise(poses)]


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, 200.0])
def test_a_vehicle_that_parks_glides_to_its_space(yaw_deg: float) -> None:
    poses = shown([(0.0, 0.0)] + [(0.0, 3.0)] * 100, yaw_deg)
    assert max(steps_m(poses)) == pytest.approx(STEP_S * 1.0)
    assert math.dist(poses[30][:2], poses[0][:2]) == pytest.approx(1.5)
    assert math.dist(poses[-1][:2], poses[0][:2]) == pytest.approx(3.0), "it ends where SUMO has it"
    assert poses[-1].yaw_deg == yaw_deg


@pytest.mark.parametrize("aside_m", [3.3, -3.3])
def test_a_change_of_lanes_at_speed_takes_seconds_and_points_where_it_goes(aside_m: float) -> None:
    poses = shown([(0.5 * n, 0.0 if n < 10 else aside_m) for n in range(120)])
    aside = [abs(other.y_m - one.y_m) for one, other in itertools.pairwise(poses)]
    assert max(aside) == pytest.approx(STEP_S * 1.2)
    assert poses[40].yaw_deg == pytest.approx(math.copysign(math.degrees(math.atan2(0.06, 0.5)), aside_m))
    assert (poses[-1].y_m, poses[-1].yaw_deg) == pytest.approx((aside_m, 0.0))
    turns = [abs(other.yaw_deg - one.yaw_deg) for one, other in itertools.pairwise(poses)]
    assert max(turns) <= 1.5 + 1e-9


def test_curves_and_other_places_are_shown_as_they_are() -> None:
    curve = [(10.0 * math.sin(n / 40), 10.0 - 10.0 * math.cos(n / 40)) for n in range(60)]
    sideways = Sideways(STEP_S)
    for number, (x_m, y_m) in enumerate(curve):
        pose = Pose(x_m, y_m, 0.0, 0.0, math.degrees(number / 40))
        assert sideways.shown("bus", pose) == pose
    far = Pose(500.0, 80.0, 0.0, 0.0, 0.0)
    assert sideways.shown("bus", far) == far, "another place is no movement"
