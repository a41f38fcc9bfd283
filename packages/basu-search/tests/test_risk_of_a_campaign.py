"""Claims about the risk of a campaign: a failure rate that was put in is in its interval, plain and with weights."""

import importlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from basu.campaigns import command
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import run_campaign
from basu.campaigns.drive_table import read_drives
from basu.campaigns.planning import plan_of
from basu.campaigns.risk_cases import played_in
from basu.campaigns.search_space import values_at
from basu.campaigns.settings import read_campaign
from basu.cli import main
from basu.errors import UserError
from basu.scenarios.nhtsa import Group
from basu.scenarios.risk.estimate import PlayedCase, risk
from basu.scenarios.risk.exposure import Counted
from basu_search.findings import rare_in, searches_in

Write = Callable[..., Path]
RADIUS = {"basic": 0.25, "blind": 0.35}  # of the circle of failures in the fake player
MET = {Group.PEDESTRIAN: Counted(100_000, 1e6)}  # conflicts that were counted: the probability alone is uncertain
ESTIMATE = "estimate = {drives = 400, learn = 100, batch = 100, normal = {speed = {mean = 1.0, deviation = 0.15}}}"
ONE_SEED = ("number = 3", "number = 1")


@pytest.fixture
def ran(
    modules: str, campaign: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, here: None
) -> Callable[..., Path]:
    """A function that runs a campaign with failures in a circle, and returns its folder."""
    file = campaign(ONE_SEED, ("sweep = 10", ESTIMATE))
    part = plan_of(read_campaign(file), file).parts[0].search
    assert part is not None
    monkeypatch.setenv("DISC", json.dumps({each.name: [each.low, each.high] for each in part.spaces[0]}))
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)

    def play(drives: str) -> Path:
        given = RunSettings(file=campaign(ONE_SEED, ("sweep = 10", drives)), output=tmp_path / "campaigns", workers=2)
        assert run_campaign(given) == 0
        return tmp_path / "campaigns" / "crossings"

    return play


def failing_share(folder: Path, agent: str) -> float:
    """The probability of a failure under the estimate's own distribution, from a fine grid of its quantiles."""
    drives = next(each for each in searches_in(folder, read_drives(folder)) if each.about["agent"] == agent)
    at = (np.arange(400) + 0.5) / 400
    inside = 0
    for first in at:
        for second in at:
            values: dict[str, Any] = values_at(drives.space, np.array([first, second]))
            shares = [(values[each.name] - each.low) / (each.high - each.low) for each in drives.space]
            inside += np.hypot(shares[0] - 0.4, shares[1] - 0.55) <= RADIUS[agent]
    return inside / len(at) ** 2


def crashes(cases: list[PlayedCase]) -> tuple[float, float, float]:
    found = risk(cases, MET).rates["crashes"]
    return found.low / 100_000, found.value / 100_000, found.high / 100_000


@pytest.mark.parametrize("agent", list(RADIUS))
def test_the_rate_of_a_sweep_holds_the_share_of_the_space_that_fails(ran: Callable[..., Path], agent: str) -> None:
    cases = played_in(ran("sweep = 150"))[agent]
    assert len(cases) == 150
    low, value, high = crashes(cases)
    truth = np.pi * RADIUS[agent] ** 2
    assert low < truth < high
    assert value == pytest.approx(truth, rel=0.25)
    assert not low < 2.0 * truth < high


@pytest.mark.parametrize("agent", list(RADIUS))
def test_the_rate_of_an_estimate_is_that_of_its_weights(ran: Callable[..., Path], agent: str) -> None:
    folder = ran(ESTIMATE)
    cases = played_in(folder)[agent]
    assert len(cases) == 400  # drives that moved the proposal do not count
    low, value, high = crashes(cases)
    rare = next(
        rare_in(each, 0.95) for each in searches_in(folder, read_drives(folder)) if each.about["agent"] == agent
    )
    assert value == pytest.approx(rare.found.value)
    truth = failing_share(folder, agent)
    assert low < truth < high
    unweighted = [case._replace(weight=1.0, plain=1.0) for case in cases]
    assert crashes(unweighted)[1] > 1.3 * value  # without its weights the proposal would be taken for the world


def test_without_a_failure_an_estimate_knows_as_much_as_its_plain_drives(ran: Callable[..., Path]) -> None:
    cases = [case._replace(impact_mps=None) for case in played_in(ran(ESTIMATE))["basic"]]
    low, value, high = crashes(cases)
    assert (low, value) == (0.0, 0.0)
    assert high > 1.0 - 0.05 ** (1.0 / 40.0)  # 400 drives with a tenth of plain ones


def test_the_command_reads_the_folder_of_a_campaign(
    ran: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = ran("sweep = 10")
    assert main(["scenario", "risk", str(folder)]) == 0
    assert "1 of 9 groups played" in capsys.readouterr().out
    found = json.loads((folder / "risk.json").read_text(encoding="utf-8"))
    assert found["blind"]["rates"]["crashes"]["value"] > 0.0
    assert (folder / "risk.html").exists()


def test_the_drives_of_a_search_are_no_sample(ran: Callable[..., Path]) -> None:
    with pytest.raises(UserError, match="a search chooses its drives at the boundary"):
        played_in(ran("search = {drives = 24, batch = 4}"))


def test_a_campaign_of_an_earlier_version_is_refused_with_what_to_do(ran: Callable[..., Path]) -> None:
    folder = ran("sweep = 10")
    for path in (folder / "drives").rglob("*.parquet"):
        pq.write_table(pq.ParquetFile(path).read().drop_columns(["completed"]), path)
    with pytest.raises(UserError, match=r"have no column 'completed'.*drive the campaign again"):
        played_in(folder)
