"""Claims about settings as words: every model comes back from the command line and from the file that it makes."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args, get_origin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.cli import main, parser
from basu.cli.typed_options import scoring_of
from basu.errors import UserError
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.options.sumo import SUMO_DEMAND, SUMO_OFF, SUMO_RANDOM
from basu.running.scenario_runs.options import ScenarioOptions
from basu.settings.command_line import typed
from basu.settings.forms import words_of
from basu.settings.option import Field, Layer, Settings, choices, fields_of, to_json
from basu.settings.resolve import resolve

MODELS = (RunOptions, Scoring, ScenarioOptions)
COMMAND: dict[type, list[str]] = {RunOptions: ["run"], Scoring: ["run"], ScenarioOptions: ["scenario", "run"]}
ANY = st.text(st.characters(exclude_categories=("C",)), min_size=1, max_size=12).filter(
    lambda text: str(Path(text)) == text
)
NAMES = st.text(st.characters(exclude_categories=("C",), exclude_characters=",=-"), min_size=1, max_size=12)
SPECIAL: dict[str, st.SearchStrategy[Any]] = {
    "beside": st.lists(NAMES, max_size=3),  # two roles that are the same are refused
    "maps": st.lists(st.sampled_from([str(folder) for folder in Path(__file__).parents[:3]]), max_size=2),
    "sumo": st.sampled_from((None, SUMO_DEMAND, SUMO_RANDOM, SUMO_OFF)),  # a file would have to be there
}


def values_of(field: Field) -> st.SearchStrategy[Any]:
    """Any value that an option may have, as JSON has it."""
    option, kind = field.option, field.type
    if field.name in SPECIAL:
        return SPECIAL[field.name]
    if option.style == "pairs":
        return st.lists(st.tuples(NAMES, ANY).map(list), max_size=3)
    if get_origin(kind) is tuple:
        entries = NAMES.filter(lambda text: str(Path(text)) == text) if option.positional or option.style else ANY
        return st.lists(entries, min_size=1 if field.default else 0, max_size=3)
    numbers = st.floats(
        max(option.least, option.above, -1e9), min(option.most, 1e9), exclude_min=option.above > option.least
    )
    if get_origin(kind) is Mapping or dataclasses.is_dataclass(kind) or hasattr(kind, "_fields"):
        shape = dict.fromkeys(to_json(field.default), numbers)
        return st.fixed_dictionaries(shape).filter(lambda numbers: sum(map(abs, numbers.values())) > 0.0)
    kinds = set(get_args(kind)) or {kind}
    if bool in kinds:
        return st.booleans()
    if float in kinds:
        found: st.SearchStrategy[Any] = numbers
    elif int in kinds:
        found = st.integers(int(max(option.least, -1e9)), int(min(option.most, 1e9)))
    else:
        found = st.sampled_from(choices(kind)) if choices(kind) else ANY
    return found | st.none() if type(None) in kinds else found


def refused_by_a_rival(model: type[Settings], given: dict[str, Any]) -> list[str]:
    """The options that do not go together with an option before them."""
    rivals: set[str] = set()
    found = []
    for field in fields_of(model):
        rival = field.option.rival
        if rival is not None and given[field.name] != field.default:
            if rival in rivals:
                found.append(field.name)
            rivals.add(rival)
    return found


def refused_by_sumo(given: dict[str, Any]) -> tuple[str, ...]:
    """The options that do not go together with what SUMO is to do."""
    demand = ("sumo_hour", "sumo_scale")
    density = ("traffic_density",) if given.get("sumo") == SUMO_RANDOM else ()
    if given.get("sumo_port") is not None:  # that SUMO has its own options
        return (*demand, *density, "sumo_output")
    return (*demand, *density) if density else ()


@st.composite
def settings(draw: st.DrawFn, model: type[Settings]) -> Settings:
    """A model with random values that do not contradict each other."""
    given = {field.name: draw(values_of(field)) for field in fields_of(model)}
    for name in refused_by_a_rival(model, given):
        del given[name]
    if given.get("series") is None:
        given.pop("resume", None)
    if given.get("host") is not None:
        given.pop("maps", None)  # those of a simulator that basu starts
    else:
        given.pop("upload_map", None)  # to a simulator that is running
    if given.get("series") is not None:  # it counts one vehicle a run
        given.pop("shuttles", None)
        given.pop("beside", None)
    elif len(given.get("beside", ())) >= given.get("shuttles", 1):
        given.pop("shuttles", None)
    if given.get("watch_shuttle", 1) > max(given.get("shuttles", 1), 1 + len(given.get("beside", ()))):
        given.pop("watch_shuttle")  # there are not so many
    for name in refused_by_sumo(given):
        given.pop(name, None)
    if given.get("open") or given.get("track") not in (None, "sensors"):
        given.pop("leaderboard_track", None)  # allows an agent its sensors alone
    if given.get("in_process"):
        given.pop("agent_memory_gb", None)  # without a process there is no memory to limit
        given.pop("agent_writes", None)  # nor anything that it may not write
    return resolve(model, [Layer(given)])


PARSERS = {model: parser(words) for model, words in COMMAND.items()}


def heard(model: type[Settings], words: list[str]) -> Settings:
    """What the real command line makes of words."""
    parsed = PARSERS[model].parse_args([*COMMAND[model], *words])
    if model is Scoring:
        return scoring_of(parsed, Layer({}))
    return resolve(model, [Layer(typed(model, parsed), typed=True)])


@pytest.mark.parametrize("model", MODELS)
@given(data=st.data())
def test_the_words_of_a_model_make_the_same_model(model: type[Settings], data: st.DataObject) -> None:
    chosen = data.draw(settings(model))
    assert heard(model, words_of(chosen)) == chosen


@pytest.mark.parametrize("model", MODELS)
@given(data=st.data())
def test_the_json_of_a_model_makes_the_same_model(model: type[Settings], data: st.DataObject) -> None:
    chosen = data.draw(settings(model))
    assert resolve(model, [Layer(json.loads(json.dumps(to_json(chosen))), "a file")]) == chosen


@pytest.mark.parametrize("model", MODELS)
def test_the_usual_needs_no_words_beside_its_subject(model: type[Settings]) -> None:
    subject = {RunOptions: ["basic"], Scoring: [], ScenarioOptions: ["all"]}[model]
    assert words_of(model()) == subject


@pytest.mark.parametrize("model", MODELS)
def test_every_option_stands_on_the_help_page_with_its_meaning(
    model: type[Settings], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    words = [*COMMAND[model], "--help"]
    with pytest.raises(SystemExit):
        parser(words).parse_args(words)
    page = capsys.readouterr().out
    for field in fields_of(model):
        assert (field.option.help in page) == (not field.option.in_files), field.name
        assert field.option.positional or field.option.in_files or f"{field.flag}" in page, field.name


def test_what_few_need_stands_in_a_file_or_a_text_and_has_no_flag(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = '{"comfort_weights": {"service": 0.5}}'
    file = tmp_path / "scoring.json"
    file.write_text(text, "utf-8")
    assert heard(Scoring, ["--scoring", text]) == heard(Scoring, ["--scoring", str(file)])
    assert words_of(heard(Scoring, ["--scoring", text]))[0] == "--scoring"
    with pytest.raises(SystemExit):
        main(["run", "basic", "--comfort-weight", "service=0.5"])
    assert f"--comfort-weight is no option any more: write it as in --scoring '{text}'" in capsys.readouterr().err
    with pytest.raises(UserError, match=r"--scoring \{x is no JSON"):
        heard(Scoring, ["--scoring", "{x"])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "--sead", "3"], "basu run: there is no option --sead; did you mean '--seed'?"),
        (["run", "--stepp-limit=3"], "there is no option --stepp-limit; did you mean '--step-limit'?"),
        (["run", "--step", "3"], "there is no option --step"),
        (["scenario", "run", "all", "--agents", "x"], "there is no option --agents; did you mean '--agent'?"),
        (["score", "x", "--harsh-stops", "3"], "there is no option --harsh-stops; did you mean '--harsh-stop'?"),
        (["scenario", "rnu"], "basu scenario: COMMAND is 'rnu', which means nothing; did you mean 'run'?"),
        (["run", "basic", "forward"], "'forward' is one word too many"),
    ],
)
def test_an_unknown_option_gets_a_suggestion(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        parser(words).parse_args(words)
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--seed", "x"], "--seed is 'x'; it must be a whole number"),
        (["--seed", "1.5"], "--seed is '1.5'; it must be a whole number"),
        (["--timeout", "nan"], "--timeout is nan; it must be a finite number"),
        (["--vehicles", "3", "--traffic-density", "2"], "--vehicles and --traffic-density exclude each other"),
        (["--route-id", "3", "--routes-subset", "2"], "--route-id and --routes-subset exclude each other"),
        (["--port", "70000"], "--port is 70000; it must be in 1..65535"),
    ],
)
def test_a_value_that_an_option_cannot_have_is_named_with_its_flag(words: list[str], sentence: str) -> None:
    with pytest.raises(UserError, match=f"^{sentence}"):
        heard(RunOptions, words)


@pytest.mark.parametrize("command", [["run", "basic"], ["scenario", "run", "all"]])
def test_a_flag_of_an_earlier_version_is_refused_with_what_replaces_it(
    command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*command, "--hud-camera", "96x64"])
    assert "--hud-camera is no option any more: --watch shows the drive" in capsys.readouterr().err
