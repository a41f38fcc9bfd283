"""`AgentsManager`: creates and steps the agent under a time limit; its sensors and route; takeover by a person."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.agent_files import sensor_rules
from basu.agents.calls import SETUP_LIMIT_S, AgentCalls
from basu.agents.loader import LoadedAgent
from basu.agents.process.remote_agent import RemoteAgent
from basu.conditions import SENSORS
from basu.errors import AgentError, UserError
from basu.managers.base_manager import BaseManager
from basu.managers.conduct import Conduct
from basu.managers.passage import Passage

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.agents.sensor_file import SensorSpec
    from basu.agents.sensor_streams import SpawnedSensor
    from basu.conditions import LeaderboardTrack, Track
    from basu.managers.base_manager import Frame, Run
    from basu.managers.person import Person
    from basu.routing.route_file import RoutePoint


class AgentsManager(BaseManager):
    """Holds the agent. After ``tick``, ``requested`` is its answer and ``control`` the person's, if one drives.

    Before the first answer, the brake is on.
    """

    def __init__(
        self,
        loaded: FoundAgent,
        *,
        step_limit_s: float,
        routes: str | None,
        person: Person | None = None,
        seed: int = 0,
        track: Track | None = None,
        leaderboard_track: LeaderboardTrack | None = None,
        is_open: bool = False,
        has_conditions: bool = True,
    ) -> None:
        """Make the agent and ask for its wishes.

        ``routes`` is the command line's, which goes before the agent's; ``person`` may take over from the agent;
        ``seed`` is what everything random in the agent's own process begins with; ``track`` goes before the agent's;
        ``leaderboard_track`` is one of the leaderboard's, with rules on sensors; ``is_open`` connects its process to
        the simulator itself. Without ``has_conditions`` the route, the vehicle, the
        weather and the traffic are the benchmark's: the agent's wishes for them become the sentence ``ignored``.
        """
        self.person = person
        self._by_hand = False
        self._sensor_data: dict[str, tuple[int, Any]] = {}
        self._agent: AgentCalls | RemoteAgent
        if isinstance(loaded, LoadedAgent):
            self._agent = AgentCalls(loaded.agent_class, step_limit_s, is_ours=loaded.file is None)
        else:
            self._agent = RemoteAgent(loaded, step_limit_s, seed)
        self._conduct = Conduct(self._agent.name)
        self._passage = Passage(self._agent, loaded, is_open=is_open)
        self._is_watched = isinstance(self._agent, RemoteAgent)
        config = self._agent.config()
        self._has_conditions, self.ignored = has_conditions, ""
        if not has_conditions:
            self.ignored = _ignored(self._agent.name, config.conditions_asked())
            config = config.without_conditions()
        self.config: AgentConfig = config if routes is None else replace(config, routes=routes)
        self._leaderboard_track = leaderboard_track
        self._rules = None if leaderboard_track is None else sensor_rules(leaderboard_track)
        if track is not None or self._rules is not None:
            self.config = replace(self.config, track=track or SENSORS)
        self.control = self.requested = carla.VehicleControl(brake=1.0)

    @property
    def access(self) -> dict[str, Any]:
        """The agent's track, whether a gate stood between it and the simulator, and what that refused."""
        rules = {} if self._rules is None else {"leaderboard": self._rules.document()}
        return {**self._passage.document(self.config.track), **rules}

    @property
    def manual(self) -> bool:
        """Whether a person drives, and not the agent."""
        return self._by_hand or self._agent.manual

    def own_route(self) -> tuple[RoutePoint, ...] | None:
        """Return the points of the agent's own plan (``get_initial_route_locations``); None without one."""
        return self._agent.own_route() if self._has_conditions else None

    def own_sensors(self) -> tuple[SensorSpec, ...] | None:
        """The agent's own sensor set (``sensors``), None where it has none; empty where it gives it late.

        Raises:
            UserError: it is no list of sensors, or the agent names a sensor file as well.
        """
        return () if self._agent.gives_sensors_late else self._agent.sensor_set()

    def admitted(self, specs: tuple[SensorSpec, ...], source: str) -> tuple[SensorSpec, ...]:
        """Return the sensors of a set for the simulator, by the rules of the leaderboard's track.

        Raises:
            UserError: the set breaks a rule.
        """
        return specs if self._rules is None else self._rules.admit(specs, source)

    def late_sensors(self) -> tuple[SensorSpec, ...]:
        """The sensor set of an agent that can give it only now that it is set up; empty for all others.

        Raises:
            UserError: as ``own_sensors``.
        """
        if not self._agent.gives_sensors_late:
            return ()
        return self.admitted(self._agent.sensor_set() or (), f"sensors() of {self._agent.name}")

    def open_sensor_streams(self, sensors: Sequence[SpawnedSensor]) -> bool:
        """Take the sensors that were spawned for the agent; whether its process listens to them itself."""
        self._passage.add_sensors(sensors)
        return self._agent.open_sensor_streams(sensors)

    def close_sensor_streams(self) -> None:
        """Stop listening; the sensors are about to be destroyed."""
        self._agent.close_sensor_streams()

    def setup(self, run: Run) -> None:
        """Bind the agent to its run and let it get ready."""
        binding = {
            "client": run.client,
            "world": run.world,
            "map": run.carla_map,
            "vehicle": run.vehicle,
            **self._passage.told(run.route, asdict(self.config) | {"leaderboard_track": self._leaderboard_track}),
            "time_step_s": run.step_s,
            "server_address": self._passage.open(run, self.config.track),
        }
        self._step_s = run.step_s
        if self._is_watched:
            self._conduct.begin(run)
        self._agent.setup(binding, run.timeout_s)

    def perceive(self, sensor_data: dict[str, tuple[int, Any]]) -> None:
        """Lay what the sensors measured before the agent for its next step."""
        self._sensor_data = sensor_data

    def tick(self, frame: Frame) -> None:
        """Ask for a control and wait for it: `ask`, then `answer`."""
        self.ask(frame)
        self.answer(frame)

    def ask(self, frame: Frame) -> None:
        """Ask the agent for a control; an agent in its own process computes it meanwhile.

        Raises:
            AgentError: its vehicle had another control, or its process died.
            SimulatorError: the gate has ended.
        """
        self._conduct.before(frame)
        self._passage.see(frame)
        self._agent.ask(frame.server_frame, self._sensor_data)

    def answer(self, frame: Frame) -> None:
        """Wait for the agent's control, and ask the person whether it counts.

        Raises:
            AgentError: the agent failed, or gave none.
        """
        self.control = self.requested = self._agent.answer()
        if self.person is not None:
            by_hand = self.person.step(frame.tick, self._step_s, self.control)
            self._by_hand = by_hand is not None
            self.control = by_hand or self.control

    def close(self) -> None:
        """Let the agent put its things away, where it was bound, and close its gate."""
        try:
            self._agent.destroy()
        finally:
            self._passage.close()


def ignored_wishes(loaded: FoundAgent) -> str:
    """Return the sentence about the conditions that an agent asks for where the benchmark gives them; mostly empty.

    An agent that cannot be made says nothing here: its drives will.
    """
    if loaded.file is None or isinstance(loaded, LoadedAgent):
        return ""
    try:
        agents = AgentsManager(loaded, step_limit_s=SETUP_LIMIT_S, routes=None, has_conditions=False)
    except (UserError, AgentError):
        return ""
    agents.close()
    return agents.ignored


def _ignored(name: str, asked: Mapping[str, str]) -> str:
    """Return the sentence about the conditions that an agent asked for in a benchmark; empty without any."""
    if not asked:
        return ""
    wishes = ", ".join(f"{key} '{value}'" for key, value in asked.items())
    return f"config() of {name} asks for {wishes}; these are the benchmark's here, so the wishes are ignored"
