"""`MatrixDrives`: the drives of a run of scenarios, each a case, a repetition and an agent, with job and folder."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from basu.output.report.documents import plain
from basu.running.scenario_runs.case_documents import lost
from basu.running.scenario_runs.chosen_cases import chosen
from basu.running.scenario_runs.player import CaseJob

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.process.remote_agent import FoundAgent
    from basu.running.drive import DriveDone
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.playable import Playable


class SuiteDrive(NamedTuple):
    """One drive of a suite."""

    playable: Playable
    repetition: int
    column: int  # of the agent


class MatrixDrives:
    """All drives of a command: cases before repetitions before agents."""

    def __init__(self, options: ScenarioOptions, agents: Sequence[FoundAgent]) -> None:
        """Choose the cases; the number of a drive is its place in ``drives``.

        Raises:
            UserError: there is no such case, or it cannot be sampled like this.
        """
        self.options, self.agents = options, agents
        self.rows = [(case, repetition) for case in chosen(options) for repetition in range(options.repetitions)]
        self.drives = [SuiteDrive(*row, column) for row in self.rows for column in range(len(agents))]
        self.names = self._names()

    @property
    def agent_names(self) -> list[str]:
        """The names of the agents, in their order."""
        return [agent.name for agent in self.agents]

    def job(self, number: int) -> CaseJob:
        """Return the job of a drive, for a worker."""
        playable, repetition, column = self.drives[number]
        name = self.names[number].rpartition("/")[2]
        return CaseJob(self.options.agents[column], playable.case.name, name, repetition)

    def lost(self, done: DriveDone) -> DriveDone:
        """Return a drive over which every worker died, with its case."""
        playable, repetition, column = self.drives[done.number]
        again = replace(self.options, seed=self.options.drive_seed + repetition)
        case = lost(playable, self.agents[column], done.result.outcome.message, again)
        return done._replace(result=replace(done.result, case=case))

    def _names(self) -> dict[int, str]:
        """Return the folder of each drive, AGENT/CASE; ids that differ in odd characters alone are numbered."""
        names: dict[int, str] = {}
        taken: set[str] = set()
        for number, (playable, repetition, column) in enumerate(self.drives):
            case = plain(playable.case.name) + (f"-{repetition}" if self.options.repetitions > 1 else "")
            name, again = f"{plain(self.agents[column].name)}/{case}", 1
            while name in taken:
                again += 1
                name = f"{plain(self.agents[column].name)}/{case}-{again}"
            taken.add(name)
            names[number] = name
        return names
