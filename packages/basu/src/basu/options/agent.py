"""Options of the agent: which one, in what process, within what limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from basu.conditions import Track
from basu.errors import UserError
from basu.options.groups import AGENT
from basu.settings.option import Option, Settings


@dataclass(frozen=True, kw_only=True)
class AgentOptions(Settings):
    """The setup of an agent, what it may know, and the limits of its process."""

    agent_config: Annotated[
        str | None,
        Option(
            help="text for the setup of an agent of the leaderboard or ScenarioRunner, mostly a file's name",
            group=AGENT,
            metavar="FILE",
            is_file=True,
        ),
    ] = None
    step_limit_s: Annotated[
        float,
        Option(
            help="wall time for one step of the agent",
            group=AGENT,
            flag="--step-limit",
            metavar="S",
            unit="s",
            above=0.0,
        ),
    ] = 10.0
    in_process: Annotated[
        bool,
        Option(
            help="drive the agent in BASU's own process, for debuggers; an agent that dies there ends everything",
            group=AGENT,
            repeats=False,
        ),
    ] = False
    agent_memory_gb: Annotated[
        float | None,
        Option(
            help="memory that the agent's process may use; more is the agent's failure",
            group=AGENT,
            flag="--agent-memory",
            metavar="GB",
            unit="GB",
            above=0.0,
            default_text="no limit",
        ),
    ] = None
    agent_writes: Annotated[
        tuple[str, ...],
        Option(
            help="let the agent's process write in this folder too, beside its own; may be given several times",
            group=AGENT,
            flag="--agent-writes",
            metavar="DIR",
        ),
    ] = ()
    track: Annotated[
        Track | None,
        Option(
            help="what the agent learns of others: all (world), those in line of sight (objects), nothing but its "
            "sensors",
            group=AGENT,
            metavar="TRACK",
            default_text="as config() asks, else world",
        ),
    ] = None
    open: Annotated[
        bool,
        Option(
            help="connect the agent to the simulator itself, without the gate, for development; the score is marked as "
            "not comparable",
            group=AGENT,
        ),
    ] = False
    debug: Annotated[bool, Option(help="show the traceback of an agent that fails", group=AGENT, repeats=False)] = False

    def check(self) -> None:
        """Check the options of the agent's process.

        Raises:
            UserError: there is to be none, and its memory is to be limited, or its writing widened.
        """
        if self.in_process and self.agent_writes:
            raise UserError(
                "--agent-writes widens what the agent's own process may do, and --in-process gives it none; choose one"
            )
        if self.in_process and self.agent_memory_gb is not None:
            raise UserError("--agent-memory limits the agent's own process, and --in-process gives it none; choose one")
        super().check()
