"""Claims about a route that begins farther along: distances count from there, and what lies before is gone."""

from dataclasses import replace

import numpy as np
import pytest

from basu.errors import UserError
from basu.routing import Stop
from basu.routing.planned_route import Progress, advance, beginning_at
from fakes.drives import stop_sign, straight_route


def test_distances_count_from_the_new_beginning() -> None:
    whole = straight_route()
    cut = beginning_at(whole, 9.5)
    assert cut.s_m[0] == 0.0
    assert cut.length_m == pytest.approx(whole.length_m - 10.0)
    assert np.array_equal(cut.points_m, whole.points_m[10:])
    x_m, y_m, _ = whole.points_m[25]
    assert advance(cut, Progress.at_start(), float(x_m), float(y_m)).s_m == pytest.approx(15.0)


def test_stops_and_signs_before_it_are_gone() -> None:
    stops = tuple(Stop(id=f"{s_m}", name="", s_m=s_m, x_m=0.0, y_m=0.0, z_m=0.0, yaw_rad=0.0) for s_m in (5.0, 40.0))
    cut = beginning_at(replace(straight_route(), stops=stops, controls=(stop_sign(8.0), stop_sign(30.0))), 10.0)
    assert [(stop.id, stop.s_m) for stop in cut.stops] == [("40.0", 30.0)]
    assert [control.s_m for control in cut.controls] == [20.0]
    assert cut.timetable is None


def test_at_its_beginning_it_is_the_route_itself() -> None:
    whole = straight_route()
    assert beginning_at(whole, 0.0) is whole


def test_a_place_behind_its_end_gets_a_sentence() -> None:
    with pytest.raises(UserError, match=r"no vehicle can begin at 5000 m"):
        beginning_at(straight_route(), 5000.0)
