"""Claims about the models on the grids of vehicles ahead: BASU's half of the page, and what must be so in any model."""

import re
from pathlib import Path

import numpy as np
import pytest

from basu.metrics.careful_driver.metric import MODELS
from basu.metrics.careful_driver.model import CarefulDriver
from grids_ahead import FRONT_M, cut_out_contacts, deceleration_contacts

PAGE = Path(__file__).parents[5] / "docs" / "reference" / "careful-drivers.md"
COMPARED = [model for model in MODELS if model.name != "Reg157"]
pytestmark = pytest.mark.unmeasured


@pytest.mark.parametrize("model", COMPARED, ids=lambda model: model.name)
@pytest.mark.parametrize(
    ("situation", "grid"), [("cut-out", cut_out_contacts), ("deceleration", deceleration_contacts)]
)
def test_the_page_has_the_contacts_of_the_grid(situation: str, grid: object, model: CarefulDriver) -> None:
    assert callable(grid)
    found = grid(model)
    text = PAGE.read_text(encoding="utf-8")
    row = re.search(rf"^\| {situation} \| {model.name} \| ([\d,]+) \| [\d,]+ \| ([\d,]+) \|", text, re.MULTILINE)
    assert row is not None
    assert [int(each.replace(",", "")) for each in row.groups()] == [found.size, int(found.sum())]


@pytest.mark.parametrize("model", COMPARED, ids=lambda model: model.name)
def test_a_standing_vehicle_right_behind_the_leader_is_harder_to_avoid_than_a_distant_one(model: CarefulDriver) -> None:
    by_gap = cut_out_contacts(model).sum(axis=(0, 2))
    assert len(by_gap) == len(FRONT_M)
    assert by_gap[:5].sum() > by_gap[-5:].sum()


@pytest.mark.parametrize("model", COMPARED, ids=lambda model: model.name)
def test_a_gentle_braking_ahead_is_always_avoided(model: CarefulDriver) -> None:
    assert not np.any(deceleration_contacts(model)[:10])
