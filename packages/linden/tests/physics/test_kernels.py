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
from linden.physics.vehicle.driver import follow
from linden.physics.vehicle.parameters import check
from linden.physics.vehicle.powertrain import on_curve as kernel_curve
from linden.physics.vehicle.tyre import brush_force, cornering_stiffness, free_slip, tyre_push, worked_slip
from linden.physics.vehicle.wheels import grip_load
from linden.protocol.values.space import Rotation
from naive.physics import brush, on_curve

angle = st.floats(-3.0, 3.0)


@given(st.floats(0.0, 6.0))
def test_the_tyre_is_a_row_of_bristles(use: float) -> None:
    assert brush_force(use) == pytest.approx(brush(use), abs=2e-3)


@given(st.floats(-1, 1), st.floats(-20, 20), st.floats(1e3, 1e5), st.floats(1e3, 2e5), st.floats(1, 2e4))
def test_the_tyre_opposes_sliding_within_its_circle(
    slip: float, tangent: float, stiff: float, corner: float, limit: float
) -> None:
    along, across = tyre_push(slip, tangent, stiff, corner, limit)
    assert along * slip >= 0.0 >= across * tangent
    assert math.hypot(along, across) <= limit * (1.0 + 1e-9)


def test_for_small_slips_the_tyre_is_linear() -> None:
    along, across = tyre_push(1e-4, -1e-4, 3e4, 8e4, 1e4)
    assert (along, across) == (pytest.approx(3.0, rel=2e-3), pytest.approx(8.0, rel=2e-3))


def test_a_sliding_tyre_pushes_against_its_slip_with_all_its_friction() -> None:
    along, across = tyre_push(-0.6, 0.8, 6e5, 6e5, 5e3)
    assert (along, across) == (pytest.approx(-3e3), pytest.approx(-4e3))


def test_a_tyre_without_load_has_no_force() -> None:
    assert tyre_push(1.0, 1.0, 3e4, 8e4, 0.0) == (0.0, 0.0)
    assert cornering_stiffness(20.0, 3.0, 0.0, 0.0) == 0.0
    assert grip_load(0.0, 4000.0) == 0.0


@pytest.mark.parametrize(("rolling", "along", "sign"), [(0.0, 12.0, -1.0), (12.0, 0.0, 1.0)])
def test_slip_is_all_but_one_where_a_wheel_is_locked_or_spins_on_the_spot(
    rolling: float, along: float, sign: float
) -> None:
    assert worked_slip(rolling, along) == pytest.approx(sign * 12.0 / 12.1)


def test_a_wheel_that_merely_rolls_reacts_softly_when_slow() -> None:
    assert free_slip(0.4, 0.0) == pytest.approx(0.1)
    assert worked_slip(0.4, 0.0) == pytest.approx(0.8)


def test_small_loads_grip_more_than_their_share_and_great_ones_no_more_than_threefold() -> None:
    assert grip_load(1e-9, 4000.0) == pytest.approx(0.2308 * 4000.0)
    assert grip_load(12_000.0, 4000.0) == grip_load(50_000.0, 4000.0) == pytest.approx(12_000.0)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.001, 0.2))
def test_an_input_follows_at_its_rates_and_never_past_its_target(now: float, target: float, dt_s: float) -> None:
    after = follow(now, target, 2.5, 5.0, dt_s)
    assert min(now, target) - 1e-12 <= after <= max(now, target) + 1e-12
    assert abs(after - now) <= 5.0 * dt_s + 1e-12
    if now * target >= 0.0 and abs(target) > abs(now):
        assert after == pytest.approx(now + math.copysign(min(2.5 * dt_s, abs(target - now)), target - now))


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
