"""A series of runs in one folder that can be broken off anywhere and continued: nothing lost, nothing counted twice.

``<output>/<name>/`` holds ``series.json`` and a folder for each run, called by the number of the run. A run's folder
gets its name in one step when all is in it, then ``series.json`` is written anew. A command killed in between leaves a
folder that is not in the list: it is taken in when the series goes on. Drafts are thrown away. A run that
was interrupted, or failed for no fault of the agent's, is set aside and driven again, unless its record was unsafe.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basu
from basu.errors import UserError
from basu.files import write_bytes
from basu.metrics.scoring import scoring_to_json
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.output.report.document_parts import SERIES_SCHEMA_VERSION
from basu.output.report.documents import (
    SERIES_SCHEMA,
    plain,
    publish,
    read_document,
    write_json,
)
from basu.output.report.series_document import row, series_table, totals
from basu.settings.option import fields_of, gone_from, is_told, to_json

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.metrics.result import Result
    from basu.metrics.scoring import Scoring
    from basu.running.drive import DriveDone
from basu.running.batch import Batch, changes, counts
from basu.running.exit_code import exit_code
from basu.running.preparation import Plan, RequestedRun

SERIES_FILE, SERIES_TEXT = "series.json", "series.txt"


class Series(Batch):
    """The series in a folder, with its list and totals. ``open_series`` makes one."""

    def __init__(self, folder: Path, document: dict[str, Any], jobs: Mapping[int, RequestedRun], agent: str) -> None:
        """Take up a series of ``jobs``, by number."""
        super().__init__(folder, {number: _name(job, agent) for number, job in jobs.items()})
        self._document, self._jobs = document, jobs

    @property
    def done(self) -> frozenset[int]:
        """The numbers of the runs that count."""
        return frozenset(each["number"] for each in self._document["runs"])

    def publish(self, done: DriveDone) -> DriveDone:
        """Put a finished run in its place and count it, or set it aside; return it with its folder.

        Raises:
            UserError: the disk does not let us.
        """
        if done.folder is None:
            return done
        draft, result, name = done.folder, done.result, self.name(done.number)
        if not counts(result):
            status = result.outcome.status.value
            folder = publish(draft, f"{name}-{status}")
            self._document["set_aside"].append({"folder": folder.name, "status": status})
        else:
            folder = publish(draft, name)
            if folder.name != name:
                raise UserError(
                    f"{folder.with_name(name)} is there already: another command drives the series "
                    f"{self.folder.name} at the same time; this run is left in {folder.name} and not counted"
                )
            self._count(result, done.number)
        self.write()
        return done._replace(folder=folder)

    def take_in(self) -> None:
        """Count the runs that were finished and not yet listed, and throw drafts away."""
        self.clear()
        for number, result in self.finished(but=self.done):
            self._count(result, number)

    def write(self) -> None:
        """Write the list and the totals, at once or not at all.

        Raises:
            UserError: the disk does not let us.
        """
        self._document["totals"] = totals(self._document["runs"], self._document["planned"])
        write_json(self.folder / SERIES_FILE, self._document)
        write_bytes(self.folder / SERIES_TEXT, f"{self.table()}\n".encode())

    def table(self) -> str:
        """Return the totals as text."""
        return series_table(self.folder.name, self._document)

    def worst(self, required: Mapping[str, float]) -> int:
        """Return the exit code of the worst run that counts; ``required`` are the least scores by name."""
        rows = self._document["runs"]
        return max((exit_code(Status(each["status"]), each["scores"], required) for each in rows), default=0)

    def _count(self, result: Result, number: int) -> None:
        rows, repetition = self._document["runs"], self._jobs[number].repetition
        rows.append(row(result, number=number, repetition=repetition, folder=self.name(number)))
        rows.sort(key=lambda each: each["number"])


RESOLVED = frozenset({"agent", "routes", "route_id", "routes_subset", "with_scenarios", "weather", "vehicle"})
"""Options that the plan of a run resolves: the resolved values are conditions, and not what was typed."""


def conditions(options: RunOptions, scoring: Scoring, prepared: Plan) -> dict[str, Any]:
    """All that the results of a series depend on: declared options that repeat a run, and what the plan resolves."""
    config, agent_file = prepared.agents.config, prepared.loaded.file
    routes = [replace(job.description, source="") for job in prepared.jobs if job.repetition == 0]
    return {
        **{
            field.flag: _condition(getattr(options, field.name))
            for field in fields_of(type(options))
            if field.option.repeats and field.name not in RESOLVED and is_told(field, options)
        },
        "the agent": options.agent,
        "the agent's file": None if agent_file is None else _digest(agent_file.read_bytes()),
        "the routes": [route.id for route in routes],
        "the contents of the routes": _digest(repr(routes).encode()),
        "the scenarios of the routes": [
            f"{waiting.case.name}: {waiting.scenario.__name__} {dict(waiting.values)} at {waiting.case.trigger}"
            for job in prepared.jobs
            if job.repetition == 0
            for waiting in job.scenarios
        ],
        "the vehicle": config.vehicle,
        "the weather": options.weather or f"{config.weather}, where the route gives none",
        "the sensors": _digest(repr(prepared.sensors.specs).encode()),
        "the simulator": "our own" if options.host is None else "at --host",
        "the scoring": scoring_to_json(scoring),
        "the version of basu": basu.__version__,
        "the version of carla": version("carla"),
    }


def _condition(value: Any) -> Any:  # noqa: ANN401 - values of any option
    """An option's value as JSON has it; a file by its contents, a folder by the contents of its files."""
    if isinstance(value, Path):
        if value.is_file():
            return _digest(value.read_bytes())
        return {file.name: _condition(file) for file in sorted(value.iterdir()) if file.is_file()}
    return [_condition(each) for each in value] if isinstance(value, list | tuple) else to_json(value)


