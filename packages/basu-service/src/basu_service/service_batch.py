"""`ServiceBatch`: the services of one comparison, which go on after the command was killed.

``<output>/compare-A-B/`` holds ``compare.json`` with all that the services depend on, and a folder for each agent. The
folder of a service has its seed as its name. It gets that name in one step when all is in it.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json
from basu.jobs.job import Job
from basu.jobs.playing import play_jobs
from basu.metrics.scoring import Scoring
from basu.output.progress import drives_bar
from basu.output.report.documents import plain, write_json
from basu.running.batch import COUNTED, Batch, changes
from basu.running.folder_lock import locked
from basu.running.series import conditions as run_conditions
from basu_service.running import ServiceJob, service_player

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from basu.options.run import RunOptions
    from basu.outcome import Status
    from basu.running.drive import DriveDone
    from basu_service.running import PlannedService, ServiceConditions

COMPARE_FILE = "compare.json"
HINT = "name another --output, or remove the folder"


class Side:
    """The services of one agent in a comparison."""

    def __init__(self, letter: str, agent: str) -> None:
        """Name the folder by the letter and the agent."""
        self.agent, self.folder = agent, f"{letter}-{plain(agent)}"


class ServiceBatch(Batch):
    """All services of a comparison: each side with each seed, a pair after a pair."""

    def __init__(self, folder: Path, sides: Sequence[Side], seeds: Sequence[int]) -> None:
        """List the services; a pair of equal seeds stands together, so that an interrupted comparison has pairs."""
        self._planned = [(side, seed) for seed in seeds for side in sides]
        super().__init__(
            folder, {number: f"{side.folder}/seed-{seed:04d}" for number, (side, seed) in enumerate(self._planned)}
        )

    def jobs(self, but: frozenset[int]) -> list[Job]:
        """Return a job for each service that is still to be driven."""
        return [
            Job(
                number,
                ServiceJob(side.agent, seed, self.folder / side.folder, self.name(number).rpartition("/")[2]),
            )
            for number, (side, seed) in enumerate(self._planned)
            if number not in but
        ]

    def described(self, number: int) -> str:
        """Return a service in words."""
        side, seed = self._planned[number]
        return f"{side.agent}, seed {seed}"


def given_of(options: RunOptions, agent: str, planned: PlannedService) -> dict[str, Any]:
    """Return all that the services of one agent depend on, by name."""
    conditions, demand = planned.conditions, replace(planned.demand, source="")
    return {
        **run_conditions(replace(options, agent=agent), Scoring(), planned.run),
        "--minutes": conditions.minutes,
        "--apart": conditions.apart_min,
        "--no-holding": not conditions.holds,
        **({"--bodies": True} if conditions.bodies else {}),
        "the demand": f"sha256 {hashlib.sha256(repr(demand).encode()).hexdigest()[:16]}",
    }


def drive_all(
    batch: ServiceBatch,
    options: RunOptions,
    conditions: ServiceConditions,
    scoring: Scoring,
    given: Mapping[str, Any],
    *,
    resume: bool,
    say: Callable[[str], object],
) -> None:
    """Drive the services of a comparison that are not there yet; ``given`` is all that they depend on.

    ``say`` gets a line for each service that is over.

    Raises:
        UserError: the folder holds other services, nothing to go on with, or a service could not be driven.
        SimulatorError: there is no simulator.
        KeyboardInterrupt: the user interrupted it; what was driven is kept.
    """
    with locked(batch.folder):
        _begin(batch.folder, given, resume=resume)
        batch.clear()
        done = set()
        for number, result in list(batch.finished()):
            if is_counted(result.outcome.status):
                done.add(number)
            else:
                batch.set_aside(number, result)
        jobs = batch.jobs(frozenset(done))
        answers = batch.play(play_jobs(service_player(options, conditions, scoring), jobs, options.workers))
        with drives_bar(len(jobs) + len(done), " services", initial=len(done)) as bar, contextlib.closing(answers):
            failed = [
                each
                for each in _noted(batch, answers, bar, say)
                if each.folder is None or not is_counted(each.result.outcome.status)
            ]
    if failed:
        raise UserError(
            f"{len(failed)} services could not be driven, the first ({batch.described(failed[0].number)}): "
            f"{failed[0].result.outcome.message}; with --resume the same command drives them again"
        )


def is_counted(status: Status) -> bool:
    """Return whether a service that ended so says something of its agents: not where another party ended it."""
    return status.fault in COUNTED


def _noted(batch: ServiceBatch, answers: Any, bar: Any, say: Callable[[str], object]) -> list[DriveDone]:  # noqa: ANN401 - a generator, and tqdm's
    """Return all answers; each one is shown when it comes."""
    found = []
    for done in answers:
        bar.update()
        say(f"{batch.described(done.number)}: {done.result.outcome.status.value}")
        found.append(done)
    return found


def _begin(folder: Path, given: Mapping[str, Any], *, resume: bool) -> None:
    """Write the conditions of a comparison, or check that one that goes on has the same.

    Raises:
        UserError: there is a comparison already, none to go on with, or one that was begun differently.
    """
    path = folder / COMPARE_FILE
    if not resume:
        if path.exists():
            raise UserError(f"{folder} holds a comparison already; add --resume to go on with it, or {HINT}")
        write_json(path, dict(given))
        return
    if not path.exists():
        raise UserError(f"there is no comparison in {folder} to go on with; run without --resume to begin it")
    before = read_json(path, "the conditions of a comparison", HINT)
    changed = changes(before, json.loads(json.dumps(given)))
    if changed:
        raise UserError(
            f"the comparison in {folder} was begun differently: {changed}; give what it was begun with, or {HINT}"
        )
