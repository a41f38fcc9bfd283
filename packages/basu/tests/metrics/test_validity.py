"""Claims about validity: drives beside the route, against it, or with a jump lose; passing an obstacle does not."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from basu.managers.base_manager import Ego, Frame, WorldChanges
from basu.managers.observations import NO_LANE
from basu.managers.routes_manager import RoutesManager
from basu.metrics.path_following import arrival_tick, completion, path_following
from basu.metrics.result import judge
from basu.metrics.stop_signs import stop_signs
from basu.metrics.validity import PASSING_M, SLIP_M, Follower, moments, validity
from basu.outcome import Outcome, Status
from basu.output.report.series_document import row as series_row
from basu.output.report.series_document import totals
from basu.records.history import History
from basu.routing import Route, Stop
from basu.scenarios.criteria.going import Arrives, Reaches
from fakes.drives import STEP_S, stop_sign, straight_route
from fakes.paths import Points, along, driven_through, lane_under, route_along
from fakes.played import played
from fakes.results import META

LENGTH_M = 200.0
LEFT_M = -3.5  # the middle of the oncoming lane
FAR_LEFT_M = -4.2  # in the oncoming lane, left of its middle
STOP = Stop(id="A", name="A", s_m=100.0, x_m=100.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)
BLOCK = route_along([(0, 0), (30, 0), (30, 35), (50, 35), (50, 0), (130, 0)])


def ring(from_deg: float, to_deg: float) -> Points:
    """Points on a circle of 12 m about the origin; 90 degrees are in the south, 0 in the east."""
    degrees = np.linspace(from_deg, to_deg, 40)
    return [(12.0 * math.cos(math.radians(d)), 12.0 * math.sin(math.radians(d))) for d in degrees]


ROUNDABOUT = route_along([(0, 60), *ring(90, -90), (0, -60)])
BACKWARDS = [(0, 60), *ring(90, 270), (0, -60)]


def beside(from_m: float, to_m: float, y_m: float) -> Points:
    """Along the straight road to its end, ``y_m`` beside its middle between two places."""
    return [(0, 0), (from_m, 0), (from_m + 3, y_m), (to_m - 3, y_m), (to_m, 0), (LENGTH_M, 0)]


def live(history: History) -> Outcome | None:
    """The outcome of the same drive while it lasts."""
    route, manager = history.facts.route, RoutesManager()
    run: Any = SimpleNamespace(
        route=route, step_s=STEP_S, world=None, carla_map=None, weather=(), changes=WorldChanges()
    )
    manager.setup(run)
    manager._lanes = SimpleNamespace(under=lambda ego: lane_of(route, ego))  # type: ignore[assignment]
    for row in history.frames:
        pose = [float(row[name]) for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")]
        velocity = [float(row[f"velocity_{axis}_mps"]) for axis in "xyz"]
        manager.tick(Frame(int(row["tick"]), int(row["tick"]), None, Ego(*pose, *velocity, *[0.0] * 6)))  # type: ignore[arg-type]
        if manager.outcome is not None:
            return manager.outcome
    return None


def lane_of(route: Route, ego: Ego) -> Any:
    found = lane_under(route, ego.x_m, ego.y_m)
    names = ("road_id", "lane_id", "lane_type", "lane_width_m", "off_lane_m")
    return NO_LANE._replace(**{name: found.get(name, 0.0) for name in names})


LOST = {
    "four metres left of the whole route": (straight_route(), [(0, -4.0), (LENGTH_M, -4.0)]),
    "29 m beside the road": (straight_route(), [(0, 29.0), (LENGTH_M, 29.0)]),
    "over a block": (BLOCK, [(0, 0), (30, 0), (50, 0), (130, 0)]),
    "round the conflict, off the road": (straight_route(), beside(80.0, 110.0, 5.0)),
    "through a roundabout backwards": (ROUNDABOUT, BACKWARDS),
    "in the oncoming lane most of the way": (straight_route(), beside(20.0, 190.0, LEFT_M)),
}


@pytest.mark.parametrize(("route", "way"), LOST.values(), ids=LOST)
def test_a_way_that_is_not_the_routes_does_not_arrive(route: Route, way: Points) -> None:
    history = along(route, way)
    found = validity(history)
    assert arrival_tick(history) is None
    assert completion(history) < 0.95
    assert path_following(history).score == pytest.approx(found.share, abs=0.01)
    assert Arrives().judge(played(history)).passed is False
    assert Reaches(0.97 * route.length_m).judge(played(history)).passed is False
    outcome = live(history)
    assert outcome is None or outcome.status is Status.ROUTE_DEVIATION


def test_the_end_of_a_drive_with_a_jump_says_what_was_left_out() -> None:
    outcome = live(along(BLOCK, [(0, 0), (30, 0), (50, 0), (130, 0)]))
    assert outcome is not None
    assert outcome.status is Status.ROUTE_DEVIATION
    assert "did not drive" in outcome.message


def test_an_opposite_lane_at_each_line_is_no_way_round_the_stop_signs() -> None:
    route = straight_route(controls=(stop_sign(60.0), stop_sign(140.0, "8")))
    way = [*beside(45.0, 75.0, FAR_LEFT_M)[:-1], *beside(125.0, 155.0, FAR_LEFT_M)[1:]]
    history = along(route, way)
    assert len(stop_signs(history)) == 2
    result = judge(Outcome(Status.COMPLETED, "arrived"), history)
    assert result.scores is not None
    assert result.scores.infraction == pytest.approx(0.8**2)


def test_a_stop_is_served_on_the_route_only() -> None:
    route = straight_route(stops=(STOP,))
    for y_m, served in ((0.0, True), (2.0, True), (29.0, False), (LEFT_M, False)):
        history = along(route, [(0, y_m), (LENGTH_M, y_m)], rests_at=[(100, y_m)])
        result = judge(Outcome(Status.COMPLETED, "arrived"), history)
        assert result.metrics["stops"][0]["served"] is served
        assert result.metrics["passengers"]["service"][0]["served"] is served


ORDINARY = {
    "in the lane": [(0, 0), (LENGTH_M, 0)],
    "at the edge of the lane": beside(20.0, 180.0, 2.2),
    "round an obstacle": beside(80.0, 80.0 + PASSING_M - 2.0, LEFT_M),
    "off the road for a moment": beside(80.0, 86.1, 2.6),
    "round two obstacles": [*beside(30.0, 60.0, LEFT_M)[:-1], *beside(120.0, 150.0, LEFT_M)[1:]],
}


@pytest.mark.parametrize("way", ORDINARY.values(), ids=ORDINARY)
def test_an_ordinary_drive_arrives_with_a_full_score(way: Points) -> None:
    history = along(straight_route(), way)
    assert arrival_tick(history) is not None
    assert completion(history) == path_following(history).score == 1.0
    assert validity(history).share == pytest.approx(1.0, abs=0.01)
    outcome = live(history)
    assert outcome is not None
    assert outcome.status is Status.COMPLETED
    assert int(outcome.message.split()[2].split(".")[0]) == int(history.frames["t_s"][arrival_tick(history)])


def test_a_lane_of_the_same_road_and_direction_is_the_route() -> None:
    history = along(straight_route(), [(0, LEFT_M), (LENGTH_M, LEFT_M)])
    assert not validity(history).valid.any()
    history.frames["lane_id"] = -2
    assert validity(replace(history)).valid.all()
    history.frames["off_lane_m"] = 0.6
    assert not validity(replace(history)).valid.any()


def test_a_record_is_checked_once() -> None:
    history = along(straight_route(), [(0, 0), (LENGTH_M, 0)])
    assert validity(history) is validity(history)
    assert validity(replace(history)) is not validity(history)
    assert len(validity(history.window(0, 10)).checks) == 10


def test_setting_back_and_going_on_breaks_no_drive() -> None:
    forth, back = np.arange(0.0, 60.0, 0.4), np.arange(60.0, 50.0, -0.1)
    poses = [(x, 0.0, 0.0, 8.0) for x in forth] + [(x, 0.0, 0.0, -2.0) for x in back]
    history = driven_through(straight_route(), [*poses, *((x, 0.0, 0.0, 8.0) for x in np.arange(50.0, 200.2, 0.4))])
    found = validity(history)
    assert [round(float(history.frames["route_s_m"][first])) for first, _ in found.intervals()] == [60]
    assert found.checks[found.intervals()[0][0]].sentence == "against the direction of its route"
    assert found.gaps == ()
    assert arrival_tick(history) is not None


def test_a_drive_backwards_along_the_route_is_against_it() -> None:
    poses = [(x, 0.0, math.pi, -8.0) for x in np.arange(0.0, 200.2, 0.4)]
    found = validity(driven_through(straight_route(), poses))
    assert not found.valid.any()
    assert found.share == 0.0


def test_each_reason_is_named_with_its_figure() -> None:
    found = validity(along(straight_route(), [(0, -4.0), (LENGTH_M, -4.0)]))
    assert found.intervals() == [(0, len(found.valid))]
    assert found.checks[0].sentence == "2.2 m beyond the edge of its lane"
    leap = [(x, 0.0, 0.0, 8.0) for x in (*np.arange(0.0, 40.0, 0.4), *np.arange(60.0, 200.0, 0.4))]
    history = driven_through(straight_route(), leap)
    history.frames["x_m"][100:] -= 20.0  # the progress alone has jumped
    found = validity(history)
    assert [check.sentence for check in found.checks if not check.valid] == ["20 m of the route skipped at once"]
    assert found.gaps[0].length_m == pytest.approx(20.4)
    assert SLIP_M < 20.4


def test_frame_by_frame_it_is_what_the_record_tells() -> None:
    history = along(BLOCK, [(0, 0), (30, 0), (50, 0), (130, 0)])
    follower, found = Follower(BLOCK), validity(history)
    for tick, moment in enumerate(moments(history.frames)):
        assert follower.step(moment) == found.checks[tick]
        assert follower.driven_m == found.driven_m[tick]


def test_the_driven_distance_is_what_was_driven() -> None:
    """A drive of 53.8 m away from the route is not 1 m long, and rates for each km are of what was driven."""
    way = [(0, 0), (1, 0), (1, 25.0), (3, 25.0), (3, -1.8)]
    history = along(straight_route(controls=(stop_sign(2.0),)), way, speed_mps=6.0)
    result = judge(Outcome(Status.ROUTE_DEVIATION, "left the route"), history, meta=META)
    driven_m = result.metrics["reported"]["driven_m"]
    assert driven_m == pytest.approx(54.8, abs=1.0)
    assert result.metrics["reported"]["route_completion"] < 0.02
    total = totals([series_row(result, number=0, repetition=0, folder="run")], 1)
    assert total["driven_km"] == pytest.approx(driven_m / 1000.0)
    assert total["infractions"]["stop_sign"] == {"number": 1, "per_km": pytest.approx(1000.0 / driven_m)}
