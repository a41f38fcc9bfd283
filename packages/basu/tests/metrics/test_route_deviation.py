"""Claims about route deviation: a share of the driven way, with a threshold that may be set."""

import numpy as np
import pytest

from basu.metrics.route_deviation import route_deviation
from basu.metrics.scoring import THRESHOLD_M
from basu.metrics.stretches import chords, path_m, total_m
from fakes.drives import at, driven, straight_route


def test_driving_the_plan_deviates_nowhere() -> None:
    found = route_deviation(driven(at(10.0, 20.0)))
    assert (found.outside.share, found.largest_m, found.threshold_m) == (0.0, 0.0, THRESHOLD_M)


def test_the_share_counts_the_length_of_the_path_beside_the_plan_not_the_length_passed_by() -> None:
    history = driven(at(10.0, 20.0), route=straight_route(400.0))
    x_m = history.frames["x_m"]
    history.frames["lateral_m"] = history.frames["y_m"] = np.where((x_m > 50.0) & (x_m < 100.0), 3.0 * np.sin(x_m), 0.0)
    whole_m = total_m(chords(path_m(history.frames)).length_m)
    found = route_deviation(history, 0.0)
    assert found.outside.metres > 100.0  # fifty metres of road, wound about
    assert found.outside.share == pytest.approx(found.outside.metres / whole_m)


@pytest.mark.parametrize(("threshold_m", "metres"), [(1.0, 80.0), (2.5, 0.0)])
def test_the_threshold_decides(threshold_m: float, metres: float) -> None:
    history = driven(at(10.0, 20.0))
    history.frames["lateral_m"][100:260] = -2.2
    found = route_deviation(history, threshold_m)
    assert found.outside.metres == pytest.approx(metres)
    assert found.largest_m == pytest.approx(2.2)


def test_each_stretch_tells_its_side_and_how_far() -> None:
    history = driven(at(10.0, 20.0))
    history.frames["lateral_m"][100:120] = -2.5
    history.frames["lateral_m"][200:240] = 4.0
    left, right = route_deviation(history).outside.events
    assert left.detail == "up to 2.5 m to the left of the plan, for 10.0 m and 1.0 s"
    assert right.detail == "up to 4.0 m to the right of the plan, for 20.0 m and 2.0 s"
    assert right.kind.value == "route_deviation"


def test_a_run_that_went_nowhere_has_no_share() -> None:
    assert route_deviation(driven(at(0.0, 5.0), lateral_m=9.0)).outside.share == 0.0