def open_series(
    folder: Path, given: Mapping[str, Any], jobs: tuple[RequestedRun, ...], agent: str, *, resume: bool
) -> Series:
    """Begin the series in ``folder``, or go on with it; ``given`` is all that its results depend on, by name.

    Raises:
        UserError: there is a series already, or none to go on with, or one that was begun differently.
    """
    path = folder / SERIES_FILE
    by_number = {job.number: job for job in jobs}
    if not resume:
        if path.exists():
            done = _read(path)["totals"]
            raise UserError(
                f"{folder} holds a series already, {done['done']} of {done['planned']} runs done; add --resume to go "
                "on with it, or choose another --series"
            )
        document: dict[str, Any] = {
            "schema_version": SERIES_SCHEMA_VERSION,
            "options": dict(given),
            "planned": len(jobs),
            "runs": [],
            "set_aside": [],
        }
        series = Series(folder, document, by_number, agent)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UserError(f"{folder} could not be made: {error.strerror}; name another --series") from error
        series.write()
        return series
    if not path.exists():
        raise UserError(f"there is no series in {folder} to go on with; run without --resume to begin it")
    document = _read(path)
    _compare(document["options"], given, folder)
    series = Series(folder, document, by_number, agent)
    series.take_in()
    series.write()
    return series


def _name(job: RequestedRun, agent: str) -> str:
    """What the folder of a run is called: in the order of the runs, as long as there are less than ten thousand."""
    return f"{job.number:04d}-{plain(agent)}-{plain(job.label)}-{job.repetition}"


def _digest(data: bytes) -> str:
    """Short for what is too long to be stored."""
    return f"sha256 {hashlib.sha256(data).hexdigest()[:16]}"


def _compare(before: Mapping[str, Any], now: Mapping[str, Any], folder: Path) -> None:
    """Refuse to go on with a series under other conditions.

    Raises:
        UserError: names what is different.
    """
    gone = {f"--{name.replace('_', '-')}" for name in gone_from(RunOptions)}
    before = {name: value for name, value in before.items() if value or name not in gone}
    changed = changes(before, json.loads(json.dumps(now)))  # as the file has it
    if changed:
        raise UserError(
            f"the series in {folder} was begun differently: {changed}; give what it was begun with, or "
            "begin another with --series"
        )


def _read(path: Path) -> dict[str, Any]:
    """The document of a series.

    Raises:
        UserError: it is none.
    """
    return read_document(path, SERIES_SCHEMA)
