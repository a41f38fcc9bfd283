"""The options of ``basu run``: all groups in one model."""

from __future__ import annotations

from dataclasses import dataclass

from basu.errors import UserError
from basu.options.agent import AgentOptions
from basu.options.drive import DriveOptions
from basu.options.folders import SeriesOptions
from basu.options.routes import RouteOptions
from basu.options.shuttles import ShuttleOptions
from basu.settings.option import Settings, option


@dataclass(frozen=True, kw_only=True)
class ChosenAgent(Settings):
    """The one agent of ``basu run``."""

    GROUP = "agent"

    agent: str = option(
        "basic",
        "a name (`basu list`), FILE.py, or FILE.py:Class",
        positional=True,
        flag="--agent",
        metavar="AGENT",
        is_file=True,
    )


@dataclass(frozen=True, kw_only=True)
class RunOptions(SeriesOptions, DriveOptions, RouteOptions, AgentOptions, ShuttleOptions, ChosenAgent):
    """The options of ``basu run`` without the scoring, which is a model of its own.

    Python collects the fields of a dataclass from the last base to the first: the help page begins with the agent.
    """

    def check(self) -> None:
        """Check that what belongs to one vehicle is not asked for several.

        Raises:
            UserError: a series counts one vehicle a run.
        """
        if self.series is not None and self.besides:
            raise UserError(
                "--series counts the result of one vehicle a run; leave out --series, or test one shuttle at a time"
            )
        super().check()
