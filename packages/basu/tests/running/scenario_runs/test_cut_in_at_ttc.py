"""The cut-in at a chosen difference of speeds and time to collision, played from both sides with two drivers."""

import json
import re
from pathlib import Path

import pytest

from basu.cli import main
from basu.scenarios.library.lane_change.cut_in_at_ttc import WITHIN_KMH, WITHIN_S
from servers import RunningServer

SEEN = re.compile(
    r"the ego was (\S+) km/h faster and (\S+) s from a collision; the case asks for (\S+) km/h and (\S+) s"
)


@pytest.mark.parametrize("case", ["cut_in_at_ttc_1:difference=20,ttc=1.9", "cut_in_at_ttc_2:difference=10,ttc=1.2"])
def test_the_record_has_the_requested_figures_and_a_careful_driver_passes(
    simulator: RunningServer, tmp_path: Path, case: str
) -> None:
    host = ("--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(tmp_path))
    assert main(["scenario", "run", case, "--agent", "basic", "--agent", "blind", *host]) == 1  # of blind
    cases = {}
    for path in (tmp_path / "latest").glob("*/*/result.json"):
        cases[path.parts[-3]] = json.loads(path.read_text(encoding="utf-8"))["case"]
    assert (cases["basic"]["verdict"], cases["blind"]["verdict"]) == ("SUCCESS", "FAILURE")
    for found in cases.values():
        said = SEEN.search(found["assessment"]["exercised"]["sentence"])
        assert said is not None, found["assessment"]
        seen_kmh, seen_s, asked_kmh, asked_s = map(float, said.groups())
        assert abs(seen_kmh - asked_kmh) <= WITHIN_KMH
        assert abs(seen_s - asked_s) <= WITHIN_S
    assert any("neighbour" in hit["other"] for hit in cases["blind"]["collisions"])
