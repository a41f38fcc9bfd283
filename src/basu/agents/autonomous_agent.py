"""The base class of every agent, with the data that it receives and the checked answer of its ``config()``.

A first agent of your own is a file with one class::

    import carla

    class Careful(AutonomousAgent):
        def setup(self):
            self.gnss_id = "GPS"

        def run_step(self, sensor_data):
            frame, fix = sensor_data[self.gnss_id]
            return carla.VehicleControl(throttle=0.3)

        def config(self):
            return {"routes": "routes/linden_short.xml", "sensors": "config/sensors.json"}

and is driven by ``basu run my_agent.py``. Nothing here has to be called by an agent: ``__init__`` needs no arguments
and need not be overridden.
"""

from __future__ import annotations

import difflib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from basu.agents.sight import Sight
from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import carla

    from basu.agents.sight import Other
    from basu.routing import Route


class AutonomousAgent(ABC):
    """A driver. The life of one: ``config``, then ``bind`` (by BASU), ``setup``, ``run_step`` each tick, ``destroy``.

    From ``setup`` on, these are there:

    Attributes:
        client: the ``carla.Client`` BASU itself is connected with.
        world: the ``carla.World`` of this run. It is in synchronous mode and BASU ticks it: an agent never does.
        map: the ``carla.Map`` of the world.
        vehicle: the ``carla.Vehicle`` to be driven. BASU applies what ``run_step`` returns.
        route: the route to follow, joined along the lanes; None where the run has none.
        config_values: what ``config`` returned, completed by BASU with what the command line overrode.
        time_step_s: simulated seconds between two calls of ``run_step``.
        server_address: host and port of the simulator, for an agent that connects by itself.
        manual: whether a person drives at the moment; an agent that lets persons drive keeps it true meanwhile.
    """

    client: carla.Client
    world: carla.World
    map: carla.Map
    vehicle: carla.Vehicle
    route: Route | None
    config_values: Mapping[str, Any]
    time_step_s: float
    server_address: tuple[str, int]
    manual: bool = False
    driven_by_person: bool = False  # whether a person drives at first, before a window; the human agent
    gives_sensors_late: bool = False  # whether ``sensors`` is asked after ``setup``; for other programs' agents
    _sight: Sight | None = None

    def bind(
        self,
        *,
        client: carla.Client,
        world: carla.World,
        map: carla.Map,  # noqa: A002 - the word the thesis and CARLA's users have for it
        vehicle: carla.Vehicle,
        route: Route | None,
        config_values: Mapping[str, Any],
        time_step_s: float,
        server_address: tuple[str, int] = ("127.0.0.1", 2000),
    ) -> None:
        """Hand the agent its run. BASU calls this once, before ``setup``; an agent does not override it."""
        self.client = client
        self.world = world
        self.map = map
        self.vehicle = vehicle
        self.route = route
        self.config_values = config_values
        self.time_step_s = time_step_s
        self.server_address = server_address

    @abstractmethod
    def setup(self) -> None:
        """Get ready to drive: the world, the vehicle and the route are there; the first tick is still to come."""

    @abstractmethod
    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Answer one tick with what the driver's hands and feet do until the next.

        Args:
            sensor_data: for each sensor id of the sensor set the frame it was measured in and the measurement,
                a ``carla.SensorData``. A sensor with nothing new since the last tick still has its last one.

        Returns:
            A ``carla.VehicleControl`` with finite numbers. Anything else, an exception, or taking longer than the
            time limit of a step ends the run, with all that was measured until then.
        """

    @abstractmethod
    def config(self) -> Mapping[str, Any]:
        """Say what the agent wants to be driven in; asked once, before there is a world.

        Keys, all optional: ``routes`` (route XML), ``sensors`` (sensor JSON), ``vehicle`` (blueprint id), ``weather``
        (the name of one of CARLA's presets), ``sumo`` (folder of a SUMO network). File names are looked for from the
        working folder, then from the agent's own file, then among the files BASU brings.
        """

    def sensors(self) -> Sequence[Mapping[str, Any]] | None:
        """Give a sensor set of one's own, as the CARLA leaderboard's agents do; None, as here, takes the sensor file.

        One dict a sensor, as an entry of the file: ``{"type": "sensor.camera.rgb", "id": "FRONT", "x": 1.5, "z": 2.4,
        "width": 800, "height": 600, "fov": 90}``.
        """
        return None

    def get_initial_route_locations(self) -> Sequence[carla.Location] | None:
        """Give a route of one's own as locations to be joined along the lanes; None, as here, takes the route file."""
        return None

    def visible_actors(self) -> list[Other]:
        """Return the vehicles, walkers and props that the vehicle can see, or saw up to 2 s ago; call it once a tick.

        It is what BASU's own agents know of others: actors within 80 m whose line of sight from the roof is free of
        houses, trees, parked cars and other actors, within the range of light and weather. Each is a
        :class:`basu.agents.sight.Other` with its box's centre, heading, velocity and size in CARLA's world frame (m,
        rad, m/s; x east, y south, yaw clockwise). ``unseen_s`` is 0, or the time since it was last seen; its place is
        extrapolated since then. For another radius, hold a :class:`basu.agents.sight.Sight` of your own.
        """
        if self._sight is None:
            self._sight = Sight(self.world, self.vehicle)
        return self._sight.others()

    def destroy(self) -> None:  # noqa: B027 - most agents have nothing to put away
        """Put away what ``setup`` took (files, windows, processes); called once after the last step in every case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentConfig:
    """An agent's wishes; file names as given, looked for later."""

    routes: str = "routes/linden_leap.xml"
    sensors: str | None = None
    sumo: str | None = None
    vehicle: str = "vehicle.easymile.ez10"
    weather: str = "ClearNoon"


def parse_config(given: Any, agent: str) -> AgentConfig:  # noqa: ANN401 - whatever a stranger's method returned
    """Check what the ``config()`` of ``agent`` returned; None takes every default.

    Raises:
        UserError: it is no dict, has a key that means nothing, or a value that is no text.
    """
    if given is None:
        return AgentConfig()
    if not isinstance(given, Mapping):
        raise UserError(f"config() of {agent} returned {type(given).__name__}; it must return a dict, such as {{}}")
    known = [field.name for field in fields(AgentConfig)]
    for key, value in given.items():
        if key not in known:
            close = difflib.get_close_matches(str(key), known, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(known)}"
            raise UserError(f"config() of {agent} has the key {key!r}, which means nothing here; {hint}")
        if value is not None and (not isinstance(value, str) or not value):
            raise UserError(f"config() of {agent}: '{key}' is {value!r}; it must be a text")
    return AgentConfig(**{key: value for key, value in given.items() if value is not None})
