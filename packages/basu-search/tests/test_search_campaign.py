"""Claims about campaigns with a search: they end alike in whatever order workers finish, and the page shows it."""

import importlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from basu.campaigns import command
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.columns import VOLATILE
from basu.campaigns.command import describe, run_campaign
from basu.campaigns.drive_table import read_drives
from basu.campaigns.planning import plan_of
from basu.campaigns.report import write_campaign_report
from basu.campaigns.settings import read_campaign
from basu.errors import UserError
from basu.jobs.processes import Processes
from basu_search.findings import boundary_in, rare_in, searches_in

Write = Callable[..., Path]
SEARCH = ("sweep = 10", "search = {drives = 24, batch = 4}")
ESTIMATE = (
    "sweep = 10",
    "estimate = {drives = 60, learn = 30, batch = 30, normal = {speed = {mean = 1.4, deviation = 0.3}}}",
)
ONE_SEED = ("number = 3", "number = 1")
DRIVER = (
    "import sys; from pathlib import Path; from importlib import import_module; from basu.campaigns import command;"
    "from basu.agents.loader import load_agent; from basu.campaigns import planning;"
    "planning.find_agent = lambda typed, **_: load_agent(typed);"  # without the agents' process
    "command.drive_player = import_module(sys.argv[1]).spec;"
    "settings = command.RunSettings(file=Path(sys.argv[2]), output=Path(sys.argv[3]), workers=3);"
    "sys.exit(command.run_campaign(settings))"
)


@pytest.fixture
def disc(campaign: Write, monkeypatch: pytest.MonkeyPatch, here: None) -> None:
    """Failures lie in a circle of the two parameters."""
    file = campaign(ONE_SEED, SEARCH)
    part = plan_of(read_campaign(file), file).parts[0].search
    assert part is not None
    monkeypatch.setenv("DISC", json.dumps({each.name: [each.low, each.high] for each in part.spaces[0]}))


@pytest.fixture
def run(modules: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, disc: None) -> Callable[..., Path]:
    """A function that runs a campaign in this process and returns its folder."""
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)

    def play(file: Path, output: str = "campaigns", workers: int = 2, **settings: Any) -> Path:
        given = RunSettings(file=file, output=tmp_path / output, workers=workers, **settings)
        assert run_campaign(given) == 0
        return tmp_path / output / "crossings"

    return play


def steady(folder: Path) -> pa.Table:
    """The rows without hosts and times."""
    return read_drives(folder).drop_columns(list(VOLATILE))


def test_a_search_finds_the_boundary_of_each_agent(run: Callable[..., Path], campaign: Write) -> None:
    folder = run(campaign(ONE_SEED, SEARCH))
    found = [boundary_in(drives) for drives in searches_in(folder, read_drives(folder))]
    assert [each.drives.about["agent"] for each in found] == ["basic", "blind"]
    for each, radius in zip(found, (0.25, 0.35), strict=True):
        assert each.share is not None
        assert each.share.low < np.pi * radius**2 < each.share.high
        assert len(each.drives.failed) == 24
    page = write_campaign_report(folder).read_text(encoding="utf-8")
    assert page.count('class="success-map"') == 2
    assert "the boundary lies here" in page
    assert "Wilson" not in page  # the drives are no sample of the whole


