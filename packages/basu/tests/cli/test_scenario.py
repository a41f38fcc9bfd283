"""Claims about `basu scenario list`: group, place, parameters and cases, as text and JSON, without a simulator."""

import json
from pathlib import Path

import pytest

from basu.cli import main, parser
from basu.errors import ScenarioError
from basu.scenarios.characteristics import Characteristics

CLASSES = """
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoArrives

class FallingTree(Scenario):
    '''A tree falls.'''
    group = Group.ROAD_DEPARTURE
    aliases = ("TheirTree",)
    parameters = (Number("ahead", 40, 20, 80, "m", "of the trigger point"), Choice("side", ("left", "right"), "of it"))
    def trigger(self): return EgoArrives()
    def conflict(self): return EgoArrives()
    def criteria(self): return []
"""
CASES = """<scenarios>
<scenario name="tree_1" type="FallingTree" town="Linden">
  <place name="Cleveland Ave" route="true"/><ego_vehicle x="1" y="2" yaw="0"/><ahead value="25"/>
</scenario>
<scenario name="tree_2" type="TheirTree" town="Linden">
  <ego_vehicle x="-12.6" y="2" yaw="0"/><flow_speed value="25"/>
</scenario>
</scenarios>"""


@pytest.fixture(name="mine")
def mine_(tmp_path: Path) -> str:
    (tmp_path / "mine.py").write_text(CLASSES)
    (tmp_path / "mine.xml").write_text(CASES)
    return str(tmp_path / "mine.xml")


def told(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    arguments = parser(["scenario", "list"]).parse_args(["scenario", "list", *words])
    assert arguments.command(arguments) == 0
    return capsys.readouterr().out


def test_the_list_has_group_count_title_places_and_parameters(capsys: pytest.CaptureFixture[str], mine: str) -> None:
    lines = told(capsys, "--scenarios", mine).splitlines()
    assert "ROAD DEPARTURE: 547,098 crashes a year, 97,737 million dollars" in lines
    begin = next(index for index, line in enumerate(lines) if line.startswith("  falling_tree "))
    assert lines[begin] == "  falling_tree (2 cases): A tree falls."
    assert lines[begin + 1] == "      at   Cleveland Ave, on the route; (-13, 2) of Linden"
    assert lines[begin + 2] == "      with ahead 40 (20 to 80) m; side left | right"


def test_what_is_named_is_shown_in_full_and_alone(capsys: pytest.CaptureFixture[str], mine: str) -> None:
    text = told(capsys, mine)
    assert [" ".join(line.split()) for line in text.splitlines()] == [
        "ROAD DEPARTURE: 547,098 crashes a year, 97,737 million dollars",
        "falling_tree (2 cases): A tree falls.",
        "ahead 40 (20 to 80) m of the trigger point",
        "side left | right of it",
        "tree_1 Cleveland Ave, on the route",
        "tree_2 (-13, 2) of Linden (not read: flow_speed, of ScenarioRunner's class)",
        "",
        "1 scenario of 1 group, 2 cases",
    ]


def test_the_list_as_json_has_everything(capsys: pytest.CaptureFixture[str], mine: str) -> None:
    assert json.loads(told(capsys, "tree_1", "--scenarios", mine, "--json")) == {
        "scenarios": [
            {
                "type": "FallingTree",
                "name": "falling_tree",
                "group": "road departure",
                "title": "A tree falls.",
                "aliases": ["TheirTree"],
                "parameters": [
                    {
                        "name": "ahead",
                        "about": "of the trigger point",
                        "unit": "m",
                        "default": 40.0,
                        "low": 20,
                        "high": 80,
                    },
                    {"name": "side", "about": "of it", "unit": "", "default": "left", "options": ["left", "right"]},
                ],
                "cases": [
                    {
                        "id": "tree_1",
                        "town": "Linden",
                        "place": "Cleveland Ave",
                        "on_route": True,
                        "values": {"ahead": 25.0, "side": "left"},
                        "unread": [],
                        "characteristics": Characteristics().document(),
                    }
                ],
            }
        ]
    }


def test_a_word_that_means_nothing_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ScenarioError, match="there is no scenario 'zzz'"):
        told(capsys, "zzz")


def test_where_lists_the_cases_with_a_characteristic_in_full(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenario", "list", "roundabout", "--where", "junction=roundabout"]) == 0
    shown = capsys.readouterr().out
    assert "roundabout_1" in shown
    assert "junction=roundabout" in shown


@pytest.mark.parametrize(
    ("typed", "words"),
    [
        ("lightning=dark", "there is no characteristic 'lightning'; did you mean 'lighting'?"),
        ("lighting=drak", "lighting has no value 'drak'; did you mean 'dark'?"),
        ("lighting", "--where lighting: it must be FIELD=VALUE, such as --where lighting=dark"),
    ],
)
def test_an_unknown_condition_is_refused(typed: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenario", "list", "--where", typed]) == 2
    assert words in capsys.readouterr().err
