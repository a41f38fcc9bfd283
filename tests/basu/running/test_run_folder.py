"""Claims about what is needed to run again: the command in config.json says what was asked for, and nothing else."""

from pathlib import Path

import pytest

from basu.cli import main, run
from basu.metrics.score import Scoring
from basu.options import RunOptions
from basu.routing.route_file import RouteDescription
from basu.running.run_folder import command

ROUTE = RouteDescription(id="1", town="Linden", points=(), stops=(), source="r.xml")


def heard(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> tuple[RunOptions, Scoring]:
    """What the command line makes of a command, up to where anything would be started."""
    found = []
    monkeypatch.setattr("basu.running.runner.run", lambda options, scoring: found.append((options, scoring)) or 0)
    assert main(words) == 0
    return found[0]


@pytest.mark.parametrize(
    "words",
    [
        ["basic"],
        ["forward", "--routes", "my routes.xml", "--seed", "9", "--record"],
        ["basic", "--vehicles", "30", "--walkers", "4", "--weather", "ClearSunset", "--vehicle", "vehicle.audi.tt"],
        ["basic", "--traffic-density", "2.5", "--penalty", "stop_sign=0.5", "--infraction-weight", "0.7"],
        ["basic", "--speeding-tolerance", "0.5", "--route-deviation", "3"],
    ],
)
def test_the_command_of_a_run_asks_for_the_same_again(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> None:
    options, scoring = heard(monkeypatch, ["run", *words])
    program, *again = command(options, scoring, ROUTE, options.seed)
    assert program == "basu"
    same, same_scoring = heard(monkeypatch, again)
    assert same_scoring == scoring
    assert (same.route_id, same.output) == ("1", Path("runs"))
    for name in ("agent", "routes", "seed", "weather", "vehicle", "traffic", "record"):
        assert getattr(same, name) == getattr(options, name), name


def test_no_option_is_promised_for_later_but_sumo() -> None:
    assert set(run.LATER) == {"sumo"}
