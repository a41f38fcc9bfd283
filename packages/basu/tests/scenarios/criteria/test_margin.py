"""Claims about things that are put elsewhere: each place is theirs for its time alone."""

import pytest

from basu.scenarios.criteria import LeastDistance, StandingThing
from basu.scenarios.criteria.criterion import Move, moved
from basu.scenarios.stage import Pose
from fakes.drives import at, driven
from fakes.played import played

SHUT, OPEN = Pose(30.0, 3.0), Pose(30.0, 1.8)
DOOR = StandingThing("door", 30.0, 3.0, 0.0, 0.5, 0.1)


def test_a_move_ends_one_place_and_begins_another() -> None:
    found = moved([DOOR], [Move("door", 2.0, OPEN), Move("nobody", 2.5, OPEN), Move("door", 4.0, SHUT)])
    assert [(thing.y_m, thing.from_s, thing.until_s) for thing in found] == [
        (3.0, 0.0, 2.0),
        (1.8, 2.0, 4.0),
        (3.0, 4.0, None),
    ]


def test_what_is_taken_away_stood_until_then() -> None:
    assert moved([DOOR], [Move("door", 2.0, None), Move("door", 3.0, OPEN)]) == (DOOR._replace(until_s=2.0),)


def test_what_is_put_elsewhere_before_it_was_seen_stood_nowhere_else() -> None:
    (found,) = moved([DOOR], [Move("door", 0.0, OPEN)])
    assert (found.y_m, found.until_s) == (1.8, None)


@pytest.mark.parametrize(
    ("opens_s", "shuts_s", "least_m"),
    [(2.0, 4.0, 1.8 - 1.0 - 0.1), (0.5, 1.0, 3.0 - 1.0 - 0.1)],
    ids=["then", "before"],
)
def test_a_door_is_near_while_it_is_open(opens_s: float, shuts_s: float, least_m: float) -> None:
    """The ego is beside it from 2.75 s to 3.25 s."""
    things = moved([DOOR], [Move("door", opens_s, OPEN), Move("door", shuts_s, SHUT)])
    assert LeastDistance().judge(played(driven(at(10.0, 5.0)), things=things)).measured == pytest.approx(least_m)
