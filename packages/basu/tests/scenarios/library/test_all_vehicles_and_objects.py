"""Claims that hold for all leaders, objects and junctions of the thesis, offline at their places in Linden."""

from collections.abc import Callable

import pytest

from basu.scenarios.cases import open_library
from basu.scenarios.parameters import Choice
from basu.scenarios.scenario import Scenario
from basu.testing import careful, rehearse, steady

Laid = Callable[..., Scenario]


LIBRARY = open_library()


SHUTTLE_MPS = 6.7


FAST_MPS = 9.0  # an ego has to be faster than a leader at 7 m/s to hit it


# the actors met by an ego that drives on blindly
MET = {
    "FollowLeadingVehicle": "leader",
    "FollowLeadingVehicleWithObstacle": "leader",
    "LeadVehicleBrakes": "leader",
    "StopAndGo": "leader",
    "LeadVehicleSwerves": "standing",
    "StaticObject": "object",
    "DynamicObject": "object",
}


AT_JUNCTIONS = ("UnsignalizedIntersection", "Roundabout")


WHOLE = ["setup", "trigger", "conflict", "resolution", "end"]


def names(*kinds: str) -> list[str]:
    return [case.name for case in LIBRARY.cases if case.type in kinds]


@pytest.mark.parametrize("kind", [*MET, *AT_JUNCTIONS])
def test_each_has_three_cases_or_more_on_the_route_and_off_it(kind: str) -> None:
    found = [case.on_route for case in LIBRARY.cases if case.type == kind]
    assert len(found) >= 3
    assert set(found) == {True, False}


@pytest.mark.parametrize("name", names(*MET))
def test_an_ego_that_drives_on_meets_them(laid: Laid, name: str) -> None:
    scenario = laid(name)
    played = rehearse(scenario, steady(FAST_MPS))
    assert MET[type(scenario).__name__] in played.contacts_s


@pytest.mark.parametrize("name", [name for name in names(*MET) if not name.startswith("static_object")])
def test_an_ego_that_brakes_for_what_is_ahead_is_unharmed_and_sees_the_end(laid: Laid, name: str) -> None:
    played = rehearse(laid(name), careful(SHUTTLE_MPS))
    assert not played.contacts_s
    assert played.over
    assert list(played.phases_s) == WHOLE


@pytest.mark.parametrize("kind", [*MET, *AT_JUNCTIONS])
def test_every_choice_can_be_played(laid: Laid, kind: str) -> None:
    for name in names(kind):
        (playable,) = LIBRARY.of_id(name)
        for choice in playable.parameters:
            for option in choice.options if isinstance(choice, Choice) else ():
                assert laid(name, **{choice.name: option}).actors(), name
