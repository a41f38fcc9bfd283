"""Claims about layers of settings: which goes before which, and how a complaint names its source."""

from pathlib import Path
from typing import Any

import pytest

from basu.cli import parser
from basu.errors import UserError
from basu.metrics.infraction import DEFAULT_PENALTIES, Infraction
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.settings.command_line import typed
from basu.settings.option import Layer
from basu.settings.resolve import from_keywords, resolve


def test_a_later_layer_goes_before_an_earlier_one() -> None:
    file = Layer({"seed": 3, "walkers": 4}, "c.json", "options")
    found = resolve(RunOptions, [file, Layer({"seed": 5}, typed=True)])
    assert (found.seed, found.walkers) == (5, 4)


def test_an_option_clears_its_rivals_below() -> None:
    file = Layer({"routes_subset": "0-3", "vehicles": 0, "traffic_density": 4.0}, "c.json")
    found = resolve(RunOptions, [file, Layer({"route_id": "1", "vehicles": 0}, typed=True)])
    assert (found.route_id, found.routes_subset) == ("1", None)
    assert (found.vehicles, found.traffic_density) == (0, None)


def test_an_object_keeps_what_a_later_layer_does_not_name() -> None:
    layers = [Layer({"penalties": {"speeding": 0.1}}, "c.json"), Layer({"penalties": {"stop_sign": 0.2}}, typed=True)]
    changed = {Infraction.SPEEDING: 0.1, Infraction.STOP_SIGN: 0.2}
    assert resolve(Scoring, layers).penalties == {**DEFAULT_PENALTIES, **changed}


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"sede": 1}, "c.json: options.sede means nothing; did you mean 'seed'?"),
        ({"seed": "7"}, "c.json: options.seed is '7'; it must be a whole number"),
        ({"seed": True}, "c.json: options.seed is True; it must be a whole number"),
        ({"step_limit_s": 0}, "c.json: options.step_limit_s is 0 s; it must be above 0"),
        ({"scenario_files": "a.py"}, "c.json: options.scenario_files is 'a.py'; it must be a list"),
        ({"track": "mirror"}, "c.json: options.track is 'mirror'; it must be one of world, objects, sensors"),
        (
            {"vehicles": 1, "traffic_density": 2.0},
            "c.json: options.vehicles and c.json: options.traffic_density exclude",
        ),
        ({"in_process": True, "agent_memory_gb": 1.0}, "c.json: --agent-memory limits the agent's own process"),
    ],
)
def test_a_complaint_about_a_file_names_path_and_key(values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError) as raised:
        resolve(RunOptions, [Layer(values, "c.json", "options")])
    assert str(raised.value).startswith(sentence)


def test_a_complaint_about_python_names_the_keyword() -> None:
    with pytest.raises(UserError, match=r"^step_limit_s is -1 s; it must be above 0$"):
        resolve(RunOptions, [Layer({"step_limit_s": -1.0})])
    with pytest.raises(UserError, match=r"^step_limit means nothing; did you mean 'step_limit_s'"):
        resolve(RunOptions, [Layer({"step_limit": 1.0})])


def test_keywords_may_be_python_values() -> None:
    found = from_keywords(RunOptions, output=Path("there"), scenario_files=(Path("a.py"),), agent_writes=(Path("b"),))
    assert (found.output, found.scenario_files, found.agent_writes) == (Path("there"), (Path("a.py"),), ("b",))
    assert from_keywords(Scoring, penalties={Infraction.SPEEDING: 0.5}).penalties[Infraction.SPEEDING] == 0.5
    with pytest.raises(UserError, match=r"^agent is <class 'int'>; it must be a text, a number"):
        from_keywords(RunOptions, agent=int)


def test_a_flag_can_be_undone() -> None:
    file = Layer({"record": True, "with_scenarios": False}, "c.json")
    words = ["run", "--no-record", "--with-scenarios"]
    given = Layer(typed(RunOptions, parser(words).parse_args(words)), typed=True)
    assert resolve(RunOptions, [file, given]) == RunOptions()


def test_bounds_hold_for_models_that_are_made_directly() -> None:
    with pytest.raises(UserError, match="walkers is -2; it must be 0 or more"):
        RunOptions(walkers=-2)


def test_an_option_of_an_earlier_version_is_forgotten_unless_it_changed_the_run() -> None:
    assert resolve(RunOptions, [Layer({"sumo_sublane": False}, "old.json", "options")]) == RunOptions()
    with pytest.raises(UserError, match=r"old.json: options.sumo_sublane is no option any more: write <lateral-res"):
        resolve(RunOptions, [Layer({"sumo_sublane": True}, "old.json", "options")])
