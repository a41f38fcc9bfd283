"""Claims about disengagements: takeovers are counted, a person's own drive is not, miles are the agent's."""

import pytest

from basu.metrics.disengagements import M_PER_MILE, disengagements
from basu.records.history import History
from fakes.drives import at, driven, straight_route


def drive(*manual: tuple[int, int]) -> History:
    """400 m at 10 m/s; a person drives from tick to tick."""
    history = driven(at(10.0, 40.05), route=straight_route(500.0))
    for first, end in manual:
        history.frames["manual"][first:end] = 1
    return history


def test_an_agent_alone_has_none_and_no_miles_between() -> None:
    found = disengagements(drive())
    assert found.events == ()
    assert found.miles_per_disengagement is None
    assert found.autonomous_m == pytest.approx(400.0)


def test_each_takeover_is_one_and_handing_back_is_none() -> None:
    found = disengagements(drive((200, 300), (500, 540)))
    assert [event.tick for event in found.events] == [200, 500]
    assert found.manual_m == pytest.approx(70.0)
    assert found.autonomous_m + found.manual_m == pytest.approx(400.0)
    assert found.miles_per_disengagement == pytest.approx(330.0 / 2 / M_PER_MILE)
    assert found.events[0].detail == "a person took over at 10.00 m/s, after 100 m by the agent, for 5.0 s"


def test_a_person_that_drives_from_the_beginning_takes_nothing_over() -> None:
    found = disengagements(drive((0, 801)))
    assert found.events == ()
    assert (found.autonomous_m, found.manual_m) == (0.0, pytest.approx(400.0))


def test_a_person_that_keeps_the_wheel_is_reported_so() -> None:
    (event,) = disengagements(drive((0, 100), (600, 801))).events
    assert event.tick == 600
    assert event.detail.endswith("after 250 m by the agent, to the end")
