"""The options of ``basu scenario run``, each declared once."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from basu.errors import UserError
from basu.options.drive import DriveOptions
from basu.options.groups import AGENT, CONDITIONS, FOLDERS, SIMULATOR
from basu.settings.option import Option, Settings

CASES = "cases"
PLAYERS = ("esmini", "scenario-runner")
"""The programs for which `basu scenario export` writes a case; the first is the default."""


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True, kw_only=True)
class CaseOptions(Settings):
    """The cases to play, their samples and their agents."""

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
    ego: Annotated[
        str | None,
        Option(
            help="the entity of an OpenSCENARIO file that the agent drives",
            group=CASES,
            metavar="NAME",
            default_text="Ego or hero, else the first vehicle",
        ),
    ] = None
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


@dataclass(frozen=True, kw_only=True)
class ScenarioOptions(DriveOptions, CaseOptions):
    """The options of one ``basu scenario run``: those of every drive, with the defaults of cases."""

    seed: Annotated[
        int,
        Option(
            help="seed of the samples; without --sweep, of everything random in the drives, and each further "
            "repetition has the next",
            group=CONDITIONS,
            metavar="N",
        ),
    ] = 0
    weather: Annotated[
        str | None,
        Option(help="one of CARLA's presets", group=CONDITIONS, metavar="NAME", default_text="as the case says"),
    ] = None
    vehicle: Annotated[
        str | None,
        Option(help="blueprint to drive", group=CONDITIONS, metavar="BLUEPRINT", default_text="as the case says"),
    ] = None
    workers: Annotated[
        int,
        Option(
            help="simulators that run at the same time; a window, keys, ROS topics and --host need one alone",
            group=SIMULATOR,
            metavar="N",
            least=1,
            default_text="one a processor",
            repeats=False,
        ),
    ] = field(default_factory=processors)
    output: Annotated[Path, Option(help="parent of the run folders", group=FOLDERS, metavar="DIR", repeats=False)] = (
        Path("scenario-runs")
    )
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
        super().check()

    @property
    def drive_seed(self) -> int:
        """The seed of what is random in the drives: 0 for samples; their ids hold no other."""
        return 0 if self.sweep is not None else self.seed
