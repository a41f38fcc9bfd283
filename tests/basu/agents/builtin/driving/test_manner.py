"""Claims about the manners: which is the bolder one, and that none of them is what the metrics call speeding."""

from collections.abc import Callable

import pytest

from basu.agents.builtin.driving.manner import AGGRESSIVE, BASIC, CAUTIOUS, NORMAL, Manner
from basu.agents.builtin.driving.planner import FIRM, OVERSPEED_MPS
from basu.metrics.speeding import TOLERANCE_MPS

BOLDNESS: list[Callable[[Manner], float]] = [
    lambda m: m.comfort.accel_mps2,
    lambda m: m.lateral_accel_mps2,
    lambda m: m.above_limit_mps,
    lambda m: -m.following.headway_s,  # type: ignore[union-attr]
    lambda m: -m.gaps.factor,  # type: ignore[union-attr]
    lambda m: -m.gaps.margin_s,  # type: ignore[union-attr]
    lambda m: -m.passing.patience_s,  # type: ignore[union-attr]
    lambda m: -m.passing.beside_m,  # type: ignore[union-attr]
]


@pytest.mark.parametrize("boldness", BOLDNESS)
def test_each_figure_is_ordered_as_the_names_are(boldness: Callable[[Manner], float]) -> None:
    assert boldness(CAUTIOUS) < boldness(NORMAL) < boldness(AGGRESSIVE)


@pytest.mark.parametrize("manner", [BASIC, CAUTIOUS, NORMAL, AGGRESSIVE])
def test_none_drives_what_is_counted_as_speeding(manner: Manner) -> None:
    assert manner.above_limit_mps + OVERSPEED_MPS < TOLERANCE_MPS


@pytest.mark.parametrize("manner", [CAUTIOUS, NORMAL, AGGRESSIVE])
def test_comfort_is_milder_than_firm_braking_and_within_what_cruise_controls_may_do(manner: Manner) -> None:
    assert manner.comfort.accel_mps2 < FIRM.accel_mps2
    assert manner.comfort.jerk_mps3 < FIRM.jerk_mps3
    assert manner.following is not None
    assert manner.following.headway_s >= 0.8  # ISO 15622: the least time gap that may be set
