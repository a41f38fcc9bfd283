"""Claims about headway: bumper to bumper, ahead and the same way only."""

import math

import pytest

from basu.scenarios.criteria import KeepsHeadway
from fakes.played import played
from fakes.rides import eastward, moving, ride


def test_it_is_the_gap_between_the_bumpers_over_the_egos_speed() -> None:
    case = played(ride(3.0, eastward(lambda _: 10.0, 4.0), others=[(9, moving(20.0, 0.0, 10.0, 0.0))]))
    said = KeepsHeadway(2.0, to="child").judge(case)
    assert said.measured == pytest.approx((20.0 - 2.0 - 2.0) / 10.0)
    assert (said.passed, said.criterion) == (False, "headway to child")


@pytest.mark.parametrize(
    "other",
    [moving(-10.0, 0.0, 10.0, 0.0), moving(20.0, 2.0, 10.0, 0.0), moving(90.0, 0.0, -10.0, 0.0)],
    ids=["behind", "beside", "oncoming"],
)
def test_who_is_not_ahead_the_same_way_has_none(other: object) -> None:
    case = played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, other)]))  # type: ignore[list-item]
    assert KeepsHeadway(1.0).judge(case).measured is None


def test_a_slanting_leader_reaches_back_with_its_corner() -> None:
    slanted = moving(20.0, 0.0, 10.0 * math.cos(0.3), 10.0 * math.sin(0.3))
    said = KeepsHeadway().judge(played(ride(0.1, eastward(lambda _: 10.0, 1.0), others=[(9, slanted)])))
    assert said.measured == pytest.approx((18.0 - 2.0 * math.cos(0.3) - 0.9 * math.sin(0.3)) / 10.0, abs=0.01)


def test_moving_up_in_a_queue_is_no_headway() -> None:
    case = played(ride(2.0, eastward(lambda _: 2.0, 3.0), others=[(9, moving(6.0, 0.0, 2.0, 0.0))]))
    assert KeepsHeadway(1.0).judge(case).passed is None
