"""Claims about the example of docs/reference/scenarios.md: it is found, and it tells drivers apart on paper."""

from pathlib import Path

import pytest

from basu.scenarios.cases import cases_of
from basu.scenarios.playable import Playable
from basu.testing import Driver, Rehearsal, careful, offline_place, rehearse, steady

ROOT = Path(__file__).parents[4]
EXAMPLE = ROOT / "examples" / "scenarios" / "bin_lorry.xml"


@pytest.fixture(name="playable", scope="module")
def playable_() -> Playable:
    (found,) = cases_of(str(EXAMPLE))
    return found


def rehearsed(playable: Playable, driver: Driver) -> Rehearsal:
    place = offline_place([(0.0, 0.0), (100.0, 0.0)])
    return rehearse(playable.scenario(place, playable.values), driver)


def test_the_case_has_its_value_and_the_defaults(playable: Playable) -> None:
    assert playable.scenario.title() == "A bin lorry stands in the lane and drives on after a while."
    assert playable.values == {"ahead": 50.0, "stands": 8.0, "vehicle": "lorry"}


def test_an_ego_that_waits_gets_by_and_one_that_does_not_hits_the_lorry(playable: Playable) -> None:
    waited = rehearsed(playable, careful(6.0))
    assert waited.over
    assert waited.contacts_s == {}
    assert waited.phases_s["resolution"] - waited.phases_s["conflict"] > 8.0
    assert set(rehearsed(playable, steady(6.0)).contacts_s) == {"lorry"}
