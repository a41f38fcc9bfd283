"""The stated partner of each case is in its cast, and no case names another."""

from collections.abc import Callable

import pytest

from basu.records.partners import ACTORS, Partner, partner_of
from basu.scenarios.cases import open_library
from basu.scenarios.characteristics import characteristics_of
from basu.scenarios.playable import Playable
from basu.scenarios.scenario import Scenario

PLAYABLES = open_library().choose(["all"])


@pytest.mark.parametrize("one", PLAYABLES, ids=lambda one: one.case.name)
def test_the_partner_that_a_case_states_is_in_its_cast(laid: Callable[..., Scenario], one: Playable) -> None:
    partner = characteristics_of(one.case, one.scenario).partner
    cast = {partner_of(spec.blueprint) for spec in laid(one.case.name).actors()}
    assert (partner in cast) == (partner in ACTORS)
    assert Partner.NONE not in cast
