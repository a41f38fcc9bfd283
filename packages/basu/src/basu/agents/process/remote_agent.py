"""An agent in a process of its own, with the methods of :class:`basu.agents.calls.AgentCalls`."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import carla

from basu.agents.autonomous_agent import AgentConfig, parse_config
from basu.agents.calls import SETUP_LIMIT_S, checked, timed_out
from basu.agents.loader import LOAD_LIMIT_S, LoadedAgent, is_name, load_agent
from basu.agents.process.agent_process import AgentProcess, CallError, Death, Memory, OverLimitError, ProcessBounds
from basu.agents.process.child import DriveBinding, Wanted
from basu.agents.sensor_file import SensorSpec
from basu.errors import (
    AgentCrashedError,
    AgentEndedOutsideError,
    AgentError,
    AgentInvalidControlError,
    AgentTimedOutError,
    UserError,
)
from basu.routing.route_file import RoutePoint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from basu.agents.sensor_streams import SpawnedSensor
    from basu.routing import Route

T = TypeVar("T")
FAILURES: dict[str, type[AgentError]] = {
    "crashed": AgentCrashedError,
    "timed out": AgentTimedOutError,
    "invalid control": AgentInvalidControlError,
}
"""Which failure of the agent a message of its process tells of. It can tell of no other party's."""
SETUP = "user"  # the kind of a wrong set-up, which only a driver of BASU's own may name
LONGEST_SENTENCE, LONGEST_NAME = 2000, 200  # characters of what an agent's process says
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
    bounds: ProcessBounds = ProcessBounds()
    shuttle: int = 1  # that it drives: the agents of several shuttles have a process each

    def process(self) -> AgentProcess:
        """The process that is kept for this agent; a new one where the last one ended."""
        key = (BUILT_IN_KEY if self.file is None else self.wanted, self.bounds, self.shuttle)
        kept = _kept.get(key)
        if kept is None or not kept.alive:
            kept = _kept[key] = AgentProcess(self.bounds)
        return kept

    @property
    def confinement(self) -> list[str]:
        """The parts of the confinement of its process that the kernel enforces (`basu.agents.process.confinement`)."""
        return list(_enforced.get(self.bounds, ()))


_enforced: dict[ProcessBounds, tuple[str, ...]] = {}  # the same for all agents of a machine
FoundAgent = LoadedAgent | AgentInProcess

_kept: dict[tuple[str, ProcessBounds, int], AgentProcess] = {}


def find_agent(
    wanted: str,
    agent_config: str | None = None,
    *,
    in_process: bool = False,
    memory_gb: float | None = None,
    writes: tuple[str, ...] = (),
    closed_ports: tuple[int, ...] = (),
    output: Path | None = None,
    shuttle: int = 1,
) -> FoundAgent:
    """The agent called ``wanted``, as ``load_agent`` finds it, loaded in a process of its own or in this one.

    ``memory_gb`` limits what its process uses, in GB; ``writes`` are folders in which it may write beside its own;
    it may neither connect to ``closed_ports`` nor listen there. It sees nothing in the folder ``output`` of drives, if
    all that it needs lies elsewhere. The agent of each ``shuttle`` of a run, from 1, has a process of its own.

    Raises:
        UserError: there is none, the file does not load, or it holds no agent or more than one.
    """
    if in_process:
        return load_agent(wanted, agent_config)
    for folder in writes:
        if not Path(folder).is_dir():
            raise UserError(f"--agent-writes {folder}: there is no such folder; make it first")
    memory = None if memory_gb is None else Memory(memory_gb)
    file = None if is_name(wanted.partition(":")[0]) else Path(wanted.partition(":")[0] if ".py:" in wanted else wanted)
    needed = [*writes, *(str(each) for each in (file, agent_config) if each is not None)]
    hidden = () if output is None or _holds(output, needed) else (str(output.resolve()),)
    agent = AgentInProcess(
        "", file, "", False, wanted, agent_config, ProcessBounds(memory, writes, closed_ports, hidden), shuttle
    )
    try:
        process = agent.process()
        found = process.call("load", (wanted, agent_config), limit_s=LOAD_LIMIT_S)
        _enforced[agent.bounds] = process.confinement or ()
    except OverLimitError:
        raise UserError(f"the agent's file {wanted} was not loaded within {LOAD_LIMIT_S:g} s") from None
    except Death as death:
        raise UserError(f"the agent {wanted} does not load: {death}") from death
    except CallError as error:
        raise UserError(error.sentence[:LONGEST_SENTENCE]) from _there(error)
    try:
        return agent._replace(
            name=_name(found["name"]), class_name=_name(found["class_name"]), is_human=found["is_human"] is True
        )
    except (LookupError, TypeError) as error:
        raise UserError(f"the agent {wanted} does not load: its process gave it no name; mend its file") from error


