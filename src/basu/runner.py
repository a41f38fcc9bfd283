"""``basu run``: an agent, a simulator, one or more routes; each run driven, scored and left in a folder."""

from __future__ import annotations

from datetime import datetime, timezone
from typing import TYPE_CHECKING

from basu.one_run import Session, run_one
from basu.outcome import Status
from basu.preparation import new_agents, prepare
from basu.report.folder import point_latest, publish, run_name
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.score import Scoring
    from basu.options import RunOptions


def run(options: RunOptions, scoring: Scoring) -> int:
    """Run everything that was asked for; the exit code is that of the worst outcome.

    Raises:
        UserError, AgentError: nothing can be started like this.
        SimulatorError: there is no simulator to run in.
    """
    prepared = prepare(options)
    worst = 0
    agents: AgentsManager | None = prepared.agents
    with simulator_for(options) as simulator:
        session = Session(options, scoring, prepared, simulator)
        for job in prepared.jobs:
            agents = agents or new_agents(prepared.loaded, options, job.seed)
            name = run_name(datetime.now(timezone.utc).astimezone(), prepared.loaded.name, job.label)
            done = run_one(session, agents, job, output=options.output, name=name, fresh=job.number > 0)
            agents = None
            folder = publish(done.draft, name)
            point_latest(folder)
            print(f"result folder     {folder}")
            if done.bug is not None:
                raise done.bug
            worst = max(worst, done.outcome.status.fault.value)
            if done.outcome.status in {Status.INTERRUPTED, Status.SIMULATOR_FAILED}:
                return worst
    return worst
