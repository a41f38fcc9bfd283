"""Tests of ``basu.metrics.collisions``."""

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from basu.metrics.collisions import collisions, kind_of, responsibilities
from basu.metrics.fault import responsibility
from basu.metrics.infraction import CollisionKind, Infraction
from basu.records.history import Collision, History
from fakes.drives import STEP_S, at, driven, hit, ramp
from fakes.rides import eastward, moving, ride


@pytest.mark.parametrize(
    ("other_type", "kind"),
    [
        ("walker.pedestrian.0007", Infraction.COLLISION_PEDESTRIAN),
        ("vehicle.audi.tt", Infraction.COLLISION_VEHICLE),
        ("static.poles", Infraction.COLLISION_STATIC),
        ("traffic.stop", Infraction.COLLISION_STATIC),
    ],
)
def test_what_was_hit_decides_the_kind(other_type: str, kind: Infraction) -> None:
    assert kind_of(other_type) is kind


def test_a_contact_of_many_frames_is_one_collision() -> None:
    assert len(collisions(driven(at(1.0, 10.0), collisions=[hit(tick) for tick in range(40, 160)]))) == 1


def test_a_rebound_within_two_seconds_is_the_same_contact() -> None:
    assert len(collisions(driven(at(1.0, 10.0), collisions=[hit(40), hit(75)]))) == 1


def test_a_second_touch_after_more_than_two_seconds_is_another_collision() -> None:
    assert [e.tick for e in collisions(driven(at(1.0, 10.0), collisions=[hit(40), hit(81)]))] == [40, 81]


def test_two_parties_in_one_frame_are_two_collisions() -> None:
    history = driven(at(1.0, 10.0), collisions=[hit(40, "vehicle.audi.tt", 5), hit(40, "vehicle.audi.tt", 6)])
    assert [e.other for e in collisions(history)] == ["vehicle.audi.tt (actor 5)", "vehicle.audi.tt (actor 6)"]


def test_the_evidence_tells_the_speed_before_the_impact_and_the_place() -> None:
    history = driven([*at(8.0, 2.0), *ramp(1.0, 0.0, 1.0)], collisions=[hit(40, impulse=2500.0)])
    (found,) = collisions(history)
    assert found.speed_mps == pytest.approx(8.0)
    assert found.t_s == pytest.approx(40 * STEP_S)
    assert found.x_m == pytest.approx(16.0)
    assert found.route_s_m == pytest.approx(16.0)
    assert found.detail == "hit static.poles at 8.00 m/s with an impulse of 2500 N s"


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


def test_an_oncoming_car_is_at_fault_for_the_ego_in_its_lane() -> None:
    """NuPlan's front clause gives this to the ego."""
    oncoming = (4.1, 0.0, -8.0, 0.0)
    assert kind_and_fault(struck(5.0, oncoming)) == (CollisionKind.FRONT, False)
    assert kind_and_fault(struck(5.0, oncoming, lane_offset_m=-1.5)) == (CollisionKind.FRONT, True)
    assert kind_and_fault(struck(5.0, oncoming, heading_rad=math.pi)) == (CollisionKind.FRONT, True)
    assert kind_and_fault(struck(5.0, (4.0, 0.0, -1.0, -1.5))) == (CollisionKind.FRONT, True)


def test_a_walker_towards_the_ego_is_no_oncoming_car() -> None:
    history = struck(5.0, (4.1, 0.0, -1.0, 0.0))
    walker = replace(history, facts=replace(history.facts, actor_types={9: "walker.pedestrian.0001"}))
    assert kind_and_fault(walker) == (CollisionKind.FRONT, True)


def test_to_reverse_into_what_walks_away_is_at_fault() -> None:
    """NuPlan takes it for a rear-end by the other."""
    assert kind_and_fault(struck(-2.0, (-4.1, 0.3, -1.0, 0.0))) == (CollisionKind.REAR, True)


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
