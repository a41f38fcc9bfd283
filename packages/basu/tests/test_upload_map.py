"""Claims about `--upload-map`: a simulator at --host drives a map that BASU sent."""

import json
from pathlib import Path

import carla
import pytest

from basu.cli import main
from basu.simulator import Simulator
from opendrive_texts import street_through_junction
from servers import RunningServer, running_server


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    """An OpenDRIVE map that no simulator has, named Crossing."""
    file = tmp_path / "Crossing.xodr"
    file.write_text(street_through_junction())
    return file


@pytest.fixture
def route_file(map_file: Path, tmp_path: Path) -> Path:
    """A route of the town Crossing: 30 m along its first lane."""
    first = carla.Map("Crossing", map_file.read_text()).generate_waypoints(5.0)[0]
    points = [first.next(ahead)[0].transform.location for ahead in (8.0, 18.0, 38.0)]
    rows = "".join(f'<position x="{p.x:.3f}" y="{p.y:.3f}" z="{p.z:.3f}"/>' for p in points)
    file = tmp_path / "crossing.xml"
    file.write_text(
        f'<routes><route id="1" town="Crossing"><waypoints>{rows}</waypoints></route></routes>', encoding="utf-8"
    )
    return file


def test_a_map_that_was_sent_is_driven(map_file: Path, route_file: Path, tmp_path: Path) -> None:
    with running_server() as server:
        address = ["--host", "127.0.0.1", "--port", str(server.port)]
        words = ["--routes", str(route_file), "--upload-map", str(map_file), "--output", str(tmp_path / "runs")]
        assert main(["run", "basic", *address, *words]) == 0
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert result["status"] == "Completed"
    assert result["meta"]["town"] == "Crossing"


@pytest.mark.parametrize(
    ("content", "sentence"),
    [(None, "cannot be read: "), ("<svg/>", "is no OpenDRIVE; `linden map build")],
)
def test_what_cannot_be_sent_is_refused(
    content: str | None, sentence: str, simulator: RunningServer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "x.xodr"
    if content is not None:
        file.write_text(content)
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    assert main(["run", "basic", *address, "--upload-map", str(file), "--output", str(tmp_path / "runs")]) == 2
    assert sentence in capsys.readouterr().err


def test_a_simulator_of_our_own_is_sent_none(map_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "basic", "--upload-map", str(map_file)]) == 2
    assert "--upload-map sends a map to the simulator at --host" in capsys.readouterr().err


def test_only_the_town_that_was_sent_has_another_name() -> None:
    sent = Simulator(None, ("", 0), own=False, why_gone=lambda: None, ended=lambda: False, uploaded="Crossing")  # type: ignore[arg-type]
    assert (sent.map_name("Crossing"), sent.map_name("Linden")) == ("OpenDriveMap", "Linden")