def _holds(folder: Path, needed: Sequence[str]) -> bool:
    """Return whether something that an agent's process needs lies in a folder, or is it."""
    here = folder.resolve()
    places = [*needed, *sys.path, sys.prefix, str(Path.cwd()), tempfile.gettempdir()]
    return any(here in (place, *place.parents) for place in (Path(each).resolve() for each in places))


class RemoteAgent:
    """One agent, from its making to its end; the process outlives it where nothing went wrong."""

    def __init__(self, found: AgentInProcess, step_limit_s: float, seed: int) -> None:
        """Make the agent, with everything random in its process begun anew with ``seed``."""
        self._step_limit_s = step_limit_s
        self._setup_limit_s = max(SETUP_LIMIT_S, step_limit_s)
        self._process = found.process()
        self._is_ours = found.file is None
        self._is_bound = self._has_failed = self._hears = False
        self._step_begins_s = MARGIN_S
        self.name = found.class_name
        wanted = Wanted(found.wanted, found.agent_config, seed, step_limit_s)
        made = self._call("make", wanted, "__init__", self._setup_limit_s + LOAD_LIMIT_S)
        self.name, self.manual, self.gives_sensors_late, self._config = self._understood(
            "__init__",
            lambda: (
                _name(made["name"]),
                made["manual"] is True,
                made["late"] is True,
                parse_config(made["config"], self.name),
            ),
        )

    @property
    def process_id(self) -> int:
        """The keeper of the agent's process: all that the agent starts descends from it."""
        return self._process.pid

    def config(self) -> AgentConfig:
        """What the agent's ``config`` returned."""
        return self._config

    def own_route(self) -> tuple[RoutePoint, ...] | None:
        """The points of the agent's own plan, None where it has none."""
        method = "get_initial_route_locations"
        points = self._call("own_route", None, method, self._setup_limit_s)
        return None if points is None else self._understood(method, lambda: tuple(map(_point, points)))

    def sensor_set(self) -> tuple[SensorSpec, ...] | None:
        """The agent's own sensor set, None where it has none."""
        entries = self._call("sensor_set", None, "sensors", self._setup_limit_s)
        return None if entries is None else self._understood("sensors", lambda: tuple(map(_spec, entries)))

    def setup(self, binding: Mapping[str, Any], timeout_s: float) -> None:
        """Bind the agent to its run with the arguments of ``AutonomousAgent.bind``, and let it get ready."""
        route: Route | None = binding["route"]
        place = DriveBinding(
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
        self.manual = self._call("setup", place, "setup", self._setup_limit_s) is True

    def open_sensor_streams(self, sensors: Sequence[SpawnedSensor]) -> bool:
        """Let the agent's process listen to the agent's sensors; True: it does."""
        self._call("open_sensor_streams", list(sensors), "setup", self._setup_limit_s)
        self._hears = True
        return True

    def close_sensor_streams(self) -> None:
        """Let it stop; nothing happens where the process is gone."""
        if self._process.alive and not self._has_failed:
            self._call("close_sensor_streams", None, "destroy", self._setup_limit_s)

    def ask(self, frame: int, sensor_data: Mapping[str, tuple[int, Any]]) -> None:
        """Ask for the control for the frame that the world has reached, and do not wait for it.

        ``sensor_data`` is not sent: the agent's process has its own.

        Raises:
            AgentError: its process died.
        """
        assert self._hears or not sensor_data, "the SensorsManager of this run lacks its listener"
        with self._failures("run_step", self._step_limit_s, is_step=True):
            self._process.send("step", frame, begin_limit_s=self._step_begins_s)

    def answer(self) -> carla.VehicleControl:
        """Return the control that ``run_step`` answers with, for the frame of the latest question.

        Raises:
            AgentError: it failed, took too long, died, or answered with what is no control. So is a sensor or
                a frame that did not reach its process. The benchmark's own client tells whether the simulator is there.
        """
        with self._failures("run_step", self._step_limit_s, is_step=True):
            answer = self._process.answer(limit_s=self._step_limit_s)
        try:
            *numbers, hand_brake, reverse, manual_gear_shift, gear, manual = answer
            throttle, steer, brake = map(float, numbers)
            control = carla.VehicleControl(
                throttle=throttle,
                steer=steer,
                brake=brake,
                hand_brake=bool(hand_brake),
                reverse=bool(reverse),
                manual_gear_shift=bool(manual_gear_shift),
                gear=int(gear),
            )
        except (TypeError, ValueError, ArithmeticError) as error:
            raise AgentInvalidControlError(f"the process of {self.name} answered with no control: {error}") from error
        self.manual = manual is True
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
            is_clean = self._call("destroy", None, "destroy", self._setup_limit_s) is True and not self._has_failed
        finally:
            if not is_clean:
                self._process.kill()

    def _call(
        self, operation: str, argument: object, method: str, limit_s: float, begin_limit_s: float = SETUP_LIMIT_S
    ) -> Any:  # noqa: ANN401 - as the operation has it
        """One call; what goes wrong in it is the agent's, whatever its process says of others.

        Raises:
            AgentError: it went wrong.
            UserError: the setup of a driver of BASU's own says that the run is set up wrongly for it.
        """
        with self._failures(method, limit_s):
            return self._process.call(operation, argument, limit_s=limit_s, begin_limit_s=begin_limit_s)

    @contextlib.contextmanager
    def _failures(self, method: str, limit_s: float, *, is_step: bool = False) -> Iterator[None]:
        """Turn what goes wrong in a call into the agent's failure.

        Raises:
            AgentError, UserError: as `_call`.
        """
        try:
            yield
        except OverLimitError:
            raise timed_out(method, self.name, limit_s) from None
        except Death as death:
            failure = AgentEndedOutsideError if death.from_outside else AgentCrashedError
            raise failure(f"{self.name} died in {method}(): {death}") from death
        except CallError as error:
            self._has_failed = True
            sentence = error.sentence[:LONGEST_SENTENCE]
            if error.kind == SETUP and self._is_ours and not is_step:
                raise UserError(sentence) from _there(error)
            if error.kind in FAILURES:
                raise FAILURES[error.kind](sentence) from _there(error)
            if error.kind != SETUP:
                sentence = f"{method}() of {self.name} failed: {sentence}"
            raise AgentCrashedError(sentence) from _there(error)

    def _understood(self, method: str, read: Callable[[], T]) -> T:
        """Return the value that the agent's process answered.

        Raises:
            AgentCrashedError: it is not what BASU's own code in that process answers.
        """
        try:
            return read()
        except (UserError, LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
            self._has_failed = True
            raise AgentCrashedError(f"{method}() of {self.name} gave no usable answer: {error}") from error


def _there(error: CallError) -> RuntimeError:
    """The traceback of an error in the agent's process, as the cause of the one here."""
    return RuntimeError(f"in the agent's process\n{error.trace}")


def _name(given: object) -> str:
    """A name of an agent, without what steers a terminal.

    Raises:
        TypeError: it is no text.
    """
    if not isinstance(given, str):
        raise TypeError("a name is a text")
    return "".join(each if each.isprintable() else "?" for each in given[:LONGEST_NAME])


def _point(given: Sequence[Any]) -> RoutePoint:
    """A point of a route out of JSON."""
    x_m, y_m, z_m, yaw_rad = given
    return RoutePoint(float(x_m), float(y_m), float(z_m), None if yaw_rad is None else float(yaw_rad))


def _spec(given: dict[str, Any]) -> SensorSpec:
    """Return the sensor that a JSON object describes.

    Raises:
        TypeError: a value is of another kind than BASU's own code in that process gives.
    """
    entry = {**given, "attributes": tuple((str(name), str(value)) for name, value in given["attributes"])}
    for name, value in entry.items():
        kinds = (int, float) if name.endswith(("_m", "_deg")) else (str,) if name in {"type_id", "id"} else (object,)
        if not isinstance(value, kinds):
            raise TypeError(f"the sensor's {name} is {value!r}")
    return SensorSpec(**entry)


def _key_of(carla_map: carla.Map) -> str:
    """A text that is equal for equal maps; reckoned once for each object."""
    if _last_key[0] is not carla_map:
        text = carla_map.to_opendrive()
        _last_key[:] = [carla_map, f"{carla_map.name} {hashlib.sha256(text.encode()).hexdigest()}"]
    key: str = _last_key[1]
    return key


_last_key: list[Any] = [None, ""]
