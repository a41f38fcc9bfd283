"""One run as a Python object: its outcome, scores and events, its record, and pictures of it."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.outcome import Status
from basu.output.report.documents import RunRecord, read_run
from basu.output.report.runs_picture import Trace, paths_png, speeds_png
from basu.output.report.shuttles import read_shuttles
from basu.results.picture import Picture

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from basu.metrics.infraction import Evidence
    from basu.metrics.result import Result
    from basu.metrics.score import Scores
    from basu.outcome import Outcome
    from basu.records.history import History


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
        return f"<{self.agent} on {self.route}: {self.result.success.word}, {self.outcome.status.value}, {driving}>"

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
    def shuttles(self) -> tuple[RunResult, ...]:
        """The result of each vehicle under test, this one first; this one alone for a run with one vehicle.

        Raises:
            UserError: a folder of one is not what it should be.
        """
        document = read_shuttles(self.folder)
        others = [] if document is None else document["shuttles"][1:]
        return (self, *(RunResult(self.folder / each["folder"]) for each in others))

    @property
    def contacts(self) -> list[dict[str, Any]]:
        """The contacts between the vehicles under test, as ``shuttles.json`` has them; empty with one vehicle.

        Raises:
            UserError: the document cannot be read.
        """
        document = read_shuttles(self.folder)
        return [] if document is None else list(document["contacts"])

    @property
    def outcome(self) -> Outcome:
        """The status with a sentence about it; ``outcome.status.fault`` is the party at fault."""
        return self.result.outcome

    @property
    def completed(self) -> bool:
        """Whether the vehicle arrived."""
        return self.outcome.status is Status.COMPLETED

    @property
    def passed(self) -> bool | None:
        """Whether the drive passed by the one rule of success; None where it says nothing of the agent."""
        return self.result.success.passed

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why it did not pass, in sentences; empty where it did."""
        return self.result.success.reasons

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
        return Picture(paths_png([_trace(each) for each in (self, *others)], self._record.streets.lines))

    def plot_speed(self, *others: RunResult, by: str = "time") -> Picture:
        """The speeds of this run and others with the posted limit, ``by`` "time" in s or by "route" in m."""
        if by not in {"time", "route"}:
            raise UserError(f"plot_speed() has no axis '{by}'; it may be 'time' or 'route'")
        return Picture(speeds_png([_trace(each) for each in (self, *others)], along_route=by == "route"))

    def _repr_html_(self) -> str:
        """A card for notebooks: status, scores, events, picture."""
        scores = {} if self.scores is None else self.scores._asdict()
        rows = [("result", self.result.success.sentence)]
        rows += [(name.replace("_", " "), f"{value:.3f}") for name, value in scores.items()]
        rows += [(f"{found.t_s:.1f} s", f"{found.kind.value}: {found.detail}") for found in self.infractions]
        title = html.escape(f"{self.agent} on {self.route}: {self.outcome.status.value}")
        meta = self.result.meta
        sentence = f"{self.outcome.message}; seed {meta['seed']}, {meta['simulated_s']:.1f} s simulated"
        parts = [f"<h4>{title}</h4>", f"<p>{html.escape(sentence)}</p>", _html_table(rows)]
        if self._record.history is not None:
            picture = base64.b64encode(self.plot_path().data).decode()
            parts.append(f'<img alt="the driven path" width="560" src="data:image/png;base64,{picture}">')
        return "\n".join(parts)


def _trace(run: RunResult) -> Trace:
    """A run as it is drawn."""
    return Trace(run.agent, run.history, run.infractions)


def _html_table(rows: list[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(text)}</td></tr>" for name, text in rows)
    return f"<table>{cells}</table>"