@pytest.mark.unmeasured
def test_a_search_ends_alike_in_whatever_order_workers_finish(
    run: Callable[..., Path], campaign: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = campaign(ONE_SEED, SEARCH)
    alone = run(file, "alone", workers=1)
    monkeypatch.setattr(command, "Processes", Processes)
    monkeypatch.setenv("DRIVE_S", "0.03")  # drives take different times
    together = run(file, "together", workers=4)
    assert steady(together).equals(steady(alone))
    names = sorted(path.name for path in (alone / "search").iterdir())
    assert names == ["0-0-basic.json", "0-0-blind.json"]
    assert all((alone / "search" / name).read_bytes() == (together / "search" / name).read_bytes() for name in names)


def test_a_killed_search_goes_on_and_equals_an_undisturbed_one(
    run: Callable[..., Path], campaign: Write, modules: str, tmp_path: Path
) -> None:
    file = campaign(ONE_SEED, SEARCH)
    undisturbed, killed = run(file), tmp_path / "killed" / "crossings"
    words = [sys.executable, "-c", DRIVER, modules, str(file), str(killed.parent)]
    driver = subprocess.Popen(words, env={**os.environ, "DRIVE_S": "0.05"})
    deadline_s = time.monotonic() + 60.0
    while len(list(killed.glob("journal/*"))) == 0 or _lines(killed) < 20:
        assert driver.poll() is None
        assert time.monotonic() < deadline_s
        time.sleep(0.005)
    driver.kill()
    driver.wait()
    assert 0 < _lines(killed) < 48
    run(file, "killed", resume=True)
    assert steady(killed).equals(steady(undisturbed))


def _lines(folder: Path) -> int:
    lines = sum(path.read_bytes().count(b"\n") for path in folder.glob("journal/*.jsonl") if path.exists())
    return lines + 4 * len(list(folder.glob("drives/*/*.parquet")))


@pytest.mark.unmeasured
def test_proposals_that_were_lost_are_made_again(run: Callable[..., Path], campaign: Write) -> None:
    file = campaign(ONE_SEED, SEARCH)
    whole, part = run(file), run(file, "part", drives=40)
    for path in (part / "search").iterdir():
        path.unlink()
    run(file, "part", resume=True)
    assert steady(part).equals(steady(whole))


def test_an_estimate_weighs_its_drives(run: Callable[..., Path], campaign: Write) -> None:
    folder = run(campaign(ONE_SEED, ESTIMATE))
    basic, blind = (rare_in(drives, 0.95) for drives in searches_in(folder, read_drives(folder)))
    assert (basic.found.drives, basic.learned, basic.left_out) == (60, 30, 0)
    assert 0.0 < basic.found.value < blind.found.value
    assert basic.found.low < basic.found.value < basic.found.high
    page = write_campaign_report(folder).read_text(encoding="utf-8")
    assert "How probable a failure is" in page
    assert basic.found.cautions  # 60 drives are few
    assert "do not trust this figure yet" in page
    assert "normal, mean 1.4, deviation 0.3, from" in page


def test_two_cases_and_two_seeds_are_searches_of_their_own(campaign: Write, here: None) -> None:
    more = ("pedestrian_crossing_1", 'pedestrian_crossing_1", "pedestrian_crossing_2')
    file = campaign(("number = 3", "number = 2"), SEARCH, more)
    plan = plan_of(read_campaign(file), file)
    assert plan.size == 2 * 2 * 2 * 24
    places = [plan.search_place(number) for number in range(plan.size)]
    assert all(place is not None and plan.search_number(place) == number for number, place in enumerate(places))
    assert len({(place.key, place.place) for place in places if place is not None}) == plan.size
    assert [place.place for place in places if place is not None][:64] == [
        n for _ in range(4) for n in range(8) for _ in "ab"
    ]
    assert "24 drives of a search over ahead, speed" in describe(file)


@pytest.mark.parametrize(
    ("replaced", "sentence"),
    [
        pytest.param([SEARCH, ('"speed"', '"side"')], "'side' of pedestrian_crossing_1 is a choice", id="choice"),
        pytest.param([SEARCH, ('"speed"', '"sped"')], "has no parameter 'sped' to search over", id="unknown"),
        pytest.param([SEARCH, ("batch = 4}", "batch = 4}\nset = {speed = 1.2}")], "'speed' does not vary", id="set"),
        pytest.param([("sweep = 10", "sweep = 10\nsearch = {drives = 20}")], "sweep and search are two", id="two"),
        pytest.param([("sweep = 10", "search = {drives = 4}")], "drives.0.search.drives is 4", id="too few"),
        pytest.param([("sweep = 10", "search = {drives = 20, first = 30}")], "first is more than drives", id="first"),
        pytest.param([("sweep = 10", "search = {drives = 20, bach = 4}")], "did you mean 'batch'", id="key"),
        pytest.param([("mean = 1.4", "mean = 99.0"), ESTIMATE], "less than 1 % of the normal distribution", id="range"),
        pytest.param([('name = "crossings"', 'name = "crossings"\norder = "shuffled"'), SEARCH],
                     "a search chooses its order", id="order"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_search_is_one_sentence(campaign: Write, here: None, replaced: list[Any], sentence: str) -> None:
    file = campaign(*sorted(replaced, key=lambda each: each != ESTIMATE))
    with pytest.raises(UserError, match=sentence) as raised:
        plan_of(read_campaign(file), file)
    assert "\n" not in str(raised.value)


def test_a_search_stands_alone(campaign: Write) -> None:
    file = campaign(SEARCH, more='\n[[drives]]\nroutes = "routes/linden_short.xml"\n')
    with pytest.raises(UserError, match="put them into a campaign of their own"):
        plan_of(read_campaign(file), file)
