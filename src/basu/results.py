"""Results as Python objects: a run with scores, events, record and pictures; a matrix of cases; and how both are read.

Everything comes from the documents in a run's folder, so a result that was just driven and one that is read again later
are the same.
"""

from __future__ import annotations

import base64
import html
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.outcome import Status
from basu.output.report.documents import RESULT_FILE, RunRecord, read_run
from basu.output.report.runs_picture import Trace, paths_png, speeds_png
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE
from basu.output.report.scenarios.matrix_text import matrix_text
from basu.output.report.scenarios.sweep.success_map import sweep_map
from basu.records.history.files import HISTORY_FILE, read_history

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import pandas as pd

    from basu.metrics.infraction import Evidence
    from basu.metrics.result import Result
    from basu.metrics.score import Scores
    from basu.outcome import Outcome
    from basu.records.history import History

SERIES_FILE = "series.json"


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a notebook shows inline: PNG or SVG."""

    data: bytes = field(repr=False)
    kind: str = "png"

    def _repr_png_(self) -> bytes | None:
        return self.data if self.kind == "png" else None

    def _repr_svg_(self) -> str | None:
        return self.data.decode() if self.kind == "svg" else None

    def save(self, path: str | Path) -> Path:
        """Write the picture to a file and return its path."""
        path = Path(path)
        path.write_bytes(self.data)
        return path


class RunResult:
    """One run: how it ended, its scores and events, its record, and pictures of it."""

    def __init__(self, folder: Path) -> None:
        """Read the run's folder.

        Raises:
            UserError: it is none.
        """
        self.folder = folder.resolve()
        self._record: RunRecord = read_run(self.folder)

    def __repr__(self) -> str:
        scores = self.scores
        driving = "nothing was driven" if scores is None else f"driving score {scores.driving:.3f}"
        return f"<{self.agent} on {self.route}: {self.outcome.status.value}, {driving}>"

    @property
    def result(self) -> Result:
        """The judgement as one object, with the value of every metric; docs/reference/result.md describes it."""
        return self._record.result

    @property
    def document(self) -> dict[str, Any]:
        """The result as plain values, as ``result.json`` has them."""
        return self.result.document()

    @property
    def config(self) -> dict[str, Any]:
        """``config.json``: what the run was made with."""
        return self._record.config

    @property
    def agent(self) -> str:
        """The agent's name."""
        return self._record.agent

    @property
    def route(self) -> str:
        """The route's id."""
        return str(self.result.meta["route"])

    @property
    def outcome(self) -> Outcome:
        """The status with a sentence about it; ``outcome.status.fault`` is the party at fault."""
        return self.result.outcome

    @property
    def completed(self) -> bool:
        """Whether the vehicle arrived."""
        return self.outcome.status is Status.COMPLETED

    @property
    def scores(self) -> Scores | None:
        """The thesis's scores in 0 (bad) to 1 (good); None where nothing was driven."""
        return self.result.scores

    @property
    def infractions(self) -> tuple[Evidence, ...]:
        """Every infraction with its time, place, speed, other party, and a collision's responsibility."""
        return self.result.infractions

    @property
    def metrics(self) -> Mapping[str, Any]:
        """The value of every metric by name, users' metrics among them."""
        return {**self.result.metrics, **{name: own.value for name, own in self.result.own.items()}}

    @property
    def history(self) -> History:
        """The record, frame by frame.

        Raises:
            UserError: nothing was driven.
        """
        if self._record.history is None:
            raise UserError(f"{self.folder.name} has no record, because nothing was driven: {self.outcome.message}")
        return self._record.history

    def plot_path(self, *others: RunResult) -> Picture:
        """The paths of this run and others on the streets, with the planned route and the infractions."""
        return Picture(paths_png([_trace(each) for each in (self, *others)], self._record.streets))

    def plot_speed(self, *others: RunResult, by: str = "time") -> Picture:
        """The speeds of this run and others with the posted limit, ``by`` "time" in s or by "route" in m."""
        if by not in {"time", "route"}:
            raise UserError(f"plot_speed() has no axis '{by}'; it may be 'time' or 'route'")
        return Picture(speeds_png([_trace(each) for each in (self, *others)], along_route=by == "route"))

    def _repr_html_(self) -> str:
        """A card for notebooks: status, scores, events, picture."""
        scores = {} if self.scores is None else self.scores._asdict()
        rows = [(name.replace("_", " "), f"{value:.3f}") for name, value in scores.items()]
        rows += [(f"{found.t_s:.1f} s", f"{found.kind.value}: {found.detail}") for found in self.infractions]
        title = html.escape(f"{self.agent} on {self.route}: {self.outcome.status.value}")
        meta = self.result.meta
        sentence = f"{self.outcome.message}; seed {meta['seed']}, {meta['simulated_s']:.1f} s simulated"
        parts = [f"<h4>{title}</h4>", f"<p>{html.escape(sentence)}</p>", _html_table(rows)]
        if self._record.history is not None:
            picture = base64.b64encode(self.plot_path().data).decode()
            parts.append(f'<img alt="the driven path" width="560" src="data:image/png;base64,{picture}">')
        return "\n".join(parts)


