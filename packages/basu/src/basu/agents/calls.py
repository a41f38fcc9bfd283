"""Calls of an agent's methods within their time limits; an error in one becomes the agent's failure.

In the main thread an interval timer's signal raises inside the call, at no cost that could be measured. Elsewhere, and
where there are no such signals (Windows), the call runs in a thread of its own that is left behind when it overruns.
"""

from __future__ import annotations

import math
import queue
import signal
import threading
import traceback
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import carla

from basu.agents.autonomous_agent import AgentConfig, parse_config
from basu.agents.sensor_file import SensorSpec, parse_sensors
from basu.agents.sensor_streams import as_array
from basu.errors import AgentCrashedError, AgentError, AgentInvalidControlError, AgentTimedOutError, UserError
from basu.routing.route_file import RoutePoint

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from basu.agents.autonomous_agent import AutonomousAgent
    from basu.agents.sensor_streams import SpawnedSensor


T = TypeVar("T")
AGAIN_S = 0.2  # the signal is repeated: code that swallows every exception is interrupted in its next line too


class OverrunError(BaseException):
    """The call took too long. Not an ``Exception``: an agent's ``except Exception`` must not swallow it."""


def can_interrupt() -> bool:
    """Whether calls from here are limited by a signal rather than by a thread."""
    return hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()


def call_within(limit_s: float, function: Callable[[], T]) -> T:
    """Call ``function``, at most for ``limit_s`` of wall time.

    Raises:
        OverrunError: the time is over.
    """
    return _call_interrupted(limit_s, function) if can_interrupt() else _call_abandoned(limit_s, function)


def _overrun(_signal: int, _frame: FrameType | None) -> NoReturn:
    raise OverrunError


def _call_interrupted(limit_s: float, function: Callable[[], T]) -> T:
    """With the interval timer of the main thread."""
    before = signal.signal(signal.SIGALRM, _overrun)
    try:
        signal.setitimer(signal.ITIMER_REAL, limit_s, AGAIN_S)
        try:
            return function()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    finally:
        signal.signal(signal.SIGALRM, before)


def _call_abandoned(limit_s: float, function: Callable[[], T]) -> T:
    """In a daemon thread that is not waited for any longer than the limit."""
    answers: queue.SimpleQueue[tuple[T | None, BaseException | None]] = queue.SimpleQueue()

    def work() -> None:
        try:
            answers.put((function(), None))
        except BaseException as error:  # noqa: BLE001 - handed over to the waiting thread, whatever it is
            answers.put((None, error))

    threading.Thread(target=work, name="basu-agent", daemon=True).start()
    try:
        answer, error = answers.get(timeout=limit_s)
    except queue.Empty:
        raise OverrunError from None
    if error is not None:
        raise error
    return answer  # type: ignore[return-value]  # no error: it is what the function returned


SETUP_LIMIT_S = 120.0  # a driver may load a network's weights before the first tick, not during it
PEDALS_AND_WHEEL = (("throttle", 0.0), ("steer", -1.0), ("brake", 0.0))  # with the lowest value; the highest is 1
SWITCHES = ("hand_brake", "reverse", "manual_gear_shift")
PAIR = 2
WRITES = "; an agent writes in the folder $BASU_AGENT_FOLDER, and elsewhere with --agent-writes DIR"


