"""Claims about what stands in the lane ahead."""

from collections.abc import Sequence

from basu.agents.builtin.passing.obstruction import DROVE_FACTOR, QUEUE_PATIENCE_S, Standing, StandingRow
from basu.agents.builtin.scene import ActorKind, DrivenVehicle, Other
from basu.routing import ControlKind
from driving_plant import SHUTTLE_BODY, body_at, line, make_behavioral, make_route


def seen(*moments: Sequence[Other], step_s: float = 1.0, line_m: float | None = None) -> StandingRow | None:
    """The block that is seen in the last of several moments from x = 50."""
    controls = [] if line_m is None else [(ControlKind.STOP_SIGN, line_m)]
    driver = make_behavioral(make_route(line(300.0), controls=controls))
    path, standing, block = driver.task.path, Standing(SHUTTLE_BODY), None
    for k, others in enumerate(moments):
        ego = DrivenVehicle(step_s * k, 50.0, 0.0, 0.0, 0.0)
        block = standing.block(path, driver._road, ego, path.find(50.0, 0.0, 0.0), others)
    return block


def car(x_m: float, y_m: float = 0.0, speed_mps: float = 0.0, number: int = 7) -> Other:
    return body_at(ActorKind.VEHICLE, x_m, y_m, velocity_mps=(speed_mps, 0.0), number=number)


def test_it_has_an_extent_and_a_time() -> None:
    block = seen([car(80.0, 0.2)], [car(80.0, 0.2)], [car(80.0, 0.2)])
    assert block is not None
    assert [round(v, 1) for v in (block.from_s_m, block.to_s_m, block.left_m, block.right_m)] == [77.8, 82.2, -0.8, 1.1]
    assert (block.stood_s, block.patience_factor, block.least_patience_s) == (2.0, 1.0, 0.0)


def test_an_actor_that_moves_is_beside_the_lane_behind_or_on_foot_is_none() -> None:
    assert seen([car(80.0, speed_mps=1.0)]) is None
    assert seen([car(80.0, y_m=3.0)]) is None
    assert seen([car(40.0)]) is None
    assert seen([body_at(ActorKind.WALKER, 80.0, 0.0)]) is None


def test_those_close_behind_one_another_are_one_and_the_next_is_another() -> None:
    block = seen([car(80.0, number=1), car(90.0, number=2), car(110.0, number=3)])
    assert block is not None
    assert block.members == {1, 2}


def test_the_time_begins_anew_when_it_moves_and_it_has_a_driver() -> None:
    block = seen([car(79.0)], [car(80.0, speed_mps=2.0)], [car(80.0)], [car(80.0)])
    assert block is not None
    assert (block.stood_s, block.patience_factor) == (1.0, DROVE_FACTOR)


def test_before_a_line_a_car_is_a_queue_and_a_prop_is_not() -> None:
    queue, cone = seen([car(80.0)], line_m=95.0), seen([body_at(ActorKind.PROP, 80.0, 0.0)], line_m=95.0)
    assert queue is not None
    assert cone is not None
    assert (queue.least_patience_s, cone.least_patience_s) == (QUEUE_PATIENCE_S, 0.0)
