"""Options of the agent: which one, in what process, within what limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from basu.errors import UserError
from basu.options.groups import AGENT
from basu.settings.option import Option, Settings

StepLimit = Annotated[
    float,
    Option(
        help="wall time for one step of the agent", group=AGENT, flag="--step-limit", metavar="S", unit="s", above=0.0
    ),
]
InProcess = Annotated[
    bool,
    Option(
        help="drive the agent in BASU's own process, for debuggers; an agent that dies there ends everything",
        group=AGENT,
        repeats=False,
    ),
]
AgentMemory = Annotated[
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
]
AgentWrites = Annotated[
    tuple[str, ...],
    Option(
        help="let the agent's process write in this folder too, beside its own; may be given several times",
        group=AGENT,
        flag="--agent-writes",
        metavar="DIR",
    ),
]
Track = Literal["world", "objects", "sensors"]
"""What an agent learns of other actors; scores of different tracks are never compared."""
WORLD, OBJECTS, SENSORS = "world", "objects", "sensors"
TRACKS: tuple[str, ...] = get_args(Track)
TrackWish = Annotated[
    Track | None,
    Option(
        help="what the agent learns of others: all (world), those in line of sight (objects), nothing but its sensors",
        group=AGENT,
        metavar="TRACK",
        default_text="as config() asks, else world",
    ),
]
Open = Annotated[
    bool,
    Option(
        help="connect the agent to the simulator itself, without the gate, for development; the score is marked as not "
        "comparable",
        group=AGENT,
    ),
]
Debug = Annotated[bool, Option(help="show the traceback of an agent that fails", group=AGENT, repeats=False)]


@dataclass(frozen=True, kw_only=True)
class AgentOptions(Settings):
    """The agent to drive, and the limits of its process."""

    agent: Annotated[
        str,
        Option(
            help="a name (`basu list`), FILE.py, or FILE.py:Class",
            group=AGENT,
            positional=True,
            flag="--agent",
            metavar="AGENT",
            is_file=True,
        ),
    ] = "basic"
    agent_config: Annotated[
        str | None,
        Option(
            help="text for the setup of an agent of the leaderboard or ScenarioRunner, mostly a file's name",
            group=AGENT,
            metavar="FILE",
            is_file=True,
        ),
    ] = None
    step_limit_s: StepLimit = 10.0
    in_process: InProcess = False
    agent_memory_gb: AgentMemory = None
    agent_writes: AgentWrites = ()
    track: TrackWish = None
    open: Open = False
    debug: Debug = False

    def check(self) -> None:
        """Check the options of the agent's process.

        Raises:
            UserError: as ``check_agent_process``.
        """
        check_agent_process(in_process=self.in_process, memory_gb=self.agent_memory_gb, writes=self.agent_writes)
        super().check()


def check_agent_process(*, in_process: bool, memory_gb: float | None, writes: tuple[str, ...]) -> None:
    """Check the options of the agent's process.

    Raises:
        UserError: there is to be none, and its memory is to be limited, or its writing widened.
    """
    if in_process and writes:
        raise UserError(
            "--agent-writes widens what the agent's own process may do, and --in-process gives it none; choose one"
        )
    if in_process and memory_gb is not None:
        raise UserError("--agent-memory limits the agent's own process, and --in-process gives it none; choose one")