class AgentCalls:
    """An agent in this process. :class:`basu.agents.process.remote_agent.RemoteAgent` has the same methods."""

    def __init__(
        self,
        agent_class: type[AutonomousAgent],
        step_limit_s: float,
        *,
        is_ours: bool = True,
        failures: tuple[type[BaseException], ...] = (Exception, SystemExit),
    ) -> None:
        """Make the agent.

        ``is_ours``: it is one of BASU's own, so a ``UserError`` in its ``setup`` is true. ``failures`` are the
        exceptions that count as the agent's; a ``KeyboardInterrupt`` is the user's where Ctrl-C reaches this process.
        """
        self._failures = failures
        self._step_limit_s = step_limit_s
        self._setup_limit_s = max(SETUP_LIMIT_S, step_limit_s)
        self._is_ours = is_ours
        self._is_bound = False
        self._config: AgentConfig | None = None
        self._asked: tuple[int, Mapping[str, tuple[int, Any]]] = (0, {})
        self._as_numpy: frozenset[str] = frozenset()  # ids of the sensors with measurements as arrays
        self.name = agent_class.__name__
        self.agent = self._call("__init__", self._setup_limit_s, agent_class)

    @property
    def manual(self) -> bool:
        """Whether the agent says that a person drives."""
        return bool(self.agent.manual)

    @property
    def gives_sensors_late(self) -> bool:
        """Whether the agent can give its sensor set only after its setup."""
        return self.agent.gives_sensors_late

    def config(self) -> AgentConfig:
        """What the agent's ``config`` returned.

        Raises:
            UserError: it is no such dict.
        """
        if self._config is None:
            self._config = parse_config(self._call("config", self._setup_limit_s, self.agent.config), self.name)
        return self._config

    def own_route(self) -> tuple[RoutePoint, ...] | None:
        """The points of the agent's own plan (``get_initial_route_locations``), None where it has none."""
        method = "get_initial_route_locations"
        given = self._call(method, self._setup_limit_s, self.agent.get_initial_route_locations)
        if given is None:
            return None
        try:
            return tuple(route_point(place) for place in given)
        except (AttributeError, TypeError, ValueError) as error:
            raise AgentCrashedError(f"{method}() of {self.name} returned what is no list of locations: {error}") from (
                error
            )

    def sensor_set(self) -> tuple[SensorSpec, ...] | None:
        """The sensor set of the agent's ``sensors``, None where it has none.

        Raises:
            UserError: it is no list of sensors, or the agent names a sensor file as well.
        """
        given = self._call("sensors", self._setup_limit_s, self.agent.sensors)
        if given is None:
            return None
        source = f"sensors() of {self.name}"
        if isinstance(given, str | Mapping) or not isinstance(given, Iterable):
            raise UserError(f"{source} returned {type(given).__name__}; it must return a list of dicts, one a sensor")
        file = self.config().sensors
        if file is not None:
            raise UserError(f"{source} gives a sensor set, and config() the file {file}; give one of them")
        return parse_sensors(given, source)

    def setup(self, binding: Mapping[str, Any], timeout_s: float) -> None:
        """Bind the agent to its run with the arguments of ``AutonomousAgent.bind``, and let it get ready.

        ``timeout_s`` is how long the simulator is waited for, which nothing here does.
        """
        del timeout_s
        self.agent.bind(**binding)
        self._is_bound = True
        try:
            self._call("setup", self._setup_limit_s, self.agent.setup)
        except UserError as error:
            if self._is_ours:
                raise
            raise self._crashed("setup", error) from error

    def open_sensor_streams(self, sensors: Iterable[SpawnedSensor]) -> bool:
        """Note which measurements the agent wants as arrays; False: this does not listen to sensors itself."""
        sensors = tuple(sensors)
        self._as_numpy = frozenset(sensor.id for sensor in sensors if sensor.as_numpy)
        self.name_sensors(sensors)
        return False

    def name_sensors(self, sensors: Iterable[SpawnedSensor]) -> None:
        """Tell the agent which actors its sensors are."""
        self.agent.bind_sensors({sensor.id: sensor.actor_id for sensor in sensors})

    def close_sensor_streams(self) -> None:
        """Do nothing: this class does not listen to sensors itself."""

    def step(self, frame: int, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """The control that ``run_step`` answers with, for the frame that the world has reached.

        Raises:
            AgentError: it failed, took too long, or answered with what is no control.
        """
        del frame  # the client here has seen it
        if self._as_numpy:
            sensor_data = {
                name: (made_in, as_array(measured) if name in self._as_numpy else measured)
                for name, (made_in, measured) in sensor_data.items()
            }
        try:
            answer = self._call("run_step", self._step_limit_s, lambda: self.agent.run_step(sensor_data))
        except UserError as error:  # the set-up was right when the run began: nothing in a step is its fault
            raise self._crashed("run_step", error) from error
        return checked(answer, self.name)

    def ask(self, frame: int, sensor_data: Mapping[str, tuple[int, Any]]) -> None:
        """Note what ``answer`` gives to the agent: in this process nothing is computed meanwhile."""
        self._asked = (frame, sensor_data)

    def answer(self) -> carla.VehicleControl:
        """Return the control that answers the latest question.

        Raises:
            AgentError: as ``step``.
        """
        return self.step(*self._asked)

    def destroy(self) -> None:
        """Let the agent put its things away, where it was bound.

        Raises:
            AgentError: it failed, which changes no outcome.
        """
        if self._is_bound:
            self._is_bound = False
            try:
                self._call("destroy", self._setup_limit_s, self.agent.destroy)
            except UserError as error:
                raise self._crashed("destroy", error) from error

    def _call(self, method: str, limit_s: float, call: Callable[[], T]) -> T:
        """Call the agent's code within a time limit; raise AgentError for its failures and for overruns."""
        try:
            return call_within(limit_s, call)
        except OverrunError:
            raise timed_out(method, self.name, limit_s) from None
        except (AgentError, UserError):
            raise  # it has its sentence
        except self._failures as error:
            raise self._crashed(method, error) from error

    def _crashed(self, method: str, error: BaseException) -> AgentCrashedError:
        """The failure that an exception in a method is."""
        where = traceback.extract_tb(error.__traceback__)[-1]
        hint = WRITES if isinstance(error, PermissionError) and not self._is_ours else ""
        return AgentCrashedError(
            f"{method}() of {self.name} raised {type(error).__name__}: {error} "
            f"(line {where.lineno} of {where.filename}){hint}"
        )


def timed_out(method: str, name: str, limit_s: float) -> AgentTimedOutError:
    """The failure of a call that took too long."""
    return AgentTimedOutError(f"{method}() of {name} took longer than its limit of {limit_s:g} s")


def checked(answer: object, name: str) -> carla.VehicleControl:
    """The answer of ``run_step`` as a control of its own, with its values brought into range, as CARLA does.

    Each value is read once: a subclass could give another one to each reader.

    Raises:
        AgentInvalidControlError: it is no ``carla.VehicleControl``, or a value is not a finite number.
    """
    if not isinstance(answer, carla.VehicleControl):
        what = "None" if answer is None else f"a {type(answer).__name__}"
        raise AgentInvalidControlError(f"run_step() of {name} returned {what}; it must return a carla.VehicleControl")
    try:
        numbers = {value_name: float(getattr(answer, value_name)) for value_name, _ in PEDALS_AND_WHEEL}
        flags = {flag: bool(getattr(answer, flag)) for flag in SWITCHES}
        control = carla.VehicleControl(gear=int(answer.gear), **flags)
    except Exception as error:  # a property of a subclass may raise anything
        raise AgentInvalidControlError(
            f"run_step() of {name} returned a control that cannot be read: {type(error).__name__}: {error}"
        ) from error
    for value_name, low in PEDALS_AND_WHEEL:
        value = numbers[value_name]
        if not math.isfinite(value):
            raise AgentInvalidControlError(f"run_step() of {name} returned a control with {value_name} {value}")
        setattr(control, value_name, min(1.0, max(low, value)))
    return control


def route_point(place: object) -> RoutePoint:
    """A location, transform, way point, or x, y, z as a point of a route; or a pair of one with a ``RoadOption``."""
    if isinstance(place, tuple | list) and len(place) == PAIR:
        place = place[0]  # as CARLA's GlobalRoutePlanner gives a plan: the option says what the next point shows too
    yaw_rad = None
    if isinstance(place, carla.Waypoint):
        place = place.transform
    if isinstance(place, carla.Transform):
        yaw_rad = math.radians(place.rotation.yaw)
        place = place.location
    if isinstance(place, carla.Location):
        return RoutePoint(place.x, place.y, place.z, yaw_rad)
    x_m, y_m, z_m = (float(value) for value in place)  # type: ignore[attr-defined]  # a TypeError is the caller's
    return RoutePoint(x_m, y_m, z_m)
