"""Claims about lane invasions: events are counted, corners are not, and the score does not know."""

from basu.metrics.reported import lane_invasions
from basu.metrics.score import score
from basu.metrics.scoring import Scoring
from basu.records.history import LaneInvasion
from fakes.drives import at, driven

EVENTS = (
    LaneInvasion(tick=3, markings=("Solid/Yellow", "Solid/Yellow")),
    LaneInvasion(tick=9, markings=("Broken/White",)),
)


def test_two_corners_over_one_line_are_one_invasion() -> None:
    found = lane_invasions(driven(at(5.0, 5.0), lane_invasions=EVENTS))
    assert found.total == 2
    assert found.by_marking == (("Broken/White", 1), ("Solid/Yellow", 1))


def test_lane_invasions_do_not_enter_the_score() -> None:
    speeds_mps = at(10.0, 20.1)
    assert score(driven(speeds_mps, lane_invasions=EVENTS), Scoring()) == score(driven(speeds_mps), Scoring())
