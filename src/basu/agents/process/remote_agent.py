"""An agent in a process of its own, with the methods of :class:`basu.agents.calls.AgentCalls`."""

from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

import carla

from basu.agents.autonomous_agent import AgentConfig
from basu.agents.calls import SETUP_LIMIT_S, checked, timed_out
from basu.agents.loader import BUILT_IN, LOAD_LIMIT_S, LoadedAgent, load_agent
from basu.agents.process.agent_process import AgentProcess, CallError, Death, Memory, OverLimitError
from basu.agents.process.child import Place, Wanted
from basu.agents.sensor_file import SensorSpec
from basu.errors import (
    AgentCrashedError,
    AgentInvalidControlError,
    AgentTimedOutError,
    BasuError,
    SimulatorError,
    UserError,
)
from basu.routing.route_file import RoutePoint

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.agents.sensor_streams import SpawnedSensor
    from basu.routing import Route

ERRORS: dict[str, type[BasuError]] = {
    "crashed": AgentCrashedError,
    "timed out": AgentTimedOutError,
    "invalid control": AgentInvalidControlError,
    "user": UserError,
    "simulator": SimulatorError,
}
MARGIN_S = 5.0  # beyond the simulator's time-out for a step to begin: the process itself reports the cause of the wait
BUILT_IN_KEY = ""  # BASU's own agents share a process: none of them leaves anything behind


class AgentInProcess(NamedTuple):
    """An agent with its code in a process of its own, and not here."""

    name: str  # for folders and tables
    file: Path | None  # None: BASU's own
    class_name: str
    is_human: bool
    wanted: str  # as it was typed
    agent_config: str | None
    memory: Memory | None

    def process(self) -> AgentProcess:
        """The process that is kept for this agent; a new one where the last one ended."""
        key = (BUILT_IN_KEY if self.file is None else self.wanted, self.memory)
        kept = _kept.get(key)
        if kept is None or not kept.alive:
            kept = _kept[key] = AgentProcess(self.memory)
        return kept


FoundAgent = LoadedAgent | AgentInProcess

_kept: dict[tuple[str, Memory | None], AgentProcess] = {}


def find_agent(
    wanted: str, agent_config: str | None = None, *, in_process: bool = False, memory_gb: float | None = None
) -> FoundAgent:
    """The agent called ``wanted``, as ``load_agent`` finds it, loaded in a process of its own or in this one.

    ``memory_gb`` limits what its process uses, in GB.

    Raises:
        UserError: there is none, the file does not load, or it holds no agent or more than one.
    """
    if in_process:
        return load_agent(wanted, agent_config)
    memory = None if memory_gb is None else Memory(memory_gb)
    file = (
        None if wanted.partition(":")[0] in BUILT_IN else Path(wanted.partition(":")[0] if ".py:" in wanted else wanted)
    )
    agent = AgentInProcess("", file, "", False, wanted, agent_config, memory)
    try:
        found = agent.process().call("load", (wanted, agent_config), limit_s=LOAD_LIMIT_S)
    except OverLimitError:
        raise UserError(f"the agent's file {wanted} was not loaded within {LOAD_LIMIT_S:g} s") from None
    except Death as death:
        raise UserError(f"the agent {wanted} does not load: {death}") from death
    except CallError as error:
        _raise(error)
    return agent._replace(**found)


