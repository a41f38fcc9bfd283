"""`AgentDrive`: one drive of an agent, on a route or in a case, with its recording and the managers that show it."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

from basu.episode import Episode
from basu.managers.recording_manager import RecordingManager
from basu.managers.sensors_manager import SensorsManager
from basu.output.progress import ProgressBar
from basu.records.recording_files import LOG_FILE
from basu.running.drive import drive
from basu.running.outputs import ShownDrive, output_managers

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.episode import EpisodeSpec, Towns
    from basu.managers import Live
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.drive import Driven
    from basu.running.preparation import SensorSet
    from basu.simulator import Simulator


class AgentDrive:
    """A drive that is played once: ``episode`` may be laid on its town before; ``play`` drives it to its end."""

    def __init__(
        self,
        simulator: Simulator,
        towns: Towns,
        spec: EpisodeSpec,
        agents: AgentsManager,
        sensors: SensorSet,
        options: DriveOptions,
        *,
        agent: str,
        name: str,
        by_agent: bool,
        quiet: bool,
    ) -> None:
        """Describe the drive; the simulator gets no call yet.

        Args:
            simulator: the simulator to drive in; it stays open after the drive.
            towns: the towns that the simulator has loaded.
            spec: world, task and vehicle of the drive.
            agents: a manager with a newly created agent.
            sensors: the sensors that the agent declares.
            options: what is recorded and shown.
            agent: the agent's name.
            name: file name of the recorder log on a simulator at ``--host``.
            by_agent: True if a sensor that cannot be served is the agent's failure.
            quiet: True to print no progress and no messages.
        """
        self._simulator, self._agents, self._options, self._quiet = simulator, agents, options, quiet
        self._agent, self._log_name = agent, name
        self._recording: RecordingManager | None = None
        is_watched = options.shows_sensors or agents.person is not None
        self.episode = Episode(
            simulator,
            spec,
            towns=towns,
            sensors=lambda: SensorsManager(
                *sensors, late=agents.late_sensors, listener=agents, is_watched=is_watched, by_agent=by_agent
            ),
            participants=[agents],
            observers=self._observers,
        )

    @property
    def log(self) -> str | None:
        """The path of CARLA's log as the simulator gave it; None where none was begun."""
        return None if self._recording is None else self._recording.path

    def play(self, seed: int, folder: Path) -> Driven:
        """Drive to the end, whatever that is, and close the episode; files of the drive go into ``folder``.

        Raises:
            UserError, AgentError: it cannot begin like this.
            SimulatorError: the simulator failed before the drive began.
        """
        try:
            self.episode.prepare(seed, folder)
            driven = drive(self.episode, self._agents)
        finally:
            self.episode.close()
        if self._options.debug and driven.agent_error is not None:
            traceback.print_exception(driven.agent_error)
        return driven

    def _observers(self, live: Live) -> Sequence[BaseManager]:
        """The progress bar, the recording, and all that shows the drive."""
        live = live._replace(agents=self._agents)
        found: list[BaseManager] = [] if self._quiet else [ProgressBar(live)]
        if self._options.record:
            here = str((self.episode.run.folder / LOG_FILE).resolve())
            name = here if self._simulator.own else f"{self._log_name}.log"
            self._recording = RecordingManager(name, lambda: live.sensors.specs)
            found.append(self._recording)
        say = (lambda _: None) if self._quiet else print
        return [*found, *output_managers(self._options, ShownDrive(live, self._agent, say))]
