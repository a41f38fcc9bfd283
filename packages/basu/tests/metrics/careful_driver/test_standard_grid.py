"""Claims about the models on the grid of the Joint Research Centre.

The public program's outcomes are under a licence of their own and are not stored. The page has the counts of both,
which ``scripts/outside/careful_drivers.py`` writes; here BASU's half of the page is computed again.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from basu.metrics.careful_driver.metric import MODELS
from basu.metrics.careful_driver.model import CarefulDriver
from standard_grid import (
    GAPS_M,
    LATERAL_MPS,
    by_speeds,
    cases,
    contacts,
    speeds_kmh,
)

PAGE = Path(__file__).parents[5] / "docs" / "reference" / "careful-drivers.md"
ROW = re.compile(r"^\| cut-in \| (\w+) \| 15,930 \| ([\d,]+) \| ([\d,]+) \| ([\d,]+) \| (\d+) \|$", re.MULTILINE)
pytestmark = pytest.mark.unmeasured


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_the_page_has_the_contacts_of_the_grid(model: CarefulDriver) -> None:
    found = contacts(model)
    rows = {row[0]: row[1:] for row in ROW.findall(PAGE.read_text(encoding="utf-8"))}
    public, ours, agree, differ = (int(text.replace(",", "")) for text in rows[model.name])
    assert len(found) == len(cases()) == 15_930
    assert (int(found.sum()), agree + differ) == (ours, 15_930)
    assert abs(public - ours) <= differ


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_a_vehicle_that_keeps_its_lane_is_never_hit(model: CarefulDriver) -> None:
    for _, found in by_speeds(contacts(model)):
        assert not found[0].any()


def test_the_order_of_cases_is_that_of_the_contacts() -> None:
    all_cases = cases()
    for number, (pair, _) in enumerate(by_speeds(np.zeros(len(all_cases), dtype=bool))):
        case = all_cases[3 * len(speeds_kmh()) * len(GAPS_M) + number * len(GAPS_M) + 7]
        assert (case.own_kmh, case.other_kmh) == pair
        assert (case.gap_m, case.lateral_mps) == (GAPS_M[7], LATERAL_MPS[3])


def test_the_models_that_anticipate_hit_least() -> None:
    """Mattas and others 2022: anticipation reduces the number of unpreventable cases."""
    number = {model.name: int(contacts(model).sum()) for model in MODELS}
    assert max(number["FSM"], number["RSS"]) < min(number["CC"], number["Reg157"])
