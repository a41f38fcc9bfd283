"""The options of ``basu scenario run``, each declared once."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from basu.errors import UserError
from basu.options.drive import DriveOptions
from basu.settings.option import Settings, option

PLAYERS = ("esmini", "scenario-runner")
"""The programs for which `basu scenario export` writes a case; the first is the default."""


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True, kw_only=True)
class CaseOptions(Settings):
    """The cases to play, and their samples."""

    GROUP = "cases"

    what: tuple[str, ...] = option(
        ("all",),
        "all, a suite, a group, a scenario, a case's id, or a FILE.xml with cases",
        positional=True,
        metavar="WHAT",
        is_file=True,
    )
    files: tuple[Path, ...] = option(
        (),
        "classes (FILE.py) or cases (FILE.xml) of your own; each brings the other of its name",
        flag="--scenarios",
        metavar="FILE",
    )
    where: tuple[tuple[str, str], ...] = option(
        (),
        "only cases with this characteristic, such as lighting=dark; may be given several times",
        metavar="FIELD=VALUE",
        style="pairs",
    )
    sweep: int | None = option(None, "play N samples of each case (Latin hypercube)", rival="design")
    grid: int | None = option(None, "play each case with K values of every number", metavar="K", rival="design")
    vary: tuple[str, ...] = option(
        (), "the parameters to sample", metavar="NAME[,NAME]", style="commas", default_text="all"
    )
    fixed: tuple[tuple[str, str], ...] = option(
        (), "set a parameter; may be given several times", flag="--set", metavar="NAME=VALUE", style="pairs"
    )
    parameters: Path | None = option(
        None, "a TOML file with your own values of the parameters of a suite", metavar="FILE"
    )
    ego: str | None = option(
        None,
        "the entity of an OpenSCENARIO file that the agent drives",
        metavar="NAME",
        default_text="Ego or hero, else the first vehicle",
    )


@dataclass(frozen=True, kw_only=True)
class ChosenAgents(Settings):
    """The agents of ``basu scenario run``."""

    GROUP = "agent"

    agents: tuple[str, ...] = option(
        ("basic",),
        "a name (`basu list`), FILE.py, or FILE.py:Class; may be given several times",
        flag="--agent",
        metavar="AGENT",
        default_text="basic",
        is_file=True,
    )


@dataclass(frozen=True, kw_only=True)
class ScenarioOptions(DriveOptions, ChosenAgents, CaseOptions):
    """The options of one ``basu scenario run``: those of every drive, with the defaults of cases."""

    GROUP = "run folders"

    seed: int = option(
        0,
        "seed of the samples; without --sweep, of everything random in the drives, and each further "
        "repetition has the next",
    )
    weather: str | None = option(None, "one of CARLA's presets", metavar="NAME", default_text="as the case says")
    vehicle: str | None = option(None, "blueprint to drive", metavar="BLUEPRINT", default_text="as the case says")
    workers: int = option(
        processors(),
        "simulators that run at the same time; a window, keys, ROS topics and --host need one alone",
        least=1,
        default_text="one a processor",
        repeats=False,
    )
    output: Path = option(Path("scenario-runs"), "parent of the run folders", metavar="DIR", repeats=False)
    junit: Path | None = option(None, "write the JUnit XML there as well", metavar="FILE", repeats=False)

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
