"""What reads an agent's file that was written for another program: the leaderboard or ScenarioRunner, by a plugin."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from basu import plugins

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.agents.autonomous_agent import AutonomousAgent
    from basu.agents.sensor_file import SensorSpec
    from basu.conditions import LeaderboardTrack

FOREIGN_PACKAGES = {"leaderboard": "leaderboard", "srunner": "leaderboard", "agents": "leaderboard"}
"""What agents of other programs import, and the plugin that then reads their files."""


class AgentFile(NamedTuple):
    """An agent's file after its execution."""

    namespace: Mapping[str, object]
    module_name: str
    path: str
    class_name: str | None  # that the user names; None: the only one


class SensorRules(Protocol):
    """Rules on an agent's sensors, of one run."""

    def admit(self, specs: tuple[SensorSpec, ...], source: str) -> tuple[SensorSpec, ...]:
        """Return the sensors that the simulator has; ``source`` is what complaints begin with.

        Raises:
            UserError: the set breaks a rule; the sentence names it.
        """

    def document(self) -> dict[str, object]:
        """Return the track, the types of the admitted sensors, and the sentence of a refusal."""


class AgentFiles(Protocol):
    """A reader of agents' files, the entry point of a plugin in the group "basu.agent_files"."""

    def prepare(self) -> None:
        """Make the file's imports possible, before it is executed."""

    def is_ours(self, file: AgentFile) -> bool:
        """Return whether the file says itself that it is of this kind, even where it has an agent of BASU's too."""

    def agent_in(self, file: AgentFile, agent_config: str | None) -> type[AutonomousAgent] | None:
        """Return the file's agent as one of BASU's; None where it has none of this kind.

        ``agent_config`` is the text of ``--agent-config``.

        Raises:
            UserError: it has one, and that is not as an agent has to be.
        """

    def takes_config(self, agent: type[AutonomousAgent]) -> bool:
        """Return whether an agent is one of this kind, which takes a text for its setup."""

    def sensor_rules(self, track: LeaderboardTrack) -> SensorRules:
        """Return the rules of a track of the program that the files are written for."""


def readers() -> list[AgentFiles]:
    """Return the readers of all installed plugins."""
    return [
        plugins.load(plugins.AGENT_FILES, name, "the agent's file") for name in plugins.offered(plugins.AGENT_FILES)
    ]


def hint_on(error: BaseException) -> str:
    """Return what to install where a file's import failed for want of a plugin, to be put behind a sentence."""
    missing = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    name = FOREIGN_PACKAGES.get(missing)
    if name is None or plugins.is_installed(plugins.AGENT_FILES, name):
        return ""
    return "; " + plugins.missing(plugins.AGENT_FILES, name, "an agent of the leaderboard or of ScenarioRunner")


def prepare() -> None:
    """Make the imports of agents' files of all kinds possible."""
    for reader in readers():
        reader.prepare()


def foreign_agent(file: AgentFile, agent_config: str | None, *, has_own: bool) -> type[AutonomousAgent] | None:
    """Return the agent of another program in a file; None where it has none.

    A file that has an agent of BASU's too (``has_own``) is of another kind only where it says so.
    """
    for reader in readers():
        if (reader.is_ours(file) or not has_own) and (found := reader.agent_in(file, agent_config)) is not None:
            return found
    return None


def takes_config(agent: type[AutonomousAgent]) -> bool:
    """Return whether an agent takes the text of ``--agent-config``."""
    return any(reader.takes_config(agent) for reader in readers())


def sensor_rules(track: LeaderboardTrack) -> SensorRules:
    """Return the rules of a track of the leaderboard.

    Raises:
        UserError: the plugin for the leaderboard is not installed.
    """
    rules: SensorRules = plugins.load(plugins.AGENT_FILES, "leaderboard", f"--leaderboard-track {track}").sensor_rules(
        track
    )
    return rules
