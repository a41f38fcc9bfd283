"""The incident of 20 February 2020 as a run: nothing against it by the thesis, everything by its passengers."""

import json
import runpy
from pathlib import Path

import pytest

from basu.cli import main
from servers import RunningServer

PLOT = Path(__file__).parents[3] / "examples" / "passengers_plot.py"


@pytest.mark.slow
def test_the_incident_scores_1_by_the_thesis_and_fails_by_its_passengers(
    simulator: RunningServer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    words = [
        "run",
        "incident",
        "--details",
        "--in-process",
        *address,
        "--routes",
        "routes/linden_short.xml",
        "--output",
        str(tmp_path),
    ]
    assert main(words) == 0
    assert "phantom stop" in capsys.readouterr().out
    result = json.loads((tmp_path / "latest" / "result.json").read_text(encoding="utf-8"))
    assert result["status"] == "Completed"
    assert result["infractions"] == []
    assert result["scores"]["infraction"] == 1.0
    assert round(result["scores"]["driving"], 3) == 1.0
    passengers = result["passengers"]
    assert passengers["passed"] is False
    (stop,) = passengers["harsh_stops"]
    assert stop["cause"]["kind"] == "nothing"
    assert stop["from_mps"] == pytest.approx(7.1 * 0.44704, abs=0.02)
    assert stop["strongest_mps2"] == pytest.approx(3.6, abs=0.4)
    assert stop["to_rest"]
    picture = tmp_path / "felt.png"
    runpy.run_path(str(PLOT))["draw"]([tmp_path / "latest"], picture, around_s=stop["t_s"])
    assert picture.read_bytes().startswith(b"\x89PNG")
