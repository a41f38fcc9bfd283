"""Tests of ``basu.records.placed_motion``."""

import math
from typing import NamedTuple

import carla
import pytest

from basu.records.placed_motion import AT_REST, PlacedMotion, PlanarMotion


class Snapshot(NamedTuple):
    """What is read of an actor's part of a world snapshot."""

    id: int = 7
    velocity: tuple[float, float] = (0.0, 0.0)
    yaw_rate_degps: float = 0.0

    def get_velocity(self) -> carla.Vector3D:
        return carla.Vector3D(*self.velocity, 0.0)

    def get_angular_velocity(self) -> carla.Vector3D:
        return carla.Vector3D(0.0, 0.0, self.yaw_rate_degps)


def pose(x_m: float, y_m: float = 0.0, yaw_deg: float = 0.0) -> carla.Transform:
    return carla.Transform(carla.Location(x_m, y_m, 0.0), carla.Rotation(0.0, yaw_deg, 0.0))


def test_a_vehicle_that_is_put_to_its_places_moves_as_they_show() -> None:
    motion = PlacedMotion()
    assert motion.of(Snapshot(), pose(10.0), 1.0) == AT_REST
    found = motion.of(Snapshot(), pose(10.4, -0.1, 2.0), 1.05)
    assert found == pytest.approx((8.0, -2.0, math.radians(40.0)), rel=1e-4)
    assert motion.of(Snapshot(), pose(10.4, -0.1, 2.0), 1.05) == found  # asked twice in one frame
    assert motion.of(Snapshot(), pose(10.4, -0.1, 2.0), 1.10) == AT_REST


def test_the_simulators_own_velocity_comes_first() -> None:
    motion = PlacedMotion()
    motion.of(Snapshot(), pose(10.0), 1.0)
    moving = Snapshot(velocity=(3.0, 0.5), yaw_rate_degps=10.0)
    assert motion.of(moving, pose(10.4), 1.05) == pytest.approx((3.0, 0.5, math.radians(10.0)))


def test_a_turn_over_the_seam_of_angles_is_a_small_one() -> None:
    motion = PlacedMotion()
    motion.of(Snapshot(), pose(0.0, 0.0, 179.0), 1.0)
    assert motion.of(Snapshot(), pose(0.0, 0.0, -179.0), 1.1).yaw_rate_radps == pytest.approx(
        math.radians(20.0), rel=1e-4
    )


@pytest.mark.parametrize(("x_m", "t_s"), [(100.0, 1.05), (10.4, 0.05)])
def test_a_jump_and_a_new_episode_are_no_motion(x_m: float, t_s: float) -> None:
    motion = PlacedMotion()
    motion.of(Snapshot(), pose(10.0), 1.0)
    assert motion.of(Snapshot(), pose(x_m), t_s) == PlanarMotion(0.0, 0.0, 0.0)
