"""Claims about collisions: messages become contacts, contacts carry evidence."""

import pytest

from basu.metrics.collisions import collisions, kind_of
from basu.metrics.infraction import Infraction
from fakes.drives import STEP_S, at, driven, hit, ramp


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
