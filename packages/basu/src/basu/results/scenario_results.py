"""A matrix of cases and agents as a Python object, with each case's verdict and record."""

from __future__ import annotations

import html
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.outcome import Status
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE, read_case
from basu.output.report.scenarios.matrix_text import matrix_text
from basu.output.report.scenarios.sweep.success_map import sweep_map
from basu.records.history.files import HISTORY_FILE, read_history
from basu.results.picture import Picture
from basu.results.run_result import RunResult

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd

    from basu.records.history import History


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
        """The case in ``result.json``: its criteria, phases and actors."""
        return dict(read_case(self.folder).case)

    @cached_property
    def run(self) -> RunResult:
        """The drive as a run: its scores, infractions and metrics, users' metrics among them, and its pictures.

        Raises:
            UserError: an earlier version played the case, or it left no folder.
        """
        return RunResult(self.folder)

    @cached_property
    def history(self) -> History:
        """Read the record of the case's drive, frame by frame.

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
        """The crash-cost share of each agent's passed cases, as docs/reference/scenarios.md describes it."""
        return dict(self.document["shares"])

    def to_pandas(self) -> pd.DataFrame:
        """A row for each case and agent, with a column for each parameter and margin.

        Raises:
            UserError: pandas is not installed.
        """
        try:
            import pandas as pd  # noqa: PLC0415 - an extra
        except ImportError:
            raise UserError("to_pandas() needs pandas; install it with `pip install basu[tables]`") from None
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
