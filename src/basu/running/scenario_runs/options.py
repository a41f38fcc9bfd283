"""The options of ``basu scenario run``, each declared once."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from basu.errors import UserError
from basu.options.agent import (
    AgentMemory,
    AgentWrites,
    Debug,
    InProcess,
    Open,
    StepLimit,
    TrackWish,
    check_agent_process,
)
from basu.options.folders import Output
from basu.options.groups import AGENT, CONDITIONS, FOLDERS, SIMULATOR
from basu.options.run import RunOptions
from basu.options.simulator import Host, Port, Timeout
from basu.settings.option import Option, Settings, fields_of

CASES = "cases"


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioOptions(Settings):
    """The options of one ``basu scenario run``."""

    what: Annotated[
        tuple[str, ...],
        Option(
            help="all, a group, a scenario, a case's id, or a FILE.xml with cases",
            group=CASES,
            positional=True,
            metavar="WHAT",
            is_file=True,
        ),
    ] = ("all",)
    files: Annotated[
        tuple[Path, ...],
        Option(
            help="classes (FILE.py) or cases (FILE.xml) of your own; each brings the other of its name",
            group=CASES,
            flag="--scenarios",
            metavar="FILE",
            is_file=True,
        ),
    ] = ()
    where: Annotated[
        tuple[tuple[str, str], ...],
        Option(
            help="only cases with this characteristic, such as lighting=dark; may be given several times",
            group=CASES,
            metavar="FIELD=VALUE",
            style="pairs",
        ),
    ] = ()
    sweep: Annotated[
        int | None,
        Option(help="play N samples of each case (Latin hypercube)", group=CASES, metavar="N", rival="design"),
    ] = None
    grid: Annotated[
        int | None,
        Option(help="play each case with K values of every number", group=CASES, metavar="K", rival="design"),
    ] = None
    vary: Annotated[
        tuple[str, ...],
        Option(help="the parameters to sample", group=CASES, metavar="NAME[,NAME]", style="commas", default_text="all"),
    ] = ()
    fixed: Annotated[
        tuple[tuple[str, str], ...],
        Option(
            help="set a parameter; may be given several times",
            group=CASES,
            flag="--set",
            metavar="NAME=VALUE",
            style="pairs",
        ),
    ] = ()
    agents: Annotated[
        tuple[str, ...],
        Option(
            help="a name (`basu list`), FILE.py, or FILE.py:Class; may be given several times",
            group=AGENT,
            flag="--agent",
            metavar="AGENT",
            default_text="basic",
            is_file=True,
        ),
    ] = ("basic",)
    step_limit_s: StepLimit = 10.0
    in_process: InProcess = False
    agent_memory_gb: AgentMemory = None
    agent_writes: AgentWrites = ()
    track: TrackWish = None
    open: Open = False
    debug: Debug = False
    seed: Annotated[
        int,
        Option(
            help="seed of the samples; without --sweep, of everything random in the drives",
            group=CONDITIONS,
            metavar="N",
        ),
    ] = 0
    vehicle: Annotated[
        str | None,
        Option(help="blueprint to drive", group=CONDITIONS, metavar="BLUEPRINT", default_text="as the case says"),
    ] = None
    host: Host = None
    port: Port = 2000
    timeout_s: Timeout = 20.0
    workers: Annotated[
        int,
        Option(
            help="simulators that run at the same time",
            group=SIMULATOR,
            metavar="N",
            least=1,
            default_text="one a processor",
            repeats=False,
        ),
    ] = field(default_factory=processors)
    output: Output = Path("scenario-runs")
    junit: Annotated[
        Path | None, Option(help="write the JUnit XML there as well", group=FOLDERS, metavar="FILE", repeats=False)
    ] = None

    def check(self) -> None:
        """Check what concerns several options.

        Raises:
            UserError: there is nothing to play, or no agent.
        """
        for name in ("what", "agents"):
            if not getattr(self, name):
                raise UserError(f"{name} is empty; it must name at least one")
        check_agent_process(in_process=self.in_process, memory_gb=self.agent_memory_gb, writes=self.agent_writes)

    @property
    def drive_seed(self) -> int:
        """The seed of what is random in the drives: 0 for samples; their ids hold no other."""
        return 0 if self.sweep is not None else self.seed

    def run_options(self, agent: str) -> RunOptions:
        """The options of a run with one of the agents."""
        own = {field.name for field in fields_of(type(self))}
        shared = {field.name: getattr(self, field.name) for field in fields_of(RunOptions) if field.name in own}
        return RunOptions(**{**shared, "agent": agent, "seed": self.drive_seed})
