"""`AgentDrive`: one drive of agents, on a route or in a case, with its recording and the managers that show it."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

from basu.episode import DriverSetup, Episode
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
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.drive import Driven
    from basu.running.shuttles import Shuttle
    from basu.simulator import Simulator


class AgentDrive:
    """A drive that is played once: ``episode`` may be laid on its town before; ``play`` drives it to its end."""

    def __init__(
        self,
        simulator: Simulator,
        towns: Towns,
        spec: EpisodeSpec,
        shuttles: Sequence[Shuttle],
        options: DriveOptions,
        *,
        name: str,
        quiet: bool,
        watched: int = 1,
    ) -> None:
        """Describe the drive; the simulator gets no call yet.

        Args:
            simulator: the simulator to drive in; it stays open after the drive.
            towns: the towns that the simulator has loaded.
            spec: world and task of the drive, and the vehicle of the first shuttle.
            shuttles: the vehicles under test, each with a newly created agent.
            options: what is recorded, of the first shuttle, and what is shown, of the one that is ``watched``.
            name: file name of the recorder log on a simulator at ``--host``.
            quiet: True to print no progress and no messages.
            watched: number of the shuttle that outputs show.
        """
        self._simulator, self._shuttles, self._options, self._quiet = simulator, shuttles, options, quiet
        self._watched = watched
        self._log_name = name
        self._recording: RecordingManager | None = None
        self.episode = Episode(simulator, spec, towns=towns, drivers=[self._driver(shuttle) for shuttle in shuttles])

    def _driver(self, shuttle: Shuttle) -> DriverSetup:
        """Return what drives and watches one vehicle."""
        agents, is_first, is_shown = shuttle.agents, shuttle is self._shuttles[0], shuttle.number == self._watched
        is_watched = is_shown and (self._options.shows_sensors or agents.person is not None)
        operator = shuttle.operator
        return DriverSetup(
            role=shuttle.role,
            start_m=shuttle.start_m,
            config=agents.config,
            folder=shuttle.folder,
            sensors=lambda: SensorsManager(
                *shuttle.sensors,
                late=agents.late_sensors,
                listener=agents,
                is_watched=is_watched,
                by_agent=shuttle.loaded.file is not None,
            ),
            participants=[agents],
            observers=lambda live: (
                *(() if operator is None else operator.managers(live)),
                *(self._observers(live) if is_first else ()),
                *(self._outputs(live, shuttle) if is_shown else ()),
            ),
            interlock=(lambda control: control) if operator is None else operator.interlock,
        )

    @property
    def log(self) -> str | None:
        """The path of CARLA's log as the simulator gave it; None where none was begun."""
        return None if self._recording is None else self._recording.path

    def play(self, seed: int, folder: Path) -> list[Driven]:
        """Drive each vehicle to its end, whatever that is, and close the episode; files go into ``folder``.

        Raises:
            UserError, AgentError: it cannot begin like this.
            SimulatorError: the simulator failed before the drive began.
        """
        try:
            self.episode.prepare(seed, folder)
            driven = drive(self.episode, [shuttle.agents for shuttle in self._shuttles])
        finally:
            self.episode.close()
        for each in driven:
            if self._options.debug and each.agent_error is not None:
                traceback.print_exception(each.agent_error)
        return driven

    def _observers(self, live: Live) -> Sequence[BaseManager]:
        """Return the progress bar and the recording."""
        first = self._shuttles[0]
        live = live._replace(agents=first.agents)
        found: list[BaseManager] = [] if self._quiet else [ProgressBar(live)]
        if self._options.record:
            here = str((self.episode.vehicle.run.folder / LOG_FILE).resolve())
            name = here if self._simulator.own else f"{self._log_name}.log"
            self._recording = RecordingManager(name, lambda: live.sensors.specs)
            found.append(self._recording)
        return found

    def _outputs(self, live: Live, shuttle: Shuttle) -> Sequence[BaseManager]:
        """Return all that shows the drive of a shuttle."""
        say = (lambda _: None) if self._quiet else print
        shown = ShownDrive(live._replace(agents=shuttle.agents), shuttle.loaded.name, say)
        return output_managers(self._options, shown)
