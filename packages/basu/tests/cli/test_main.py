"""Claims about the command line: sentences and exit codes, without a simulator."""

import socket
from pathlib import Path

import pytest

from basu.cli import main
from basu.records.history import LaneInvasion
from basu.records.history.files import write_history
from fakes.drives import at, driven, hit

SAMPLE = str(Path(__file__).parents[4] / "examples" / "forward_agent.py")


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Exit code and what stood on stderr."""
    return main(arguments), capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run", "basik"], "did you mean 'basic'"),
        (["rum"], "there is no command 'rum'; did you mean 'run'?"),
        (["run", "basic", "--agent", "forward"], "two values are given for --agent, basic and forward; give one"),
        (["run", "basic", "--sumo", "none.sumocfg"], "--sumo none.sumocfg: there is no such file"),
        (["run", "basic", "--sumo", "much"], "--sumo much: it may be a FILE.sumocfg, random, demand or none"),
        (["run", "basic", "--sumo-radius", "0"], "--sumo-radius is 0 m; it must be above 0"),
        (["run", "basic", "--sumo", "random", "--traffic-density", "5"], "--traffic-density goes without it"),
        (["run", "basic", "--repetitions", "0"], "--repetitions is 0; it must be 1 or more"),
        (["run", "basic", "--step-limit", "0"], "--step-limit is 0 s; it must be above 0"),
        (["run", "basic", "--penalty", "singing=0.5"], "--penalty has no 'singing'; there are collision_pedestrian"),
        (["run", "basic", "--penalty", "speeding=2"], "--penalty speeding is 2; it must be in 0..1"),
        (["run", "basic", "--infraction-weight", "1.5"], "--infraction-weight is 1.5; it must be in 0..1"),
        (["run", "basic", "--routes", "none.xml"], "route file 'none.xml' was not found"),
        (["run", "basic", "--routes", "routes/linden_short.xml", "--route-id", "9"], "has no route '9'"),
        (["run", "basic", "--routes", "routes/linden_short.xml", "--routes-subset", "1,7"], "has no '7'; it has 1"),
        (["run", "basic", "--weather", "Sunny"], "there is no weather called 'Sunny'; there are"),
        (["run", "basic", "--resume", "--output", "nowhere"], "nothing in nowhere was begun with these options"),
        (["run", "basic", "--series", "latest"], "that name is kept for the newest run"),
        (["run", "basic", "--walkers", "-2"], "--walkers is -2; it must be 0 or more"),
        (["score", "nowhere"], "nowhere is no folder"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_code_2(
    capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    code, text = said(capsys, *arguments)
    assert code == 2
    assert text.startswith("basu: ")
    assert sentence in text
    assert len(text.splitlines()) == 1


def test_no_actor_at_the_address_gets_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as reserved:  # bound, not listening: no server answers there
        reserved.bind(("127.0.0.1", 0))
        port = str(reserved.getsockname()[1])
        code, text = said(capsys, "run", "forward", "--host", "127.0.0.1", "--port", port, "--timeout", "0.5")
    assert code == 2
    assert f"no simulator answers at 127.0.0.1:{port}; start one with `linden serve`, or leave out --host" in text


def test_the_list_shows_agents_and_routes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    text = capsys.readouterr().out
    for expected in ("basic", "forward", "routes/linden_leap.xml", "routes/linden_short.xml", "in Linden"):
        assert expected in text


def test_a_record_is_scored_again_with_other_penalties(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    invasions = [LaneInvasion(tick=3, markings=("Solid/White",))]
    write_history(tmp_path, driven(at(10.0, 20.1), collisions=[hit(50)], lane_invasions=invasions))
    assert main(["score", str(tmp_path)]) == 0
    first = capsys.readouterr().out
    assert main(["score", str(tmp_path), "--penalty", "collision_static=0.5"]) == 0
    second = capsys.readouterr().out
    assert "infractions        0.650" in first
    assert "infractions        0.500" in second
    assert "hit static.poles at 10.00 m/s" in first


def test_a_folder_with_a_config_is_damaged_gets_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_history(tmp_path, driven(at(10.0, 1.0)))
    (tmp_path / "config.json").write_text("{}")
    code, text = said(capsys, "score", str(tmp_path))
    assert code == 2
    assert "is not the config of a run" in text


def test_every_command_has_help(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ([], ["run"], ["score"], ["list"]):
        with pytest.raises(SystemExit) as ended:
            main([*command, "--help"])
        assert ended.value.code == 0
        assert "usage: basu" in capsys.readouterr().out


def test_a_second_interruption_is_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("basu.cli._run", interrupted)  # what a second Ctrl-C does while the first is handled
    assert main(["run"]) == 130
    assert capsys.readouterr().err == ""


def test_no_command_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    shown = capsys.readouterr()
    assert "usage: basu" in shown.out
    assert "drive a route and score the drive" in shown.out
    assert shown.err == ""
