"""What ``basu scenario run`` was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from basu.options import RunOptions
from basu.scenarios.cases import files_among

if TYPE_CHECKING:
    from basu.scenarios.sampling import Design


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioOptions:
    """The options of one ``basu scenario run``, parsed."""

    what: tuple[str, ...] = ("all",)  # groups, types, cases, files
    files: tuple[Path, ...] = ()  # Python or XML files with scenarios of one's own
    agents: tuple[str, ...] = ("basic",)
    design: Design | None = None  # how parameters are sampled; None: each case as it is given
    vary: tuple[str, ...] = ()  # the parameters that a design changes; none: all
    fixed: tuple[tuple[str, str], ...] = ()  # parameters that are set, by name
    host: str | None = None
    port: int = 2000
    timeout_s: float = 20.0
    vehicle: str | None = None  # None: as the case says
    seed: int = 0
    workers: int = 2
    step_limit_s: float = 10.0
    in_process: bool = False
    agent_memory_gb: float | None = None
    output: Path = Path("scenario-runs")
    junit: Path | None = None
    debug: bool = False

    @property
    def all_files(self) -> tuple[Path, ...]:
        """The user's files: those named with --scenarios and those among what is to be played."""
        return (*self.files, *(Path(word) for word in files_among(self.what)))

    def run_options(self, agent: str) -> RunOptions:
        """What a run with one of the agents needs of it."""
        return RunOptions(
            agent=agent,
            host=self.host,
            port=self.port,
            timeout_s=self.timeout_s,
            seed=self.seed,
            vehicle=self.vehicle,
            output=self.output,
            step_limit_s=self.step_limit_s,
            in_process=self.in_process,
            agent_memory_gb=self.agent_memory_gb,
            debug=self.debug,
        )
