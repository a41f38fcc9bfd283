"""Claims about the models of UN Regulation 157 in single moments: each figure follows by hand from the formulas."""

from typing import Any

import numpy as np
import pytest

from basu.metrics.careful_driver.fsm import Fsm
from basu.metrics.careful_driver.human import CarefulHuman
from basu.metrics.careful_driver.model import BRAKE_MPS2, Situation, View
from basu.metrics.careful_driver.reg157 import Reg157
from basu.metrics.careful_driver.rss import Rss

CUT_IN, DECELERATION = Situation.CUT_IN, Situation.DECELERATION


def view(**values: float) -> View:
    """Return one moment, by default at 10 m/s behind a vehicle in the path at 5 m/s."""
    usual = {"gap_m": 20.0, "length_m": 4.3, "clear_m": -1.9, "own_mps": 10.0, "own_mps2": 0.0, "other_mps": 5.0}
    columns: dict[str, Any] = {
        name: np.array([value]) for name, value in {**usual, "across_mps": 0.0, **values}.items()
    }
    return View(**columns, is_ahead=np.array([True]))


def sees(model: Any, situation: Situation = CUT_IN, **values: float) -> bool:
    return bool(model.perceives(view(**values), situation)[0])


def test_fsm_is_proactive_from_the_gap_that_comfortable_braking_needs() -> None:
    """10 * 0.75 + 100 / 8 - 25 / 14 + 2 = 20.21 m beyond the standing gap of 2 m; unsafe: 7.5 + 100 / 12 - 25 / 14."""
    model, safe_m, unsafe_m = Fsm(), 22.2143, 16.0476
    assert model.proactive(view(gap_m=safe_m + 0.01))[0] == 0.0
    assert model.proactive(view(gap_m=(safe_m + unsafe_m) / 2.0))[0] == pytest.approx(0.5, abs=1e-4)
    assert model.proactive(view(gap_m=unsafe_m - 0.01))[0] == 1.0
    assert sees(model, gap_m=safe_m - 0.1)
    assert not sees(model, gap_m=safe_m + 0.1)


def test_fsm_is_critical_from_the_gap_that_closes_at_present_speeds() -> None:
    """5 * 0.75 + 25 / 8 = 6.875 m, and unsafe 5 * 0.75 + 25 / 12 = 5.8333 m."""
    model = Fsm()
    assert model.critical(view(gap_m=6.88))[0] == 0.0
    assert model.critical(view(gap_m=(6.875 + 5.8333) / 2.0))[0] == pytest.approx(0.5, abs=1e-4)
    assert model.critical(view(gap_m=5.83))[0] == 1.0
    assert model.critical(view(gap_m=1.0, other_mps=10.0))[0] == 0.0


def test_fsm_brakes_by_the_measure() -> None:
    """Up to 4 m/s² by the proactive measure, from 4 to 6 m/s² by the critical one, and no faster than the jerk."""
    model, hard = Fsm(), np.array([9.0])
    half_m = (22.2143 + 16.0476) / 2.0
    assert model.braking_mps2(view(gap_m=half_m), hard, 0.1)[0] == pytest.approx(2.0, abs=1e-3)
    assert model.braking_mps2(view(gap_m=(6.875 + 5.8333) / 2.0), hard, 0.1)[0] == pytest.approx(5.0, abs=1e-3)
    assert model.braking_mps2(view(gap_m=1.0), np.array([0.0]), 0.1)[0] == pytest.approx(1.265)


def test_fsm_minds_a_vehicle_that_comes_before_the_ways_are_passed() -> None:
    """The ways are passed after (4 + 8.6) / 5 = 2.52 s."""
    assert sees(Fsm(), gap_m=4.0, clear_m=1.0, across_mps=0.5)
    assert not sees(Fsm(), gap_m=4.0, clear_m=1.4, across_mps=0.5)
    assert not sees(Fsm(), gap_m=4.0, clear_m=1.0, across_mps=0.0)


def test_cc_takes_two_seconds_for_critical_and_full_braking() -> None:
    model = CarefulHuman()
    assert sees(model, gap_m=10.0)
    assert not sees(model, gap_m=10.1)
    assert not sees(model, gap_m=5.0, clear_m=0.01)
    assert bool(model.dismisses(view(gap_m=10.1), CUT_IN)[0])
    assert sees(model, DECELERATION, gap_m=50.0)
    steps = [np.array([0.0])]
    for _ in range(7):
        steps.append(model.braking_mps2(view(), steps[-1], 0.1))
    assert steps[-2][0] == pytest.approx(7.59)
    assert steps[-1][0] == pytest.approx(BRAKE_MPS2)


def test_rss_keeps_the_safe_gaps_of_its_paper() -> None:
    """Along 7.5 + 3 * 0.28125 + 12.25² / 12 - 25 / 12 = 18.766 m; across, at 1 m/s, 0.3 + 1.03125 + 1.53125 m."""
    assert sees(Rss(), gap_m=18.76)
    assert not sees(Rss(), gap_m=18.77)
    assert sees(Rss(), gap_m=5.0, clear_m=2.86, across_mps=1.0)
    assert not sees(Rss(), gap_m=5.0, clear_m=2.87, across_mps=1.0)


def test_reg157_brakes_at_the_bound_of_the_regulation() -> None:
    """5 / 12 + 0.35 s = 0.767 s, and 0.1 s: 4.33 m."""
    assert Reg157().bound_s(np.array([5.0]))[0] == pytest.approx(0.7667, abs=1e-4)
    assert sees(Reg157(), gap_m=4.33)
    assert not sees(Reg157(), gap_m=4.34)
    assert not sees(Reg157(), gap_m=4.0, clear_m=0.51)
    assert Reg157().braking_mps2(view(), np.array([0.0]), 0.1)[0] == 6.0


@pytest.mark.parametrize("model", [Fsm(), CarefulHuman(), Rss(), Reg157()], ids=lambda model: model.name)
def test_what_is_behind_or_faster_is_no_danger_of_a_cut_in(model: Any) -> None:
    behind = view(gap_m=1.0)._replace(is_ahead=np.array([False]))
    assert not model.perceives(behind, CUT_IN)[0]
    assert not sees(model, gap_m=60.0, other_mps=20.0)


def test_each_model_keeps_a_distance_that_it_does_not_react_to() -> None:
    speed = np.array([10.0])
    for model in (Fsm(), Rss()):
        gap_m = float(model.following_m(speed)[0])
        assert not sees(model, DECELERATION, gap_m=gap_m + 0.01, other_mps=10.0)
    assert CarefulHuman().following_m(speed)[0] == Reg157().following_m(speed)[0] == 20.0
