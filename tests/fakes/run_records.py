"""Run records of drives that never took place, for claims about reports and comparisons."""

from pathlib import Path
from typing import Any

from basu.metrics.result import judge
from basu.outcome import Outcome, Status
from basu.output.report.documents import CONFIG_FILE, RESULT_FILE, RunRecord, write_json
from basu.output.report.streets import Streets, write_streets
from basu.records.history import History
from basu.records.history.files import write_history
from fakes.drives import at, driven, hit, stop_sign, straight_route
from fakes.results import META

STREETS = Streets([[(-60.0, 0.0), (260.0, 0.0)], [(100.0, -80.0), (100.0, 80.0)]], ["Long Street", ""])


def crashing() -> History:
    """Too fast from the beginning, over a stop sign at 60 m, into a pole at 100 m, where it stays."""
    route = straight_route(controls=(stop_sign(60.0),))
    return driven([*at(15.0, 6.65), *at(0.0, 20.0)], route=route, limit_mps=11.0, collisions=[hit(133)])


def record(history: History | None, *, agent: str = "tester", message: str = "as told", route: str = "1") -> RunRecord:
    """What a run with this history would leave."""
    meta: dict[str, Any] = {
        **META,
        "agent": {"name": agent, "class": "Tester", "file": "tester.py"},
        "route": route,
        "town": "Nowhere",
    }
    outcome = Outcome(Status.COMPLETED if history is not None else Status.SETUP_FAILED, message)
    return RunRecord(
        name="a-run",
        config={"command": ["basu", "run", agent, "--seed", "0"], "seed": 0},
        result=judge(outcome, history, meta=meta),
        history=history,
        streets=STREETS,
    )


def written(folder: Path, run: RunRecord) -> Path:
    """The files of a record in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / CONFIG_FILE, run.config)
    write_json(folder / RESULT_FILE, run.result.document())
    write_streets(folder, run.streets)
    if run.history is not None:
        write_history(folder, run.history)
    return folder
