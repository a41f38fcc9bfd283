"""Options of the agent: which one, in what process, within what limits."""

from __future__ import annotations

from dataclasses import dataclass

from basu.conditions import SENSORS, LeaderboardTrack, Track
from basu.errors import UserError
from basu.settings.option import Settings, option


@dataclass(frozen=True, kw_only=True)
class AgentOptions(Settings):
    """The setup of an agent, what it may know, and the limits of its process."""

    GROUP = "agent"

    agent_config: str | None = option(
        None,
        "text for the setup of an agent of the leaderboard or ScenarioRunner, mostly a file's name",
        metavar="FILE",
        is_file=True,
    )
    step_limit_s: float = option(10.0, "wall time for one step of the agent", above=0.0)
    in_process: bool = option(
        False,
        "drive the agent in BASU's own process, for debuggers; an agent that dies there ends everything",
        repeats=False,
    )
    agent_memory_gb: float | None = option(
        None, "memory that the agent's process may use; more is the agent's failure", above=0.0, default_text="no limit"
    )
    agent_writes: tuple[str, ...] = option(
        (),
        "let the agent's process write in this folder too, beside its own; may be given several times",
        metavar="DIR",
    )
    track: Track | None = option(
        None,
        "what the agent learns of others: all (world), those in line of sight (objects), nothing but its sensors",
        metavar="TRACK",
        default_text="as config() asks, else world",
    )
    leaderboard_track: LeaderboardTrack | None = option(
        None,
        "hold the agent's sensors to the rules of a track of the CARLA leaderboard 2.x; implies --track sensors",
        metavar="TRACK",
        is_rare=True,
    )
    open: bool = option(
        False,
        "connect the agent to the simulator itself, without the gate, for development; the score is marked "
        "as not comparable",
    )
    debug: bool = option(False, "show the traceback of an agent that fails", repeats=False)

    def check(self) -> None:
        """Check the options of the agent's process.

        Raises:
            UserError: there is to be none, and its memory is to be limited, or its writing widened; or the agent is to
                know more than a track of the leaderboard allows.
        """
        if self.leaderboard_track is not None and (self.open or self.track not in (None, SENSORS)):
            given = "--open" if self.open else f"--track {self.track}"
            raise UserError(
                f"--leaderboard-track {self.leaderboard_track} gives the agent its sensors alone, and {given} gives it "
                "more; leave one of them out"
            )
        if self.in_process and self.agent_writes:
            raise UserError(
                "--agent-writes widens what the agent's own process may do, and --in-process gives it none; choose one"
            )
        if self.in_process and self.agent_memory_gb is not None:
            raise UserError("--agent-memory limits the agent's own process, and --in-process gives it none; choose one")
        super().check()
