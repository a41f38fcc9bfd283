"""Claims about comfort: closed forms of simple manoeuvres."""

import numpy as np
import pytest

from basu.metrics.comfort import comfort
from fakes.drives import STEP_S, at, driven, ramp


def test_a_steady_drive_is_felt_by_nobody() -> None:
    found = comfort(driven(at(5.0, 10.0)))
    assert found is not None
    assert max(found) == pytest.approx(0.0, abs=1e-9)


def test_steady_braking_is_felt_as_its_deceleration() -> None:
    found = comfort(driven(ramp(10.0, 0.0, 5.0)))
    assert found is not None
    assert found.longitudinal_max_mps2 == pytest.approx(2.0, rel=0.02)
    assert found.jerk_max_mps3 == pytest.approx(0.0, abs=1e-6)


def test_a_steady_circle_is_felt_as_speed_squared_over_radius() -> None:
    history = driven(at(6.0, 10.0))
    heading_rad = 6.0 / 12.0 * STEP_S * np.arange(len(history.frames))
    history.frames["yaw_rad"] = np.angle(np.exp(1j * heading_rad))
    history.frames["velocity_x_mps"] = 6.0 * np.cos(heading_rad)
    history.frames["velocity_y_mps"] = 6.0 * np.sin(heading_rad)
    found = comfort(history)
    assert found is not None
    assert found.lateral_max_mps2 == pytest.approx(36.0 / 12.0, rel=1e-6)
    assert found.longitudinal_max_mps2 == pytest.approx(0.0, abs=1e-9)


def test_too_short_a_run_is_not_measurable() -> None:
    assert comfort(driven(at(5.0, 0.5))) is None
