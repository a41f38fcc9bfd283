"""``basu scenario run``: cases with agents, a folder each, and the matrix of all."""

from __future__ import annotations

import shlex
import shutil
import sys
import time
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from basu.agents.process.remote_agent import find_agent
from basu.errors import UserError
from basu.outcome import Fault
from basu.output.report.folder import CONFIG_FILE, DRAFTS, make_draft, plain, point_latest, publish, write_json
from basu.output.report.scenarios.page.records import MATRIX_FILE
from basu.running.scenario_runs.crew import Crew, Lost
from basu.running.scenario_runs.document import lost, run_config
from basu.running.scenario_runs.leave import leave
from basu.running.scenario_runs.matrix import matrix_of
from basu.running.scenario_runs.worker import Job, play
from basu.scenarios.cases import cases_of, varied
from basu.scenarios.characteristics import having
from basu.scenarios.nhtsa import Group
from basu.scenarios.variation import Variation

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from basu.agents.process.remote_agent import FoundAgent
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.running.scenario_runs.worker import Done
    from basu.scenarios.cases import Playable

TIMES = "%Y-%m-%dT%H-%M-%S"


def run_scenarios(options: ScenarioOptions) -> int:
    """Play everything that was asked for; the exit code is that of the worst verdict.

    Raises:
        UserError: nothing can be played like this.
        SimulatorError: there is no simulator to play in.
    """
    began, began_s = datetime.now(timezone.utc), time.perf_counter()
    playables = chosen(options)
    agents = _loaded(options)
    names = [agent.name for agent in agents]
    folder = _folder(options, began)
    write_json(folder / CONFIG_FILE, run_config(options, agents))
    jobs = [
        Job(number, agent, playable.case.name)
        for number, (playable, agent) in enumerate((each, agent) for each in playables for agent in options.agents)
    ]
    documents: dict[int, tuple[dict[str, Any], str]] = {}
    interrupted = False
    try:
        for answer in _played(options, folder, jobs):
            if isinstance(answer, Lost):
                playable, agent = playables[answer.number // len(agents)], agents[answer.number % len(agents)]
                documents[answer.number] = (lost(playable, agent, answer.sentence, options), "")
            else:
                documents[answer.number] = (answer.document, answer.folder)
    except KeyboardInterrupt:
        interrupted = True
    finally:
        for draft in folder.glob(f"*/{DRAFTS}"):
            shutil.rmtree(draft, ignore_errors=True)
        if documents:
            wall_s = time.perf_counter() - began_s
            matrix = matrix_of(options, names, playables, documents, began, wall_s)
            write_json(folder / MATRIX_FILE, matrix)
            leave(folder, matrix, options.junit)
            print(f"repeat  basu scenario run --config {shlex.quote(str(folder / CONFIG_FILE))}")
    return Fault.USER.value if interrupted else worst(document for document, _ in documents.values())


def chosen(options: ScenarioOptions) -> tuple[Playable, ...]:
    """The cases that were asked for in the order of the typology, sampled where that was.

    Raises:
        UserError: there is none of that name, or it cannot be sampled like this.
    """
    variation = Variation(fixed=options.fixed, design=options.design, vary=options.vary)
    typology = list(Group)
    cases = having(cases_of(options.what, options.files), options.where)
    by_group = sorted(cases, key=lambda each: typology.index(each.scenario.group))
    return varied(by_group, variation)


def worst(documents: Iterator[dict[str, Any]]) -> int:
    """The exit code of what went worst: a simulator that failed before a set-up, before an agent."""
    return max({_exit_code(document) for document in documents}, default=Fault.SETUP.value)


def _exit_code(document: dict[str, Any]) -> int:
    """The agent's for a failure, and where nothing was exercised and the drive was not completed either."""
    absent = document["verdict"] == "NOT_EXERCISED" and document["assessment"]["completed"]["holds"] is False
    if document["verdict"] == "FAILURE" or absent:
        return Fault.AGENT.value
    return int(Fault[document["fault"].upper()].value)


def _loaded(options: ScenarioOptions) -> list[FoundAgent]:
    """The agents, loaded before anything begins, so that a wrong one is told at once.

    Raises:
        UserError: one cannot be had, or two have one name.
    """
    agents = [
        find_agent(agent, in_process=options.in_process, memory_gb=options.agent_memory_gb) for agent in options.agents
    ]
    names = [agent.name for agent in agents]
    for name in names:
        if names.count(name) > 1:
            raise UserError(f"two agents are called '{name}'; name each once, or rename a file")
    return agents


def _folder(options: ScenarioOptions, began: datetime) -> Path:
    """A new folder for all of it."""
    what = plain("-".join(options.what))[:40]
    name = f"{began.astimezone():{TIMES}}-{what}"
    folder = publish(make_draft(options.output, name), name)
    point_latest(folder, options.output)
    return folder


def _played(options: ScenarioOptions, folder: Path, jobs: Sequence[Job]) -> Iterator[Done | Lost]:
    """What came of each job, as they end."""
    with tqdm(total=len(jobs), unit="case", disable=None, file=sys.stderr) as bar:
        if options.workers > 1 and options.host is None and len(jobs) > 1:
            crew = Crew(options, folder, jobs)
            try:
                for answer in crew.play():
                    bar.update()
                    yield answer
            finally:
                crew.end()
            return
        done = 0
        while done < len(jobs):
            for answer in play(options, folder, jobs[done:]):
                done += 1
                bar.update()
                yield answer