class RemoteAgent:
    """One agent, from its making to its end; the process outlives it where nothing went wrong."""

    def __init__(self, found: AgentInProcess, step_limit_s: float, seed: int) -> None:
        """Make the agent, with everything random in its process begun anew with ``seed``."""
        self._step_limit_s = step_limit_s
        self._setup_limit_s = max(SETUP_LIMIT_S, step_limit_s)
        self._process = found.process()
        self._is_bound = self._has_failed = self._hears = False
        self._step_begins_s = MARGIN_S
        self.name = found.class_name
        wanted = Wanted(found.wanted, found.agent_config, seed, step_limit_s)
        made = self._call("make", wanted, "__init__", self._setup_limit_s + LOAD_LIMIT_S)
        self.name = made["name"]
        self.manual: bool = made["manual"]
        self.gives_sensors_late: bool = made["late"]
        self._config = AgentConfig(**made["config"])

    def config(self) -> AgentConfig:
        """What the agent's ``config`` returned."""
        return self._config

    def own_route(self) -> tuple[RoutePoint, ...] | None:
        """The points of the agent's own plan, None where it has none."""
        method = "get_initial_route_locations"
        points = self._call("own_route", None, method, self._setup_limit_s)
        return None if points is None else tuple(RoutePoint(*point) for point in points)

    def sensor_set(self) -> tuple[SensorSpec, ...] | None:
        """The agent's own sensor set, None where it has none."""
        entries = self._call("sensor_set", None, "sensors", self._setup_limit_s)
        return None if entries is None else tuple(_spec(entry) for entry in entries)

    def setup(self, binding: Mapping[str, Any], timeout_s: float) -> None:
        """Bind the agent to its run with the arguments of ``AutonomousAgent.bind``, and let it get ready."""
        route: Route | None = binding["route"]
        place = Place(
            address=binding["server_address"],
            timeout_s=timeout_s,
            frame=binding["world"].get_snapshot().frame,
            map_key=_key_of(binding["map"]),
            vehicle_id=binding["vehicle"].id,
            route=None if route is None else dataclasses.replace(route, waypoints=()),
            places_m=() if route is None else [waypoint.s for waypoint in route.waypoints],
            config_values=dict(binding["config_values"]),
            time_step_s=binding["time_step_s"],
        )
        self._step_begins_s = timeout_s + MARGIN_S
        self._is_bound = True
        self.manual = self._call("setup", place, "setup", self._setup_limit_s)

    def hear(self, sensors: Sequence[SpawnedSensor]) -> bool:
        """Let the agent's process listen to the agent's sensors; True: it does."""
        self._call("hear", list(sensors), "setup", self._setup_limit_s)
        self._hears = True
        return True

    def stop_hearing(self) -> None:
        """Let it stop; nothing happens where the process is gone."""
        if self._process.alive and not self._has_failed:
            self._call("stop_hearing", None, "destroy", self._setup_limit_s)

    def step(self, frame: int, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """The control that ``run_step`` answers with, for the frame that the world has reached.

        ``sensor_data`` is not sent: the agent's process has its own.

        Raises:
            AgentError: it failed, took too long, died, or answered with what is no control.
            SimulatorError: a sensor, or the frame itself, did not come.
        """
        assert self._hears or not sensor_data, "the SensorsManager of this run lacks its listener"
        answer = self._call("step", frame, "run_step", self._step_limit_s, self._step_begins_s)
        try:
            throttle, steer, brake, hand_brake, reverse, manual_gear_shift, gear, manual = answer
            control = carla.VehicleControl(
                throttle=float(throttle),
                steer=float(steer),
                brake=float(brake),
                hand_brake=bool(hand_brake),
                reverse=bool(reverse),
                manual_gear_shift=bool(manual_gear_shift),
                gear=int(gear),
            )
        except (TypeError, ValueError) as error:
            raise AgentInvalidControlError(f"the process of {self.name} answered with no control: {error}") from error
        self.manual = bool(manual)
        return checked(control, self.name)

    def destroy(self) -> None:
        """Let the agent put its things away, where it was bound; a process that is not to be trusted is ended."""
        if not self._is_bound:
            return
        self._is_bound = False
        if not self._process.alive:
            return
        is_clean = False
        try:
            is_clean = self._call("destroy", None, "destroy", self._setup_limit_s) and not self._has_failed
        finally:
            if not is_clean:
                self._process.kill()

    def _call(
        self, operation: str, argument: object, method: str, limit_s: float, begin_limit_s: float = SETUP_LIMIT_S
    ) -> Any:  # noqa: ANN401 - as the operation has it
        """One call; what goes wrong in it is the agent's, but for what its process says of others."""
        try:
            return self._process.call(operation, argument, limit_s=limit_s, begin_limit_s=begin_limit_s)
        except OverLimitError:
            raise timed_out(method, self.name, limit_s) from None
        except Death as death:
            raise AgentCrashedError(f"{self.name} died in {method}(): {death}") from death
        except CallError as error:
            self._has_failed = True
            _raise(error)


def _raise(error: CallError) -> NoReturn:
    """Raise here what an operation raised there; its traceback is the cause."""
    error_class = ERRORS.get(error.kind, RuntimeError)
    raise error_class(error.sentence) from RuntimeError(f"in the agent's process\n{error.trace}")


def _spec(entry: dict[str, Any]) -> SensorSpec:
    """A sensor out of JSON."""
    return SensorSpec(**{**entry, "attributes": tuple((name, value) for name, value in entry["attributes"])})


def _key_of(carla_map: carla.Map) -> str:
    """A text that is equal for equal maps; reckoned once for each object."""
    if _last_key[0] is not carla_map:
        text = carla_map.to_opendrive()
        _last_key[:] = [carla_map, f"{carla_map.name} {hashlib.sha256(text.encode()).hexdigest()}"]
    key: str = _last_key[1]
    return key


_last_key: list[Any] = [None, ""]
