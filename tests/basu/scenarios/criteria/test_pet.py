"""Claims about the post-encroachment time of two boxes on crossing lines."""

import math
from collections.abc import Callable

import pytest

from basu.scenarios.criteria import Pet
from fakes.drives import hit
from fakes.played import played
from fakes.rides import Row, eastward, moving, ride

LEAVES_S = (20.9 + 2.0) / 10.0  # when the ego's tail is past the strip that a crossing at x = 20 m sweeps


def across_at_rest(_: float) -> Row:
    """Somebody who stands across the road."""
    return {"x_m": 24.0, "yaw_rad": math.pi / 2.0}


@pytest.mark.parametrize("after_s", [0.5, 1.2, 3.0, 4.5])
def test_who_comes_after_the_ego_comes_so_much_later(after_s: float) -> None:
    crossing = (9, moving(20.0, 1.0 + 2.0 + 8.0 * (LEAVES_S + after_s), 0.0, -8.0))
    said = Pet(1.0).judge(played(ride(9.0, eastward(lambda _: 10.0, 10.0), others=[crossing])))
    assert said.measured == pytest.approx(after_s, abs=0.06)
    assert said.passed is (after_s >= 1.0)
    assert said.t_s == pytest.approx(LEAVES_S + after_s, abs=0.1)
    assert said.other == "child"


def test_who_goes_before_the_ego_counts_as_well() -> None:
    """Its tail leaves the ego's strip (y = -1) at 1 s; the ego's front comes to its own (x = 19.1) 0.71 s later."""
    crossing = (9, moving(20.0, -1.0 - 2.0 + 8.0, 0.0, -8.0))
    said = Pet().judge(played(ride(4.0, eastward(lambda _: 10.0, 5.0), others=[crossing])))
    assert said.measured == pytest.approx((20.0 - 0.9 - 2.0) / 10.0 - 1.0, abs=0.06)


def test_who_follows_in_the_lane_crosses_nobodys_way() -> None:
    case = played(ride(4.0, eastward(lambda _: 10.0, 5.0), others=[(9, moving(12.0, 0.0, 10.0, 0.0))]))
    assert Pet(1.0).judge(case).measured is None


@pytest.mark.parametrize(
    ("moves", "measured"),
    [(moving(24.0, 4.0, 0.0, -4.0), 0.0), (moving(24.0, 4.0, 4.0, 0.0), None), (across_at_rest, None)],
    ids=["across", "ahead", "standing across"],
)
def test_who_was_hit_coming_across_the_way_was_no_time_apart(
    moves: Callable[[float], Row], measured: float | None
) -> None:
    history = ride(1.0, eastward(lambda _: 10.0, 2.0), others=[(9, moves)])
    said = Pet().judge(played(history, collisions=(hit(18, "vehicle.audi.tt", 9),)))
    assert said.measured == measured
    assert ("was touched" if measured == 0.0 else "nobody crossed its way within 5 s") in said.sentence
