"""Tests of ``basu.metrics.fault``: the ten encounters of docs/reference/fault.md, and what is near to them."""

import pytest

from basu.metrics.fault import responsibility
from fakes.encounters import Encounter, by_nuplan, encounters


@pytest.mark.parametrize("encounter", encounters(), ids=lambda encounter: encounter.title)
def test_the_verdict_of_each_encounter_stays(encounter: Encounter) -> None:
    history = encounter.history
    found = responsibility(history, history.collisions[0])
    print(found, by_nuplan(history))
    assert (found.at_fault, by_nuplan(history)) == (encounter.at_fault, encounter.at_fault_by_nuplan)
