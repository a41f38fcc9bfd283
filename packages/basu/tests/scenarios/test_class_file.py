"""Claims about a user's Python file of scenarios: an error in it is reported with its line."""

from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.scenarios.class_file import own_scenarios, users_scenarios

HEAD = """from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoArrives
class Mine(Scenario):
    group = Group.ANIMAL
    def trigger(self): return EgoArrives()
    def conflict(self): return EgoArrives()
    def criteria(self): return []
"""


def loaded(folder: Path, text: str) -> list[str]:
    path = folder / "my_scenarios.py"
    path.write_text(text)
    return [scenario.__name__ for scenario in users_scenarios(path)]


def test_basus_own_are_in_the_order_of_their_names() -> None:
    found = [scenario.__name__ for scenario in own_scenarios()]
    assert found == sorted(found)


def test_only_what_a_file_defines_itself_is_its_own(tmp_path: Path) -> None:
    assert loaded(tmp_path, HEAD) == ["Mine"]


def test_a_file_may_import_what_lies_beside_it(tmp_path: Path) -> None:
    (tmp_path / "part_of_my_scenarios.py").write_text("NAME = 'Mine'")
    assert loaded(tmp_path, "from part_of_my_scenarios import NAME\n" + HEAD) == ["Mine"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "holds no subclass of Scenario; see docs/reference/scenarios.md"),
        ("class Mine(:", "is no Python: line 1"),
        (HEAD + "\nspeed = fast\n", "does not load: line 11: NameError: name 'fast' is not defined"),
        ("import no_such_thing", "does not load: line 1: ModuleNotFoundError"),
        ("raise SystemExit(3)", "does not load: line 1: SystemExit: 3"),
        (
            HEAD.replace("conflict", "conflikt"),
            "Mine in .* lacks conflict; a scenario has trigger, conflict and criteria",
        ),
        (HEAD.replace("    group = Group.ANIMAL\n", ""), "names no group; write `group = Group.PEDESTRIAN`"),
        (HEAD + "    group = 'animal'", "names no group"),
        (HEAD + "    aliases = 'CutIn'", r"has aliases = 'CutIn', a text; write \('CutIn',\)"),
        (HEAD + "    weather = {'cloudines': 3.0}", "has the weather 'cloudines', .*use cloudiness"),
        (HEAD + "    timeout_s = 0.0", "has timeout_s 0 and needs_m 60"),
        (HEAD + "    parameters = ('speed',)", "has 'speed' among its parameters, which is no Number and no Choice"),
        (HEAD + "    parameters = (Number('a', 9, 1, 5, 'm', ''),)", "'a' with default 9, which is outside 1 to 5"),
        (HEAD + "    parameters = (Number('a', 1, 1, 1, 'm', ''),)", "'a' from 1 to 1; the range must go up and end"),
        (HEAD + "    parameters = (Number('a', 1, 0, float('inf'), '', ''),)", "the range must go up and end"),
        (HEAD + "    parameters = (Number('weather', 1, 0, 2, '', ''),)", "'weather'; it must be a word in snake case"),
        (HEAD + "    parameters = (Number('A b', 1, 0, 2, '', ''),)", "'A b'; it must be a word in snake case"),
        (HEAD + "    parameters = (Number('a', 1, 0, 2, '', ''),) * 2", "the parameter 'a' twice"),
        (HEAD + "    parameters = (Choice('a', ('x',), ''),)", "'a' with options .*two different words or more"),
        (HEAD + "    parameters = (Choice('a', ('x', 'y:z'), ''),)", "'a' with the option 'y:z'; letters, digits"),
    ],
)
def test_a_file_that_cannot_be_used_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        loaded(tmp_path, text)


def test_a_file_that_is_not_there_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"none\.py does not exist; check the name and the folder you are in"):
        users_scenarios(tmp_path / "none.py")
