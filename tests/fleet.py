"""Vehicles and worlds that the tests of the physics share."""

from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.physics.step import advance
from linden.protocol.values.control import Gear, VehiclePhysicsControl, Wheel
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector2D, Vector3D

slow_uncompiled = pytest.mark.slow if numba.config.DISABLE_JIT else pytest.mark.filterwarnings()
"""Marks what takes seconds where kernels run as plain Python (NUMBA_DISABLE_JIT=1, to measure coverage), only there."""


def seeds(count: int) -> list[Any]:
    """The numbers below ``count``; where kernels run as plain Python the first alone, which takes the same lines."""
    return [0, *(pytest.param(number, marks=slow_uncompiled) for number in range(1, count))]


def column(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values as a column of bodies: the rows lie apart, and there are two or more.

    For rows without a gap numba compiles a kernel anew.
    """
    held = np.zeros(max(2, len(values)), [("column", np.float64, values.shape[1:]), ("other", np.float64)])
    held["column"][: len(values)] = values
    return held["column"]


FLAT = Ground.flat()
NOTHING = Statics.none()
G = 9.81

BOX = BoundingBox(Vector3D(0.0, 0.0, 0.719), Vector3D(2.451, 1.064, 0.755))
OFFSETS = tuple(Vector3D(x, y, 0.0) for x in (1.435, -1.435) for y in (-0.785, 0.785))
TORQUE = ((1000, 347), (1500, 523), (2000, 606), (3000, 695), (4000, 677), (5300, 607), (6500, 466))
STEERING = ((0, 1), (20, 0.9), (60, 0.8), (120, 0.7))
RATIOS = (4.584, 2.964, 1.912, 1.446, 1.0, 0.746)


def wheel(steer_deg: float, hand_brake_nm: float, **changes: Any) -> Wheel:
    return Wheel(3.5, 0.25, steer_deg, 35.5, 800.0, hand_brake_nm, 3.0, 20.0, 3000.0)._replace(**changes)


def wheels(**changes: Any) -> tuple[Wheel, ...]:
    front, rear = wheel(70.0, 0.0, **changes), wheel(0.0, 1600.0, **changes)
    return front, front, rear, rear


def sedan(**changes: Any) -> VehiclePhysicsControl:
    """The physics control of vehicle.lincoln.mkz_2017, from a recording of the original."""
    control = VehiclePhysicsControl(
        torque_curve=tuple(Vector2D(*point) for point in TORQUE),
        max_rpm=6500.0,
        moi=1.0,
        damping_rate_full_throttle=0.05,
        damping_rate_zero_throttle_clutch_engaged=2.0,
        damping_rate_zero_throttle_clutch_disengaged=0.35,
        gear_switch_time=0.5,
        clutch_strength=10.0,
        final_ratio=3.21,
        forward_gears=tuple(Gear(ratio, 0.23, 0.54) for ratio in RATIOS),
        mass=1696.0,
        drag_coefficient=0.3,
        center_of_mass=Vector3D(0.0, 0.0, -0.3),
        steering_curve=tuple(Vector2D(*point) for point in STEERING),
        wheels=wheels(),
    )
    return control._replace(**changes)


def slick(**changes: Any) -> VehiclePhysicsControl:
    """A car that nothing holds back but what a test adds: no drag, no engine or wheel damping."""
    plain = wheels(damping_rate=0.0)
    still = {"damping_rate_full_throttle": 0.0, "damping_rate_zero_throttle_clutch_engaged": 0.0}
    still |= {"damping_rate_zero_throttle_clutch_disengaged": 0.0, "drag_coefficient": 0.0}
    return sedan(**(still | {"wheels": plain} | changes))


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0, pitch: float = 0.0) -> Transform:
    return Transform(Vector3D(x, y, z), Rotation(pitch, yaw, 0.0))


def one(control: VehiclePhysicsControl | None = None, pose: Transform | None = None) -> tuple[Bodies, int]:
    bodies = Bodies()
    return bodies, bodies.add_vehicle(control or sedan(), pose or at(), BOX, OFFSETS)


def run(bodies: Bodies, seconds: float, dt_s: float = 0.01, ground: Ground = FLAT, statics: Statics = NOTHING) -> None:
    for _ in range(round(seconds / dt_s)):
        advance(bodies, ground, statics, dt_s)


def speed_mps(bodies: Bodies, slot: int) -> float:
    return float(np.linalg.norm(bodies.velocity[slot]))


def slope(rise: float) -> Ground:
    """A plane that climbs by ``rise`` per metre towards +x, a kilometre either way."""
    corners = [(x, y, rise * x) for x in (-1000.0, 1000.0) for y in (-1000.0, 1000.0)]
    return Ground.from_triangles(corners, [(0, 1, 2), (1, 3, 2)])


def wall(
    x: float, y: float = 0.0, half: tuple[float, float, float] = (0.5, 20.0, 2.0), yaw_rad: float = 0.0
) -> Statics:
    box = np.zeros(1, STATIC_BOX)
    box["centre"], box["half"], box["yaw_rad"], box["tag"], box["id"] = (x, y, half[2]), half, yaw_rad, 4, 77
    return Statics.of(box)