@dataclass(frozen=True)
class CaseResult:
    """One case with one agent."""

    folder: Path
    agent: str
    id: str
    scenario: str
    group: str
    parameters: dict[str, Any]
    verdict: str
    status: Status
    message: str
    margins: dict[str, float | None]
    simulated_s: float
    wall_s: float

    @property
    def document(self) -> dict[str, Any]:
        """``result.json`` of the case: its criteria, phases and actors."""
        found = read_json(self.folder / RESULT_FILE, "the case's", "play the case again")
        assert isinstance(found, dict), "we have written it"
        return found

    @cached_property
    def history(self) -> History:
        """The record, frame by frame.

        Raises:
            UserError: nothing was driven.
        """
        if not (self.folder / HISTORY_FILE).exists():
            raise UserError(f"{self.id} with {self.agent} has no record, because nothing was driven: {self.message}")
        return read_history(self.folder)


class ScenarioResults:
    """A matrix of cases and agents."""

    def __init__(self, folder: Path) -> None:
        """Read the folder of ``basu scenario run``.

        Raises:
            UserError: it is none.
        """
        self.folder = folder.resolve()
        document = read_json(self.folder / MATRIX_FILE, "the matrix", "name a folder that `basu scenario run` has left")
        assert isinstance(document, dict), "we have written it"
        self.document: dict[str, Any] = document

    def __repr__(self) -> str:
        return f"<{self.document['what']} with {', '.join(self.agents)}: {len(self.cases)} drives>"

    def __str__(self) -> str:
        return matrix_text(self.document)

    def __iter__(self) -> Iterator[CaseResult]:
        return iter(self.cases)

    @property
    def agents(self) -> tuple[str, ...]:
        """The agents' names, the columns of the matrix."""
        return tuple(self.document["agents"])

    @cached_property
    def cases(self) -> tuple[CaseResult, ...]:
        """Every case with every agent."""
        return tuple(
            _case(self.folder, case, agent, found)
            for case in self.document["cases"]
            for agent, found in case["results"].items()
        )

    @property
    def shares(self) -> dict[str, Any]:
        """The share of the crash cost that each agent's passed cases stand for, as docs/scenarios.md describes it."""
        return dict(self.document["shares"])

    def to_pandas(self) -> pd.DataFrame:
        """A row for each case and agent, with a column for each parameter and margin.

        Raises:
            UserError: pandas is not installed.
        """
        try:
            import pandas as pd  # noqa: PLC0415 - an extra
        except ImportError:
            raise UserError("to_pandas() needs pandas; install it with `pip install linden[tables]`") from None
        rows = [
            {
                "id": case.id,
                "scenario": case.scenario,
                "group": case.group,
                "agent": case.agent,
                "verdict": case.verdict,
                "status": case.status.value,
                "message": case.message,
                **case.margins,
                "simulated_s": case.simulated_s,
                "wall_s": case.wall_s,
                **case.parameters,
            }
            for case in self.cases
        ]
        return pd.DataFrame(rows)

    def plot_sweep(self, agent: str | None = None, scenario: str | None = None) -> Picture:
        """The cases of a sweep in the plane of the two parameters that decide most, with the boundary of failure.

        Raises:
            UserError: no parameter was varied.
        """
        drawn = sweep_map(self.document, agent, scenario)
        if not drawn:
            raise UserError("no parameter was varied in these cases; give sweep=N to run_scenarios()")
        return Picture(drawn.encode(), "svg")

    def _repr_html_(self) -> str:
        """A table for notebooks: how many cases of each scenario every agent passed."""
        scenarios = list(dict.fromkeys(case.scenario for case in self.cases))
        head = "".join(f"<th>{html.escape(agent)}</th>" for agent in self.agents)
        lines = []
        for scenario in scenarios:
            cells = []
            for agent in self.agents:
                found = [case.verdict for case in self.cases if (case.scenario, case.agent) == (scenario, agent)]
                cells.append(f"<td>{found.count('SUCCESS')} of {len(found)}</td>")
            lines.append(f"<tr><td>{html.escape(scenario)}</td>{''.join(cells)}</tr>")
        return f"<table><tr><th>cases passed</th>{head}</tr>{''.join(lines)}</table>"


def load(folder: str | Path) -> RunResult | list[RunResult] | ScenarioResults:
    """Read the folder of a run, of a series (a list of its runs), or of a matrix of scenarios.

    Raises:
        UserError: it is none of these.
    """
    path = Path(folder)
    if (path / MATRIX_FILE).exists():
        return ScenarioResults(path)
    if (path / SERIES_FILE).exists():
        series = read_json(path / SERIES_FILE, "the series'", "drive the series again")
        assert isinstance(series, dict), "we have written it"
        return [RunResult(path / run["folder"]) for run in series["runs"]]
    return RunResult(path)


def _trace(run: RunResult) -> Trace:
    """A run as it is drawn."""
    return Trace(run.agent, run.history, run.infractions)


def _case(folder: Path, case: dict[str, Any], agent: str, found: dict[str, Any]) -> CaseResult:
    """One cell of a matrix."""
    return CaseResult(
        folder=folder / found["folder"],
        agent=agent,
        id=case["id"],
        scenario=case["scenario"],
        group=case["group"],
        parameters={parameter["name"]: parameter["value"] for parameter in case["parameters"]},
        verdict=found["verdict"],
        status=Status(found["status"]),
        message=found["message"],
        margins=dict(found["margins"]),
        simulated_s=found["simulated_s"],
        wall_s=found["wall_s"],
    )


def _html_table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(text)}</td></tr>" for name, text in rows)
    return f"<table>{cells}</table>"
