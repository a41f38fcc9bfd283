"""The agent under test: made, bound to its run, asked for a control every tick within its time limit."""

from __future__ import annotations

import math
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, TypeVar

import carla

from basu.agents.config import AgentConfig, parse_config
from basu.agents.sensor_file import SensorSpec, parse_sensors
from basu.agents.time_limit import OverrunError, call_within
from basu.errors import AgentCrashedError, AgentError, AgentInvalidControlError, AgentTimedOutError, UserError
from basu.managers.base_manager import BaseManager
from basu.routing.route_file import RoutePoint

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.agents.loader import LoadedAgent
    from basu.agents.manual.person import Person
    from basu.managers.base_manager import Frame, Run

T = TypeVar("T")
SETUP_LIMIT_S = 120.0  # a driver may load a network's weights before the first tick, not during it


class AgentsManager(BaseManager):
    """Holds the agent. After ``tick``, ``requested`` is its answer and ``control`` the person's, if one drives.

    Before the first answer, the brake is on.
    """

    def __init__(
        self, loaded: LoadedAgent, *, step_limit_s: float, routes: str | None, person: Person | None = None
    ) -> None:
        """Make the agent and ask for its wishes.

        ``routes`` is the command line's, which goes before the agent's; ``person`` may take over from the agent.
        """
        self.person = person
        self._by_hand = False
        self._sensor_data: dict[str, tuple[int, Any]] = {}
        self._step_limit_s = step_limit_s
        self._setup_limit_s = max(SETUP_LIMIT_S, step_limit_s)
        self._name = loaded.agent_class.__name__
        self._bound = False
        self._agent = self._ask("__init__", self._setup_limit_s, loaded.agent_class)
        config = parse_config(self._ask("config", self._setup_limit_s, self._agent.config), self._name)
        self.config: AgentConfig = config if routes is None else replace(config, routes=routes)
        self.control = self.requested = carla.VehicleControl(brake=1.0)

    @property
    def manual(self) -> bool:
        """Whether a person drives, and not the agent."""
        return self._by_hand or bool(self._agent.manual)

    def own_route(self) -> tuple[RoutePoint, ...] | None:
        """The points of the agent's own plan (``get_initial_route_locations``), None where it has none."""
        given = self._ask("get_initial_route_locations", self._setup_limit_s, self._agent.get_initial_route_locations)
        if given is None:
            return None
        try:
            return tuple(_point(place) for place in given)
        except (AttributeError, TypeError, ValueError) as error:
            raise AgentCrashedError(
                f"get_initial_route_locations() of {self._name} returned what is no list of locations: {error}"
            ) from error

    def own_sensors(self) -> tuple[SensorSpec, ...] | None:
        """The agent's own sensor set (``sensors``), None where it has none; empty where it tells it late.

        Raises:
            UserError: it is no list of sensors, or the agent names a sensor file as well.
        """
        return () if self._agent.tells_sensors_late else self._told_sensors()

    def late_sensors(self) -> tuple[SensorSpec, ...]:
        """The sensor set of an agent that can tell it only now that it is set up; empty for all others.

        Raises:
            UserError: as ``own_sensors``.
        """
        return (self._told_sensors() or ()) if self._agent.tells_sensors_late else ()

    def _told_sensors(self) -> tuple[SensorSpec, ...] | None:
        """What ``sensors`` says, read."""
        given = self._ask("sensors", self._setup_limit_s, self._agent.sensors)
        if given is None:
            return None
        source = f"sensors() of {self._name}"
        if isinstance(given, str | Mapping) or not isinstance(given, Iterable):
            raise UserError(f"{source} returned {type(given).__name__}; it must return a list of dicts, one a sensor")
        if self.config.sensors is not None:
            raise UserError(
                f"{source} gives a sensor set, and config() the file {self.config.sensors}; give one of them"
            )
        return parse_sensors(given, source)

    def setup(self, run: Run) -> None:
        """Bind the agent to its run and let it get ready."""
        self._agent.bind(
            client=run.client,
            world=run.world,
            map=run.carla_map,
            vehicle=run.vehicle,
            route=run.route,
            config_values=asdict(self.config),
            time_step_s=run.step_s,
            server_address=run.server_address,
        )
        self._bound = True
        self._step_s = run.step_s
        self._ask("setup", self._setup_limit_s, self._agent.setup)

    def perceive(self, sensor_data: dict[str, tuple[int, Any]]) -> None:
        """Lay what the sensors measured before the agent for its next step."""
        self._sensor_data = sensor_data

    def tick(self, frame: Frame) -> None:
        """Ask for a control, and the person whether it counts."""
        data = self._sensor_data
        answer = self._ask("run_step", self._step_limit_s, lambda: self._agent.run_step(data))
        self.control = self.requested = checked(answer, self._name)
        if self.person is not None:
            by_hand = self.person.step(frame.tick, self._step_s, self.control)
            self._by_hand = by_hand is not None
            self.control = by_hand or self.control

    def close(self) -> None:
        """Let the agent put its things away, where it was bound."""
        if self._bound:
            self._bound = False
            self._ask("destroy", self._setup_limit_s, self._agent.destroy)

    def _ask(self, method: str, limit_s: float, call: Callable[[], T]) -> T:
        """One call of the agent's code; what goes wrong in it is the agent's."""
        try:
            return call_within(limit_s, call)
        except OverrunError:
            raise AgentTimedOutError(
                f"{method}() of {self._name} took longer than its limit of {limit_s:g} s"
            ) from None
        except (AgentError, UserError):
            raise  # it has its sentence
        except (Exception, SystemExit) as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            raise AgentCrashedError(
                f"{method}() of {self._name} raised {type(error).__name__}: {error} "
                f"(line {where.lineno} of {where.filename})"
            ) from error


def checked(answer: object, name: str) -> carla.VehicleControl:
    """The answer of ``run_step`` with its values brought into range, as CARLA does.

    Raises:
        AgentInvalidControlError: it is no ``carla.VehicleControl``, or a value is not a finite number.
    """
    if not isinstance(answer, carla.VehicleControl):
        what = "None" if answer is None else f"a {type(answer).__name__}"
        raise AgentInvalidControlError(f"run_step() of {name} returned {what}; it must return a carla.VehicleControl")
    for value_name, low in (("throttle", 0.0), ("steer", -1.0), ("brake", 0.0)):
        value = getattr(answer, value_name)
        if not math.isfinite(value):
            raise AgentInvalidControlError(f"run_step() of {name} returned a control whose {value_name} is {value}")
        if not low <= value <= 1.0:
            setattr(answer, value_name, min(1.0, max(low, value)))
    return answer


def _point(place: object) -> RoutePoint:
    """A location, transform, way point, or x, y, z as a point of a route."""
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
