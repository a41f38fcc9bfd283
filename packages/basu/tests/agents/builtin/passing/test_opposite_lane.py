"""Claims about when the lane of those who come the other way is free."""

import pytest

from basu.agents.builtin.driving.manner import NORMAL
from basu.agents.builtin.passing.detour import Extent, make_detour
from basu.agents.builtin.passing.opposite_lane import Need, is_free, time_needed_s
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other
from driving_plant import SHUTTLE_BODY, body_at, line, make_behavioral, make_route

EXTENT = Extent(80.0, 96.0, 120.0, 136.0)
STANDS = DrivenVehicle(0.0, 78.0, 0.0, 0.0, 0.0)


def free(*others: Other, sight_m: float = 350.0, junction_m: float = 550.0) -> bool:
    """Whether the way round what stands at 110 m is free for who stands at 78 m."""
    driver = make_behavioral(make_route(line(600.0), junctions_s_m=[(junction_m, junction_m + 15.0)]))
    path, road = driver.task.path, driver._road
    need = Need(make_detour(path, EXTENT, -2.7, NORMAL, 4.5), frozenset({7}), 0.9, 3.0, sight_m)
    place = path.find(STANDS.x_m, STANDS.y_m, 0.0)
    return is_free(path, road, SHUTTLE_BODY, STANDS, place, [body_at(ActorKind.VEHICLE, 110.0, 0.0), *others], need)


def car(x_m: float, y_m: float, speed_mps: float, yaw_deg: float) -> Other:
    velocity = {0.0: (speed_mps, 0.0), 180.0: (-speed_mps, 0.0), 90.0: (0.0, speed_mps), 270.0: (0.0, -speed_mps)}[
        yaw_deg
    ]
    return body_at(ActorKind.VEHICLE, x_m, y_m, velocity_mps=velocity, yaw_deg=yaw_deg, number=8)


def test_an_empty_street_is_free() -> None:
    assert free()


@pytest.mark.parametrize("speed_mps", [3.0, 8.0, 11.0])
def test_an_actor_that_comes_must_be_farther_away_than_it_gets_meanwhile(speed_mps: float) -> None:
    driver = make_behavioral(make_route(line(600.0)))
    path = driver.task.path
    need = Need(make_detour(path, EXTENT, -2.7, NORMAL, 4.5), frozenset(), 0.9, 3.0, 350.0)
    within_s = time_needed_s(STANDS, path.find(78.0, 0.0, 0.0), SHUTTLE_BODY, need) + 3.0
    least_m = speed_mps * within_s  # it may speed up, too
    assert not free(car(136.0 + 2.2 + 0.9 * least_m, -3.2, speed_mps, 180.0))
    assert free(car(136.0 + 2.2 + 11.2 * within_s + 5.0, -3.2, speed_mps, 180.0))


def test_an_actor_that_is_past_us_or_on_another_street_or_leads_our_way_does_not_matter() -> None:
    assert free(car(60.0, -3.2, 8.0, 180.0), car(160.0, -14.0, 8.0, 180.0), car(160.0, 0.0, 8.0, 0.0))


def test_an_actor_that_overtakes_us_goes_first() -> None:
    assert not free(car(65.0, -3.2, 8.0, 0.0))


def test_what_stands_in_the_other_lane_blocks_it_only_there() -> None:
    assert not free(body_at(ActorKind.VEHICLE, 115.0, -3.2, yaw_deg=180.0, number=8))
    assert free(body_at(ActorKind.VEHICLE, 170.0, -3.2, yaw_deg=180.0, number=8))
    assert free(body_at(ActorKind.PROP, 115.0, -5.5, number=8))


def test_an_actor_that_moves_about_the_next_junction_may_turn_in() -> None:
    crosser = car(162.0, -12.0, 5.0, 90.0)
    assert not free(crosser, junction_m=155.0)
    assert free(crosser)  # without a junction it is in a garden


def test_what_is_not_seen_may_come_at_the_limit() -> None:
    assert not free(sight_m=250.0)
