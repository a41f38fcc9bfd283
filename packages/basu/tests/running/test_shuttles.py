"""Claims about runs with several vehicles under test: each has its agent, record, judgement and end."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.files import read_json
from basu.options.run import RunOptions
from basu.output.report.shuttles import links, read_shuttles
from basu.records.history.files import read_history
from basu.results import RunResult, load
from basu.running import agent_drive
from servers import RunningServer

VOLATILE = {"wall_s", "started", "first_server_frame"}
AGENT = """
import os, time

class {name}(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        {deed}
        return carla.VehicleControl(throttle={throttle})

    def config(self):
        return {{"track": {track!r}, "weather": "WetSunset"}}
"""
Drives = Callable[..., tuple[int, Path]]


@pytest.fixture
def drives(simulator: RunningServer, tmp_path: Path, short_piece: Path) -> Drives:
    """``basu run`` at the shared simulator; the exit code and the folder."""

    def run(agent: object, *options: object, name: str = "runs") -> tuple[int, Path]:
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        words = ["--routes", str(short_piece), "--output", str(tmp_path / name)]
        words += [] if {"--headway", "usual"} & {*options, name} else ["--headway", "14"]
        code = main(["run", str(agent), *address, *words, *map(str, options)])
        return code, tmp_path / name / "latest"

    return run


@pytest.fixture
def short_piece(tmp_path: Path) -> Path:
    """The first two hundred metres or so of the short route."""
    whole = Path(__file__).parents[2] / "src" / "basu" / "routes" / "linden_short.xml"
    points = [line for line in whole.read_text(encoding="utf-8").splitlines() if "<position" in line]
    path = tmp_path / "piece.xml"
    path.write_text(
        '<routes><route id="piece" town="Linden"><waypoints>' + "\n".join(points[:6]) + "</waypoints></route></routes>",
        encoding="utf-8",
    )
    return path


def agent(folder: Path, name: str, *, deed: str = "pass", throttle: float = 0.3, track: str = "world") -> Path:
    """An agent's file."""
    path = folder / f"{name.lower()}.py"
    path.write_text(AGENT.format(name=name, deed=deed, throttle=throttle, track=track), encoding="utf-8")
    return path


def document(folder: Path, name: str) -> dict[str, Any]:
    found: dict[str, Any] = read_json(folder / name, "a document", "")
    return found


def plain(folder: Path) -> dict[str, Any]:
    """The result of one vehicle without times of this machine."""
    result = document(folder, "result.json")
    result["meta"] = {key: value for key, value in result["meta"].items() if key not in VOLATILE}
    return result


def test_two_shuttles_have_a_record_and_a_judgement_each_and_the_same_bytes_again(drives: Drives) -> None:
    options = ["--shuttles", 2, "--seed", 3, "--stop-after", 8, "--vehicles", 3]
    (_, first), (_, again) = drives("basic", *options, name="one"), drives("basic", *options, name="other")
    assert document(first, "shuttles.json")["shuttles"][1]["start_m"] == 14.0
    records = [read_history(first), read_history(first / "shuttle_2")]
    assert [len(record.frames) for record in records] == [161, 161]
    assert records[0].facts.route.length_m - records[1].facts.route.length_m == pytest.approx(14.0, abs=1.0)
    apart_m = records[0].frames[0]["x_m"] - records[1].frames[0]["x_m"]
    assert abs(apart_m) == pytest.approx(14.0, abs=1.0)
    for record in records:
        assert 1 in record.facts.actor_types
        assert record.facts.actor_types[1] == "vehicle.easymile.ez10"
    for name in ("history.parquet", "route.json", "path.png", "shuttle_2/history.parquet", "shuttle_2/route.json"):
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    assert plain(first) == plain(again)
    assert plain(first / "shuttle_2") == plain(again / "shuttle_2")
    assert (first / "shuttles.json").read_bytes() == (again / "shuttles.json").read_bytes()


def test_one_shuttle_is_the_run_as_it_always_was(drives: Drives) -> None:
    (_, usual), (_, one) = (
        drives("basic", "--stop-after", 3, name="usual"),
        drives("basic", "--stop-after", 3, "--shuttles", 1, "--headway", 100, name="one"),
    )
    assert {path.name for path in usual.iterdir()} == {path.name for path in one.iterdir()}
    assert not (one / "shuttles.json").exists()
    for name in ("history.parquet", "route.json"):
        assert (usual / name).read_bytes() == (one / name).read_bytes()
    config = document(one, "config.json")
    assert not {"shuttle", "shuttles", "beside", "headway_m"} & {*config, *config["options"]}
    assert config["options"] == document(usual, "config.json")["options"]
    assert plain(usual) == plain(one)


@pytest.mark.parametrize(
    ("deed", "status"),
    [
        pytest.param("if self.steps > 20: raise ValueError('enough')", "AgentCrashed", id="raises"),
        pytest.param("if self.steps > 20: os._exit(3)", "AgentCrashed", id="dies"),
        pytest.param("if self.steps > 20: time.sleep(60)", "AgentTimedOut", id="hangs"),
    ],
)
def test_an_agent_that_fails_is_judged_alone_and_leaves_the_road(
    drives: Drives, tmp_path: Path, deed: str, status: str
) -> None:
    steady = agent(tmp_path, "Steady")
    failing = agent(tmp_path, "Failing", deed=deed)
    code, folder = drives(steady, "--beside", f"west={failing}", "--step-limit", "1", "--stop-after", "8")
    shuttles = document(folder, "shuttles.json")["shuttles"]
    assert [each["role"] for each in shuttles] == ["hero", "west"]
    assert [each["status"] for each in shuttles] == ["Stopped", status]
    assert code != 0
    failed, driven = read_history(folder / "shuttle_2"), read_history(folder)
    assert len(failed.frames) == 21
    assert len(driven.frames) == 161
    last = int(driven.others["tick"][driven.others["id"] == 1].max())
    assert 21 <= last <= 25, "it is taken away a few steps after its end"
    assert document(folder / "shuttle_2", "config.json")["agent"]["name"] == "failing"
    assert "WetSunset" in document(folder / "shuttle_2", "config.json")["weather"]


def test_an_agent_that_is_never_ready_is_judged_alone(drives: Drives, tmp_path: Path) -> None:
    lame = tmp_path / "lame.py"
    lame.write_text(agent(tmp_path, "Lame").read_text("utf-8").replace("self.steps = 0", "raise ValueError('no')"))
    _, folder = drives(lame, "--beside", "basic", "--stop-after", "2")
    shuttles = document(folder, "shuttles.json")["shuttles"]
    assert [each["status"] for each in shuttles] == ["AgentCrashed", "Stopped"]
    assert not (folder / "history.parquet").exists()
    assert len(read_history(folder / "shuttle_2").frames) == 41


def test_a_contact_of_two_shuttles_is_counted_once_and_judged_for_each(drives: Drives, tmp_path: Path) -> None:
    behind, ahead = agent(tmp_path, "Behind", throttle=0.8), agent(tmp_path, "Ahead", throttle=0.0)
    _, folder = drives(behind, "--beside", ahead, "--stop-after", "9")
    (contact,) = document(folder, "shuttles.json")["contacts"]
    assert contact["between"] == [1, 2]
    assert contact["at_fault"] == [True, False]
    assert contact["sentences"][1] == "not at fault: the ego stood (0.00 m/s) when it was struck"
    for each, at_fault in ((folder, 1), (folder / "shuttle_2", 0)):
        assert document(each, "result.json")["collisions"] == {"number": 1, "at_fault": at_fault}


def test_each_sees_the_other_in_the_track_objects_and_drives_itself_only(drives: Drives, tmp_path: Path) -> None:
    look = (
        "others = [each for each in self.world.get_actors().filter('vehicle.*') if each.id != self.vehicle.id]\n"
        "        if self.steps == 2: assert [each.type_id for each in others] == ['vehicle.easymile.ez10'], others\n"
        "        if self.steps == 3: others[0].apply_control(carla.VehicleControl(throttle=1.0, steer=1.0))"
    )
    looking = [agent(tmp_path, name, deed=look, throttle=0.0, track="objects") for name in ("One", "Other")]
    _, folder = drives(looking[0], "--beside", looking[1], "--stop-after", "1")
    for each in (folder, folder / "shuttle_2"):
        result = document(each, "result.json")
        assert result["status"] == "Stopped", result["message"]
        assert result["meta"]["access"] == {
            "track": "objects",
            "open": False,
            "refused": {"apply_control_to_vehicle": 1},
        }
        assert not read_history(each).frames["throttle"].any()


def test_agents_of_shuttles_work_at_the_same_time(drives: Drives, tmp_path: Path) -> None:
    slow = [agent(tmp_path, name, deed="time.sleep(0.1)") for name in ("Slow", "Slower")]
    _, folder = drives(slow[0], "--beside", slow[1], "--stop-after", "1")
    wall_s = document(folder, "result.json")["meta"]["wall_s"]
    assert 21 * 0.1 <= wall_s < 1.7 * 21 * 0.1, "the slower one's time, and not the sum"


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"beside": ("west=basic", "west=forward")}, "two shuttles have the role 'west'"),
        ({"beside": ("hero=basic",)}, "two shuttles have the role 'hero'"),
        ({"shuttles": 2, "beside": ("basic", "forward")}, "--shuttles 2 and 2 agents with --beside do not fit"),
        ({"shuttles": 2, "series": "nightly"}, "--series counts the result of one vehicle"),
        ({"watch_shuttle": 2}, "the run has 1 vehicle under test; give a number from 1 to 1"),
    ],
)
def test_what_does_not_fit_gets_a_sentence(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        RunOptions(**options)


def test_the_headway_has_to_fit_on_the_route(drives: Drives, capsys: pytest.CaptureFixture[str]) -> None:
    code, _ = drives("basic", "--shuttles", 2, "--headway", 900)
    assert code == 2
    assert "no vehicle can begin at 900 m" in capsys.readouterr().err


def test_only_the_first_shuttle_has_a_person(drives: Drives, capsys: pytest.CaptureFixture[str]) -> None:
    drives("basic", "--beside", "human")
    assert "a person drives the first shuttle only" in capsys.readouterr().err


def test_a_person_is_shown_the_shuttle_that_the_person_drives(
    drives: Drives, capsys: pytest.CaptureFixture[str]
) -> None:
    drives("human", "--beside", "basic", "--watch-shuttle", 2)
    assert "leave out --watch-shuttle 2" in capsys.readouterr().err


@pytest.mark.parametrize(("number", "agent"), [(1, "basic"), (2, "forward")])
def test_what_shows_a_run_can_show_any_shuttle(
    drives: Drives, monkeypatch: pytest.MonkeyPatch, number: int, agent: str
) -> None:
    shown = []
    monkeypatch.setattr(agent_drive, "output_managers", lambda _, drive: shown.append(drive) or [])
    drives("basic", "--beside", "forward", "--watch-shuttle", number, "--stop-after", 0.5)
    assert [drive.agent for drive in shown] == [agent]


def test_each_report_links_to_the_others() -> None:
    first = {"number": 1, "agents": ["a", "b", "c"]}
    assert [each["report"] for each in links(first)] == ["", "shuttle_2/report.html", "shuttle_3/report.html"]
    assert [each["report"] for each in links({**first, "number": 2})] == [
        "../report.html",
        "",
        "../shuttle_3/report.html",
    ]
    assert links(None) == []


def test_a_document_that_was_changed_gets_a_sentence(tmp_path: Path) -> None:
    assert read_shuttles(tmp_path) is None
    (tmp_path / "shuttles.json").write_text('{"schema_version": 1, "shuttles": []}', encoding="utf-8")
    with pytest.raises(UserError, match=r"shuttles\.json: the document lacks 'contacts'"):
        read_shuttles(tmp_path)


@pytest.mark.pictures
def test_reports_and_python_show_each_shuttle(drives: Drives) -> None:
    _, folder = drives("basic", "--beside", "west=forward", "--stop-after", 1)
    assert '<a href="shuttle_2/report.html">shuttle 2 (forward)</a>' in (folder / "report.html").read_text("utf-8")
    assert '<a href="../report.html">shuttle 1 (basic)</a>' in (folder / "shuttle_2/report.html").read_text("utf-8")
    found = load(folder)
    assert isinstance(found, RunResult)
    assert [each.agent for each in found.shuttles] == ["basic", "forward"]
    assert [each.agent for each in found.shuttles[1].shuttles] == ["forward"]
    assert found.contacts == []


def test_scoring_a_shuttle_again_gives_the_same_judgement(drives: Drives, capsys: pytest.CaptureFixture[str]) -> None:
    _, folder = drives("forward", "--shuttles", 2, "--stop-after", 2)
    capsys.readouterr()
    assert main(["score", str(folder / "shuttle_2"), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again == {key: document(folder / "shuttle_2", "result.json")[key] for key in again}
