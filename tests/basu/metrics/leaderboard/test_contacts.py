"""Claims about the leaderboard's collisions: which contacts it counts, by party, by place, and by whose fault."""

import pytest

from basu.metrics.leaderboard.contacts import collisions
from basu.metrics.leaderboard.rules import Kind, Version
from basu.records.history import Collision, History
from fakes.drives import at, driven, hit, straight_route

CAR, FENCE = "vehicle.audi.tt", "static.fence"
V1, V2 = Version.V1_0, Version.V2_0


def ticks(history: History, version: Version) -> list[int]:
    return [event.tick for event in collisions(history, version)]


def drive(*contacts: Collision, speed_mps: float = 6.0) -> History:
    return driven(at(speed_mps, 25.0), route=straight_route(400.0), collisions=contacts)


@pytest.mark.parametrize(
    ("other", "kind"),
    [
        ("walker.pedestrian.0001", Kind.COLLISION_PEDESTRIAN),
        (CAR, Kind.COLLISION_VEHICLE),
        (FENCE, Kind.COLLISION_STATIC),
        ("traffic.stop", Kind.COLLISION_STATIC),
    ],
)
def test_what_was_hit_decides_the_kind(other: str, kind: Kind) -> None:
    assert [event.kind for event in collisions(drive(hit(50, other, 4)), V1)] == [kind]


@pytest.mark.parametrize("version", [V1, V2])
def test_a_pavement_is_no_collision(version: Version) -> None:
    assert ticks(drive(hit(50, "static.sidewalk")), version) == []


def test_in_version_2_a_pavement_hides_the_fence_behind_it() -> None:
    contacts = (hit(50, "static.sidewalk"), hit(55, FENCE))
    assert ticks(drive(*contacts), V1) == [55]
    assert ticks(drive(*contacts), V2) == []


@pytest.mark.parametrize("version", [V1, V2])
def test_one_party_counts_again_after_five_seconds(version: Version) -> None:
    contacts = [hit(tick, CAR, 7) for tick in range(50, 240)]
    assert ticks(drive(*contacts), version) == [50, 152]  # forgotten in frame 151, after its message was heard


def test_scraping_along_a_fence_counts_every_three_metres_then_every_five() -> None:
    contacts = [hit(tick, FENCE) for tick in range(50, 151)]  # 30 m at 0.31 m a tick
    assert len(ticks(drive(*contacts, speed_mps=6.2), V1)) == 11
    assert len(ticks(drive(*contacts, speed_mps=6.2), V2)) == 6


@pytest.mark.parametrize(("version", "number"), [(V1, 1), (V2, 0)])
def test_who_stands_and_is_hit_is_at_fault_in_1_0_alone(version: Version, number: int) -> None:
    assert len(ticks(drive(hit(50, CAR, 7), speed_mps=0.0), version)) == number


def test_two_parties_in_one_place_are_one_collision() -> None:
    assert ticks(drive(hit(50, CAR, 7), hit(52, CAR, 8)), V2) == [50]


def test_a_drive_without_contacts_has_no_collision() -> None:
    assert ticks(drive(), V2) == []
