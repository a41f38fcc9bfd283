"""The page of rules is complete: each infraction, end of a run and verdict, and rules numbered without a gap."""

import re
from itertools import groupby

import pytest

from basu.conditions import TRACKS
from basu.metrics.infraction import Infraction
from basu.outcome import Status
from basu.scenarios.verdict import Verdict
from docs.pages import ROOT

TEXT = (ROOT / "docs" / "reference" / "rules.md").read_text("utf-8")
CODE = re.compile(r"`(\w+)`")


@pytest.mark.parametrize(
    "names",
    [
        pytest.param({kind.value for kind in Infraction}, id="infractions"),
        pytest.param({status.value for status in Status}, id="ends of a run"),
        pytest.param(set(TRACKS), id="tracks"),
    ],
)
def test_each_name_stands_on_the_page(names: set[str]) -> None:
    assert names - set(CODE.findall(TEXT)) == set()


def test_each_verdict_has_a_row_that_gives_it() -> None:
    table = TEXT.split("| verdict | if |")[1].split("\n\n")[0]
    given = {name for row in table.splitlines()[2:] for name in row.split("|")[1].strip().split(", ")}
    assert given == {verdict.value for verdict in Verdict}


def test_rules_are_numbered_by_section_without_a_gap() -> None:
    numbers = [tuple(map(int, found)) for found in re.findall(r"^\| (\d+)\.(\d+) \|", TEXT, re.MULTILINE)]
    assert len(numbers) > 90
    for section, rules in groupby(numbers, key=lambda number: number[0]):
        count = len(list(rules))
        assert numbers[:count] == [(section, index + 1) for index in range(count)], section
        numbers = numbers[count:]


def test_references_to_rules_lead_to_one() -> None:
    known = set(re.findall(r"^\| (\d+\.\d+) \|", TEXT, re.MULTILINE))
    named = {each for found in re.findall(r"\(((?:\d+\.\d+(?:, )?)+)\)", TEXT) for each in found.split(", ")}
    assert named
    assert named <= known
