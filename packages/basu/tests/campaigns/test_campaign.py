"""Claims about campaigns as a whole, with a player that computes rows: nothing is lost or counted twice."""

import importlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from basu.campaigns import command, planning
from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.columns import VOLATILE
from basu.campaigns.command import describe, run_campaign
from basu.campaigns.drive_table import read_drives
from basu.campaigns.records import kept_in
from basu.campaigns.report import write_campaign_report
from basu.campaigns.settings import read_campaign
from basu.campaigns.status import status
from basu.errors import UserError
from basu.running.folder_lock import is_locked, locked
from ray_clusters import connected_cluster

Write = Callable[..., Path]
DRIVER = (
    "import sys; from pathlib import Path; from importlib import import_module; from basu.campaigns import command;"
    "from basu.agents.loader import load_agent; from basu.campaigns import planning;"
    "planning.find_agent = lambda typed, **_: load_agent(typed);"  # without the agents' process
    "command.drive_player = import_module(sys.argv[1]).spec;"
    "settings = command.RunSettings(file=Path(sys.argv[2]), output=Path(sys.argv[3]), workers=2,"
    " resume=sys.argv[4] == 'True');"
    "sys.exit(command.run_campaign(settings))"
)


@pytest.fixture
def run(modules: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """A function that runs a campaign in this process and returns its folder."""
    monkeypatch.setattr(command, "drive_player", importlib.import_module(modules).spec)

    def play(file: Path, output: str = "campaigns", **settings: Any) -> Path:
        given = RunSettings(file=file, output=tmp_path / output, workers=2, **settings)
        assert run_campaign(given) == 0
        return tmp_path / output / "crossings"

    return play


def steady(folder: Path) -> pa.Table:
    """The rows without hosts and times."""
    return read_drives(folder).drop_columns(list(VOLATILE))


@pytest.mark.usefixtures("here")
def test_a_campaign_leaves_a_row_for_each_drive_and_folders_of_the_telling_ones(
    run: Callable[..., Path], campaign: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = run(campaign())
    table = read_drives(folder)
    assert table["number"].to_pylist() == list(range(60))
    assert {"parameter_speed", "driving_score", "passengers_comfort_score", "stops_served"} <= set(table.column_names)
    for agent in ("basic", "blind"):
        kept = [each for each in kept_in(folder) if each.agent == agent]
        rows = [row for row in table.to_pylist() if row["agent"] == agent]
        narrowest = sorted((row["severity"], row["id"]) for row in rows if row["success"])[-2:]
        assert sorted((each.severity, each.id) for each in kept if each.reason == "narrowest") == narrowest
        failed = {row["id"] for row in rows if not row["success"]}
        of_failures = {each.id for each in kept if each.reason == "failure"}
        assert len(of_failures) == min(3, len(failed))
        assert of_failures <= failed
    assert "60 drives" in capsys.readouterr().out
    assert "finished" in status(folder)
    page = write_campaign_report(folder).read_text(encoding="utf-8")
    for heading in ("Success", "side by side", "begins to fail", "Worst cases", "Comfort and service", "Cost"):
        assert heading in page


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("more", ['tracks = {blind = "objects"}', 'open = true\ntracks = {blind = "objects"}'])
def test_no_table_of_the_page_has_agents_of_two_tracks(run: Callable[..., Path], campaign: Write, more: str) -> None:
    folder = run(campaign(('name = "crossings"', f'name = "crossings"\n{more}'), ("sweep = 10", "sweep = 2")))
    page = write_campaign_report(folder).read_text(encoding="utf-8")
    figures = page[: page.index("<h2>Cost")]  # costs compare no score
    tables = re.findall(r"<table.*?</table>", figures, re.DOTALL)
    named = [{name for name in ("basic", "blind") if re.search(rf">\s*{name}\b", table)} for table in tables]
    assert {"basic"} in named
    assert {"blind"} in named
    assert {"basic", "blind"} not in named
    assert "no score is compared across tracks" in page
    assert ("NOT COMPARABLE: open" in page) is ("open" in more)


@pytest.mark.usefixtures("here")
def test_a_campaign_goes_on_and_equals_an_undisturbed_one(run: Callable[..., Path], campaign: Write) -> None:
    file = campaign()
    part = run(file, "part", drives=13)
    assert read_drives(part).num_rows == 13
    assert "13 of 60" in status(part)
    assert "stopped" in status(part)
    run(file, "part", resume=True)
    assert steady(part).equals(steady(run(file)))


@pytest.mark.usefixtures("here")
def test_a_folder_that_an_earlier_version_left_is_read_and_goes_on(
    run: Callable[..., Path], campaign: Write, tmp_path: Path
) -> None:
    """The folder is one of version 0.1.0 before campaigns were batches: 2 of 4 drives, real ones."""
    folder = tmp_path / "campaigns" / "crossings"
    shutil.copytree(Path(__file__).with_name("campaign_of_version_1"), folder)
    assert "2 of 4" in status(folder)
    file = campaign(
        ('["basic", "blind"]', '["basic"]'), ("number = 3", "number = 1"), ("sweep = 10", "sweep = 4"), ("= 8", "= 64")
    )
    document = json.loads((folder / "campaign.json").read_text())
    begun(folder, file, {**document["identity"], "the version of basu": "0.0"})
    with pytest.raises(UserError, match=r'begun differently: .*the version of basu was "0\.0" and is'):
        run(file, resume=True)
    begun(folder, file, {})  # as if this version had been installed then: the drives of both can stand side by side
    run(file, resume=True)
    rows = read_drives(folder).to_pylist()
    assert [row["message"] == "computed" for row in rows] == [False, False, True, True]
    assert [row["host"] for row in rows] == ["earlier", "earlier", "here", "here"]
    assert "Success" in write_campaign_report(folder).read_text(encoding="utf-8")


def begun(folder: Path, file: Path, identity: dict[str, Any]) -> None:
    """Let a campaign have been begun under the conditions of ``identity``; where there is none, of the present."""
    path = folder / "campaign.json"
    present = planning.plan_of(read_campaign(file), file).identity()
    path.write_text(json.dumps({**json.loads(path.read_text()), "identity": {**present, **identity}}))


@pytest.mark.usefixtures("here")
def test_killed_workers_and_drivers_lose_nothing_and_count_nothing_twice(
    run: Callable[..., Path], campaign: Write, modules: str, tmp_path: Path
) -> None:
    file = campaign()
    undisturbed = run(file)
    killed = tmp_path / "killed" / "crossings"
    environment = {**os.environ, "DRIVE_S": "0.02"}

    def start() -> subprocess.Popen[bytes]:
        words = [sys.executable, "-c", DRIVER, modules, str(file), str(killed.parent), str(killed.exists())]
        return subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    for rows in (5, 25):
        driver = start()
        _wait(killed, rows, driver)
        for child in _children(driver.pid):
            os.kill(child, signal.SIGKILL)
        _wait(killed, rows + 5, driver)
        driver.kill()
        driver.wait()
    assert start().wait(120.0) == 0
    assert steady(killed).equals(steady(undisturbed))
    assert not list((killed / "journal").iterdir())


def _rows(folder: Path) -> int:
    lines = sum(path.read_bytes().count(b"\n") for path in folder.glob("journal/*.jsonl") if path.exists())
    return lines + 4 * len(list(folder.glob("drives/*/*.parquet")))


def _children(pid: int) -> list[int]:
    """Workers below a driver: children that play jobs, not the agents' processes that it asks for names."""
    found = []
    for path in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in path.read_text().split():
            words = Path(f"/proc/{child}/cmdline").read_bytes()
            if b"basu.jobs.processes" in words:
                found.append(int(child))
    return found


def _wait(folder: Path, rows: int, driver: subprocess.Popen[bytes]) -> None:
    """Wait until so many rows are written."""
    deadline_s = time.monotonic() + 120.0
    while _rows(folder) < rows and driver.poll() is None:
        assert time.monotonic() < deadline_s
        time.sleep(0.005)


def test_a_drive_that_kills_its_workers_is_a_row_that_says_so(
    run: Callable[..., Path], campaign: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DEADLY", "sweep-10-0-4:")
    folder = run(campaign(("number = 3", "number = 1")))
    lost = [row for row in read_drives(folder).to_pylist() if row["status"] == "BenchmarkFailed"]
    assert len(lost) == 2
    assert all("died 3 times" in row["message"] and not row["judged"] and row["success"] is None for row in lost)
    assert "2 drives were ended by a fault" in write_campaign_report(folder).read_text(encoding="utf-8")


def test_a_campaign_stops_where_the_question_is_answered(run: Callable[..., Path], campaign: Write) -> None:
    rule = "\n[until]\nwidth = 0.5\nleast = 8\nevery = 10\n"
    file = campaign(("number = 3", "number = 30"), more=rule)
    first, again = run(file), run(file, "again")
    number = read_drives(first).num_rows
    assert number < 600
    assert number % 10 == 0
    assert steady(first).equals(steady(again))
    assert "the question is answered" in status(first)
    run(file, resume=True)
    assert read_drives(first).num_rows == number


@pytest.mark.usefixtures("here")
def test_two_runs_on_one_folder_are_refused(run: Callable[..., Path], campaign: Write, tmp_path: Path) -> None:
    file = campaign()
    with locked(tmp_path / "campaigns" / "crossings"):
        assert is_locked(tmp_path / "campaigns" / "crossings")
        with pytest.raises(UserError, match="another command drives"):
            run(file)
    run(file, drives=2)
    with pytest.raises(UserError, match="holds a campaign already; add --resume"):
        run(file)
    with pytest.raises(UserError, match=r"there is no campaign in .* to go on with"):
        run(file, "elsewhere", resume=True)


@pytest.mark.usefixtures("here")
def test_a_campaign_does_not_go_on_under_other_conditions(
    run: Callable[..., Path], campaign: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(campaign(), drives=2)
    with pytest.raises(UserError, match=r"was begun differently: .*the number of drives was 60 and is 40"):
        run(campaign(("number = 3", "number = 2")), resume=True)
    monkeypatch.setattr("basu.campaigns.plan.versions", lambda: {"basu": "9.9"})
    with pytest.raises(UserError, match=r'the version of basu was .* and is "9\.9"'):
        run(campaign(), resume=True)


def test_a_campaign_can_be_described_without_a_drive(campaign: Write) -> None:
    assert "in all    30 conditions, 60 drives" in describe(campaign())


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is no folder of a campaign"):
        status(tmp_path)


def test_a_campaign_on_a_cluster_equals_one_of_processes(run: Callable[..., Path], campaign: Write) -> None:
    pytest.importorskip("ray")
    file = campaign(("number = 3", "number = 1"))
    with connected_cluster(cpus=2):
        on_cluster = run(file, "cluster", ray="auto")
    assert steady(on_cluster).equals(steady(run(file)))
