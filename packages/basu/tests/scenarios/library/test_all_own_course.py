"""Claims that hold for all scenarios that disturb the ego's own course, offline."""

from collections.abc import Callable

import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.scenario import Scenario
from basu.testing import rehearse, steady
from fakes.steered_course import steered

Laid = Callable[..., Scenario]


LIBRARY = open_library()


KINDS = ("ControlLoss", "SlipperyStop", "CrossWind", "BendDeparture")


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


@pytest.mark.parametrize("kind", KINDS)
def test_each_has_three_cases_or_more_on_the_route_and_off_it(kind: str) -> None:
    found = [case.on_route for case in LIBRARY.cases if case.type == kind]
    assert len(found) >= 3
    assert set(found) == {True, False}


@pytest.mark.parametrize("name", names(*KINDS))
def test_an_ego_that_keeps_its_course_passes_all_phases_with_its_controls_given_back(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(6.0))
    assert list(played.phases_s) == ["setup", "trigger", "conflict", "resolution", "end"]
    taken = [command.details for command in played.commands if command.what == "disturb"]
    assert taken[0][1] is True
    assert taken[-1][1] is False


@pytest.mark.parametrize("name", names(*KINDS))
def test_nothing_is_done_to_the_controls_before_the_place_nor_after_it(laid: Laid, name: str) -> None:
    told = steered(laid(name))
    off = [number for number, (_, steer) in enumerate(told) if steer != 0.0]
    assert told[off[0]][0] > 15.0
    assert off[-1] < len(told) - 20
