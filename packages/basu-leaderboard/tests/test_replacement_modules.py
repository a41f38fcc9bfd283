"""Claims about standing in for packages: by their names, behind all that is installed, with a sentence for the rest."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from basu_leaderboard import replacement_modules


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A leaderboard that is installed, with one module in it."""
    package = tmp_path / "leaderboard" / "autoagents"
    package.mkdir(parents=True)
    (tmp_path / "leaderboard" / "__init__.py").touch()
    (package / "__init__.py").touch()
    (package / "autonomous_agent.py").write_text("class AutonomousAgent: theirs = True\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield package
    for name in [name for name in sys.modules if name.partition(".")[0] == "leaderboard"]:
        del sys.modules[name]


@pytest.mark.parametrize("name", sorted(replacement_modules.PROVIDED))
def test_every_module_is_there_under_its_name(name: str) -> None:
    replacement_modules.install()
    module = importlib.import_module(name)
    assert replacement_modules.is_ours(name)
    assert module.__doc__


def test_both_ways_to_import_a_module_find_it() -> None:
    replacement_modules.install()
    from leaderboard.autoagents import autonomous_agent  # noqa: PLC0415 - as TransFuser's agents do
    from leaderboard.autoagents.autonomous_agent import Track  # noqa: PLC0415 - as the public agents do

    assert autonomous_agent.Track is Track
    assert Track("MAP") is Track.MAP


def test_without_standing_in_nothing_is_found() -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("leaderboard.autoagents.autonomous_agent")


def test_what_is_installed_goes_before_ours(installed: Path) -> None:
    replacement_modules.install()
    module = importlib.import_module("leaderboard.autoagents.autonomous_agent")
    assert module.AutonomousAgent.theirs
    assert not replacement_modules.is_ours("leaderboard")


def test_ours_never_fill_the_gaps_of_what_is_installed(installed: Path) -> None:
    replacement_modules.install()
    with pytest.raises(ModuleNotFoundError, match=r"^No module named 'leaderboard.utils'$"):
        importlib.import_module("leaderboard.utils.route_manipulation")


@pytest.mark.parametrize(
    ("name", "folder"),
    [
        ("agents.navigation.basic_agent", "put the folder PythonAPI/carla of CARLA 0.9.16 on PYTHONPATH"),
        ("srunner.scenariomanager.scenarioatomics", "is part of ScenarioRunner; put its folder"),
        ("leaderboard.envs", "is part of the CARLA leaderboard; put its folder"),
    ],
)
def test_what_we_do_not_have_is_refused_with_the_folder_that_has_it(name: str, folder: str) -> None:
    replacement_modules.install()
    with pytest.raises(ModuleNotFoundError, match=folder) as refused:
        importlib.import_module(name)
    assert refused.value.name == name


def test_other_names_are_none_of_our_business() -> None:
    replacement_modules.install()
    with pytest.raises(ModuleNotFoundError, match=r"^No module named 'leaderboards'$"):
        importlib.import_module("leaderboards")


def test_standing_in_twice_is_once() -> None:
    replacement_modules.install()
    replacement_modules.install()
    assert sys.meta_path.count(replacement_modules._FINDER) == 1
