"""Claims about the responsibility for a collision: nuPlan's five types, in its order."""

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from basu.metrics.responsibility import CollisionKind, responsibilities, responsibility
from basu.records.history import Collision, History
from fakes.drives import hit
from fakes.rides import eastward, moving, ride

TICK = 40
AT_M = 5.0 * (TICK - 1) * 0.05  # where an ego at 5 m/s is in the frame before


def struck(
    ego_mps: float,
    other: Sequence[float],
    *,
    lane_offset_m: float = 0.0,
    heading_rad: float = 0.0,
    junction: bool = False,
) -> History:
    """An ego at a steady speed, hit in `TICK` by an actor at x, y, vx, vy relative to it in the frame before."""
    x_m, y_m, vx_mps, vy_mps = other
    before_s = (TICK - 1) * 0.05
    start = moving(ego_mps * before_s + x_m - vx_mps * before_s, y_m - vy_mps * before_s, vx_mps, vy_mps)
    history = ride(
        4.0,
        eastward(
            lambda _: ego_mps,
            5.0,
            lane_offset_m=lane_offset_m,
            lateral_m=lane_offset_m,
            lane_width_m=3.5,
            lane_heading_rad=heading_rad,
            lane_type=2.0,
            in_junction=float(junction),
        ),
        others=[(9, start)],
    )
    return replace(history, collisions=(hit(TICK, "vehicle.audi.tt", 9),))


def kind_and_fault(history: History) -> tuple[CollisionKind, bool]:
    found = responsibility(history, history.collisions[0])
    return found.kind, found.at_fault


def test_an_ego_that_stands_is_not_at_fault() -> None:
    assert kind_and_fault(struck(0.0, (4.2, 0.0, -5.0, 0.0))) == (CollisionKind.STOPPED_EGO, False)


def test_to_drive_into_what_stands_is_at_fault() -> None:
    assert kind_and_fault(struck(5.0, (4.1, 0.0, 0.0, 0.0))) == (CollisionKind.STOPPED_OTHER, True)


def test_scenery_stands() -> None:
    history = replace(struck(5.0, (4.1, 0.0, 0.0, 0.0)), collisions=(hit(TICK, "static.poles"),))
    assert kind_and_fault(history) == (CollisionKind.STOPPED_OTHER, True)


def test_to_be_struck_from_behind_is_not_at_fault() -> None:
    assert kind_and_fault(struck(5.0, (-4.1, 0.3, 9.0, 0.0))) == (CollisionKind.REAR, False)


def test_the_own_front_is_at_fault() -> None:
    assert kind_and_fault(struck(5.0, (4.1, 0.0, 2.0, 0.0))) == (CollisionKind.FRONT, True)


def test_the_side_is_at_fault_only_outside_of_one_lane() -> None:
    beside = (-0.5, 2.0, 5.0, -0.5)
    assert kind_and_fault(struck(5.0, beside)) == (CollisionKind.LATERAL, False)
    assert kind_and_fault(struck(5.0, beside, lane_offset_m=1.0)) == (CollisionKind.LATERAL, True)


def test_an_ego_that_turns_out_of_its_lane_is_not_within_it() -> None:
    assert kind_and_fault(struck(5.0, (-0.5, 2.0, 5.0, -0.5), heading_rad=math.radians(25.0)))[1]


@pytest.mark.parametrize(("lateral_m", "at_fault"), [(0.0, False), (1.2, True)])
def test_in_a_junction_the_planned_lane_counts(lateral_m: float, *, at_fault: bool) -> None:
    history = struck(5.0, (-0.5, 2.0, 5.0, -0.5), lane_offset_m=lateral_m, junction=True)
    assert kind_and_fault(history) == (CollisionKind.LATERAL, at_fault)


def test_each_collision_of_a_drive_has_one() -> None:
    history = struck(5.0, (-4.1, 0.3, 9.0, 0.0))
    history = replace(
        history,
        collisions=(
            *history.collisions,
            Collision(tick=60, other_id=0, other_type="static.poles", impulse_ns=(1.0, 0.0, 0.0)),
        ),
    )
    found = responsibilities(history)
    assert [(evidence.tick, judged.at_fault) for evidence, judged in found] == [(TICK, False), (60, True)]
    assert found[0][1].sentence == "not at fault: the ego was struck from behind at 9.00 m/s"
