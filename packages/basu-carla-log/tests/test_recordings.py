"""Claims about `basu metrics`: a question is answered from a recording alone, and mistakes are sentences."""

import json
from pathlib import Path

import pytest

from basu.cli import main
from fakes import recordings as made

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples" / "metrics"
LINDEN = ROOT / "packages" / "linden" / "src" / "linden" / "data" / "Linden.xodr"
HERO, OTHER = 9, 8


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Two vehicles in Linden: the hero drives on, and touches the other in its last frames."""
    actors = made.added(
        made.actor(HERO, "vehicle.easymile.ez10", 1, attributes=[(3, "role_name", "hero")]),
        made.actor(OTHER, "vehicle.audi.tt", 1),
    )
    frames = []
    for number in range(1, 21):
        parts = [actors] if number == 1 else []
        if number > 17:
            parts.append(made.several(5, "IIIBB", [(1, HERO, OTHER, 1, 0)]))
        parts.append(made.positions((HERO, 100.0 * number, 0, 0, 0, 0, 0), (OTHER, 2500, 0, 0, 0, 0, 0)))
        parts.append(made.several(12, "I6f", [(HERO, 20, 0, 0, 0, 0, 0), (OTHER, 0, 0, 0, 0, 0, 0)]))
        frames.append(made.frame(number, 0.05 * (number - 1), *parts))
    return made.write(tmp_path, made.header(map_name="Linden"), *frames)


def test_figure_5_1_is_drawn_from_a_recording(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plot = tmp_path / "lane.png"
    metric = str(EXAMPLES / "distance_to_lane_center.py")
    assert main(["metrics", str(recording), "--metric", metric, "--map", str(LINDEN), "--plot", str(plot)]) == 0
    said = capsys.readouterr().out
    assert "20 frames, 0.9 s" in said or "20 frames, 1.0 s" in said
    assert f"plot              {plot}" in said
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_contacts_are_reported_once_while_they_last(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["metrics", str(recording), "--metric", str(EXAMPLES / "collisions.py")]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert line.strip() == "0.85 s  vehicle.easymile.ez10 9 touches vehicle.audi.tt 8 at 20.0 m/s"


def test_the_nearest_moment_of_each_other_is_reported(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["metrics", str(recording), "--metric", str(EXAMPLES / "nearest_vehicle.py")]) == 0
    said = capsys.readouterr().out
    assert "vehicle.audi.tt 8: 5.00 m at 1.0 s, ego 20.0 m/s, it 0.0 m/s" in said
    assert "drew a figure; --plot FILE.png keeps what is drawn" in said


def test_a_run_folder_brings_map_and_criteria(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = recording.parent
    recording.rename(folder / "recording.log")
    (folder / "map.xodr").write_bytes(LINDEN.read_bytes())
    (folder / "result.json").write_text(json.dumps({"infractions": [], "scoring": {"penalties": {"speeding": 0.8}}}))
    metric = folder / "told.py"
    metric.write_text(
        "from basu_carla_log.metric_file import BasicMetric\n"
        "class Told(BasicMetric):\n"
        "    def _create_metric(self, town_map, log, criteria):\n"
        "        print(town_map.name, log.get_total_frame_count(), criteria['speeding']['test_status'])\n"
    )
    assert main(["metrics", str(folder), "--metric", str(metric)]) == 0
    assert capsys.readouterr().out == "Linden 20 SUCCESS\n"


def test_a_cut_recording_answers_up_to_its_last_whole_frame(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording.write_bytes(recording.read_bytes()[:-10])
    assert main(["metrics", str(recording), "--metric", str(EXAMPLES / "collisions.py")]) == 0
    said = capsys.readouterr()
    assert said.out.strip().startswith("0.85 s")
    assert said.err.startswith("basu: warning: ")
    assert said.err.strip().endswith("it was read up to frame 19")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["none.py"], "the metric none.py is not there"),
        (["distance_to_lane_center.py"], "give it with --map Linden.xodr"),
        (["collisions.py", "--plot", "nowhere/a.png"], "there is no folder nowhere"),
        (["collisions.py", "--plot", "a.png"], "the metric drew nothing, so there is no a.png"),
        (["collisions.py", "--map", "none.xodr"], "the map none.xodr is not there"),
        (["collisions.py", "--criteria", "none.json"], "the criteria none.json cannot be read"),
    ],
)
def test_a_mistake_is_one_sentence(
    recording: Path, capsys: pytest.CaptureFixture[str], options: list[str], sentence: str
) -> None:
    name, *others = options
    metric = EXAMPLES / name
    assert main(["metrics", str(recording), "--metric", str(metric if metric.exists() else name), *others]) == 2
    said = capsys.readouterr().err
    assert said.startswith("basu: ")
    assert sentence in said
    assert len(said.splitlines()) == 1
