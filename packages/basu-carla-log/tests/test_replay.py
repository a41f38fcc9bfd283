"""Claims about `basu replay`: a recorder file plays on a server of BASU's own, and mistakes are sentences."""

from pathlib import Path

import pytest

from basu.cli import main
from fakes import recordings as made

HERO = 9


def test_a_recorder_file_plays_to_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    actors = made.added(made.actor(HERO, "vehicle.easymile.ez10", 1, attributes=[(3, "role_name", "hero")]))
    frames = [
        made.frame(
            number,
            0.05 * (number - 1),
            *([actors] if number == 1 else []),
            made.positions((HERO, 100.0 * number, 0, 0, 0, 0, 0)),
        )
        for number in range(1, 11)
    ]
    log = made.write(tmp_path, made.header(map_name="Linden"), *frames)
    assert main(["replay", str(log), "--speed", "0"]) == 0
    said = capsys.readouterr().err
    assert "watch it at 127.0.0.1:" in said
    assert "10/10" in said


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["nowhere"], "nowhere is not there"),
        (["{folder}"], "has no recording.log: the run was not recorded; run it with --record"),
        (["{folder}", "--speed", "-1"], "--speed is -1.0; it is a factor, or 0"),
    ],
)
def test_a_mistake_is_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], sentence: str
) -> None:
    assert main(["replay", *(option.format(folder=tmp_path) for option in options)]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("basu: ")
    assert sentence in said


@pytest.mark.parametrize("words", [["--viewer"], ["--save", "a.rrd"], ["--map", "a.xodr"]])
def test_options_of_the_former_viewer_name_the_page(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["replay", "runs/latest", *words])
    assert f"{words[0]} is no option any more: `basu watch RUN` shows a run" in capsys.readouterr().err
