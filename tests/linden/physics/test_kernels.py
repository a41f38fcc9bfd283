"""Each formula against a slower one that says the same."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fleet import TORQUE, sedan
from linden.errors import Refusal
from linden.geometry import rotation_matrix
from linden.physics import warm_up
from linden.physics.axes import plane_axes, within_turn
from linden.physics.vehicle.chassis import _solve_symmetric
from linden.physics.vehicle.parameters import check
from linden.physics.vehicle.powertrain import on_curve as kernel_curve
from linden.physics.vehicle.tyre import brush_force, cornering_stiffness, secant_stiffness
from linden.values.space import Rotation
from naive.physics import brush, on_curve

angle = st.floats(-3.0, 3.0)


@given(st.floats(0.0, 6.0))
def test_the_tyre_is_a_row_of_bristles(use: float) -> None:
    assert brush_force(use) == pytest.approx(brush(use), abs=2e-3)


@given(
    st.floats(-30, 30),
    st.floats(-30, 30),
    st.floats(-50, 50),
    st.floats(1e3, 1e5),
    st.floats(1e3, 2e5),
    st.floats(1, 2e4),
)
def test_the_tyre_opposes_sliding_within_its_circle(
    x: float, y: float, travel: float, slip: float, corner: float, limit: float
) -> None:
    along, across = secant_stiffness(x, y, travel, slip, corner, limit)
    assert min(along, across) > 0.0
    assert math.hypot(along * x, across * y) <= limit * (1.0 + 1e-9)


def test_for_small_slips_the_tyre_is_linear() -> None:
    along, across = secant_stiffness(1e-6, -1e-6, 20.0, 3e4, 8e4, 1e4)
    assert (along, across) == (pytest.approx(3e4 / 20.0, rel=1e-4), pytest.approx(8e4 / 20.0, rel=1e-4))


def test_a_sliding_tyre_pushes_against_its_motion_with_all_its_friction() -> None:
    along, across = secant_stiffness(-3.0, 4.0, 0.1, 3e4, 8e4, 5e3)
    assert (along * -3.0, across * 4.0) == (pytest.approx(-3e3), pytest.approx(4e3))


def test_a_tyre_without_load_has_no_force() -> None:
    assert secant_stiffness(1.0, 1.0, 10.0, 3e4, 8e4, 0.0) == (0.0, 0.0)
    assert cornering_stiffness(20.0, 3.0, 0.0, 0.0) == 0.0


def test_cornering_stiffness_grows_with_the_load_and_levels_off() -> None:
    stiffness = [cornering_stiffness(20.0, 2.0, load, 4000.0) for load in (0.0, 2000.0, 4000.0, 8000.0, 16000.0)]
    assert stiffness == sorted(stiffness)
    assert stiffness[-2] == stiffness[-1] == 80_000.0


@given(st.floats(-100.0, 8000.0))
def test_a_curve_is_read_between_its_points(x: float) -> None:
    xs, ys = (np.array(column, float) for column in zip(*TORQUE, strict=True))
    assert kernel_curve(x, xs, ys, len(xs)) == pytest.approx(on_curve(x, TORQUE))


@given(angle, angle, angle)
def test_the_axes_are_those_of_the_rotation_matrix(pitch: float, yaw: float, roll: float) -> None:
    matrix = rotation_matrix(Rotation(*(math.degrees(a) for a in (pitch, yaw, roll))))
    nose, side = plane_axes(pitch, yaw, roll)
    assert nose == pytest.approx(matrix[:, 0], abs=1e-12)
    assert side == pytest.approx(matrix[:, 1], abs=1e-12)


@given(st.floats(-1e4, 1e4))
def test_an_angle_is_brought_within_a_turn(a: float) -> None:
    assert -math.pi <= within_turn(a) < math.pi
    assert math.cos(within_turn(a) - a) == pytest.approx(1.0)


def test_three_equations_are_solved_as_numpy_solves_them() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        root = rng.normal(size=(3, 3))
        matrix, right = root @ root.T + 0.1 * np.eye(3), rng.normal(size=3)
        assert _solve_symmetric(*matrix[np.triu_indices(3)], *right) == pytest.approx(
            np.linalg.solve(matrix, right), rel=1e-7, abs=1e-9
        )


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"mass": 0.0}, "mass"),
        ({"mass": math.nan}, "nan"),
        ({"wheels": ()}, "wheels"),
        ({"forward_gears": ()}, "gears"),
        ({"torque_curve": ()}, "torque_curve"),
        ({"wheels": tuple(wheel._replace(radius=0.0) for wheel in sedan().wheels)}, "radius"),
    ],
)
def test_what_cannot_drive_is_refused_with_a_sentence(changes: dict, reason: str) -> None:
    with pytest.raises(Refusal, match=reason):
        check(sedan(**changes))


def test_warming_up_compiles_and_leaves_nothing_behind() -> None:
    warm_up()
