"""The base class of all agents: what an agent receives, its methods, and the checked answer of its ``config()``.

``docs/reference/agent-api.md`` is generated from the docstrings of this file; ``examples/first_agent.py`` is a complete
agent. ``basu run my_agent.py`` drives the agent of a file. An agent needs no ``__init__``.
"""

from __future__ import annotations

import difflib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from basu.agents.sight import Sight
from basu.conditions import TRACKS, WORLD
from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import carla

    from basu.agents.sight import Other
    from basu.routing import Route

TEXT_RADIO = "sensor.other.v2x_custom"
LONGEST_TEXT_BYTES = 99
"""Of a message of CARLA's custom radio: its record has 100 bytes, and the last ends the text."""


class AutonomousAgent(ABC):
    """An agent that drives one vehicle along one route.

    BASU calls ``config`` and ``sensors``, then ``bind``, ``setup``, ``run_step`` in each tick, and ``destroy`` at the
    end. All attributes have their values before ``setup``.

    Attributes:
        client: the agent's own connection to the simulator, in the agent's own process.
        world: the world of this run, in synchronous mode. BASU ticks it; an agent that ticks it fails.
        map: the map of the world.
        vehicle: the vehicle to drive. BASU applies the control that ``run_step`` returns; CARLA's frame: m, m/s, m/s²,
            degrees, x east, y south, z up, yaw clockwise from above.
        route: the planned route along the lanes, about one point a metre; None where the run has no route.
        config_values: the values of ``config``, completed with defaults and with the options of the command line.
        time_step_s: simulated time between two calls of ``run_step``, in s (0.05).
        server_address: host and port of the simulator, for an agent that opens a connection of its own.
        manual: whether a person drives at present. An agent with manual control keeps this value up to date.
        driven_by_person: whether a person drives from the start, without a window; true for the agent ``human``.
        gives_sensors_late: whether BASU calls ``sensors`` after ``setup`` instead of before; true for agents of the
            leaderboard and of ScenarioRunner.
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
    gives_sensors_late: bool = False  # ``sensors`` is called after ``setup``; for foreign agents
    _sight: Sight | None = None
    _sensor_ids: Mapping[str, int] = MappingProxyType({})  # actors, by the id in the sensor set

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
        """Set the attributes of the agent. BASU calls this once, before ``setup``; an agent does not override it."""
        self.client = client
        self.world = world
        self.map = map
        self.vehicle = vehicle
        self.route = route
        self.config_values = config_values
        self.time_step_s = time_step_s
        self.server_address = server_address

    def bind_sensors(self, actor_ids: Mapping[str, int]) -> None:
        """Set which actors the sensors are, by their ids in the set. BASU calls this; an agent does not override it."""
        self._sensor_ids = actor_ids

    @abstractmethod
    def setup(self) -> None:
        """Prepare to drive. BASU calls this once, before the first tick; all attributes have their values.

        It may take 120 s of wall time, for example to load a network. It may not change the weather, the vehicle or
        the settings of the world.
        """

    @abstractmethod
    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Return the control of the vehicle until the next tick. BASU calls this once a tick, every ``time_step_s``.

        Args:
            sensor_data: frame and measurement of each sensor, by the id of the sensor. A sensor without a new
                measurement in this tick still has its last one. A measurement is a ``carla.SensorData``, or a numpy
                array for a sensor with ``"data": "numpy"``.

        Returns:
            The control, with finite numbers. BASU ends the run, and keeps what it measured until then, if this method
            raises, returns anything else or takes longer than the time limit of a step (10 s; ``--step-limit``).
        """

    @abstractmethod
    def config(self) -> Mapping[str, Any]:
        """Return the sensors and the track that the agent wants; called once, before there is a world.

        All keys are optional: ``sensors`` (sensor JSON), ``track`` (what it learns of others), and for ``basu run``
        alone ``routes`` (route XML), ``vehicle`` (blueprint id), ``weather`` (the name of one of CARLA's presets) and
        ``sumo`` (folder of a SUMO scenario). Options of the command line override these values. Campaigns and
        scenarios ignore the last four with a sentence, because the conditions are the benchmark's. BASU looks for a
        file in the working folder, then beside the agent's file, then among its own files. A route file that is not
        among BASU's own is the agent's own route: its result is marked as not comparable.
        """

    def sensors(self) -> Sequence[Mapping[str, Any]] | None:
        """Return a sensor set, as leaderboard agents do; None, as here, takes the sensor file of ``config``.

        Each sensor is a dict, as an entry of the file: ``{"type": "sensor.camera.rgb", "id": "FRONT", "x": 1.5,
        "z": 2.4, "width": 800, "height": 600, "fov": 90}``. Positions are in m and angles in degrees, in the frame of
        the vehicle.
        """
        return None

    def get_initial_route_locations(self) -> Sequence[carla.Location] | None:
        """Return the points of a route, which BASU joins along the lanes; None, as here, takes the route file.

        Points are locations, transforms, way points, ``(x, y, z)`` in m, or pairs of these with a ``RoadOption``. The
        result of such a drive says that the route was the agent's own, and is marked as not comparable. Campaigns and
        scenarios do not call this method.
        """
        return None

    def visible_actors(self) -> list[Other]:
        """Return the vehicles, walkers and props that the vehicle sees now or saw up to 2 s ago; call it once a tick.

        BASU's own agents know the same of other actors: within 80 m, with a line of sight from the roof free of
        houses, trees, parked cars and other actors, within the range of light and weather. Each is a
        :class:`basu.agents.sight.Other` with its box's centre, heading, velocity and size in CARLA's world frame (m,
        rad, m/s; x east, y south, yaw clockwise). ``unseen_s`` is 0, or the time since it was last seen; its place is
        extrapolated since then. For another radius, hold a :class:`basu.agents.sight.Sight` of your own.
        """
        if self._sight is None:
            self._sight = Sight(self.world, self.vehicle)
        return self._sight.others()

    def send(self, sensor_id: str, text: str) -> None:
        """Send a text by a radio of the agent's sensor set, a ``sensor.other.v2x_custom``; call it in ``run_step``.

        Other radios of that kind receive it in the next tick, if its power suffices on the way: a
        ``carla.CustomV2XEvent`` in their ``sensor_data``.

        Args:
            sensor_id: the id of the radio in the sensor set.
            text: at most 99 bytes of UTF-8, none of them 0, which is what CARLA's messages hold.

        Raises:
            ValueError: the set has no such radio, or the text does not fit.
        """
        size = len(text.encode())
        if size > LONGEST_TEXT_BYTES or "\0" in text:
            raise ValueError(f"a text of {size} bytes cannot be sent: it has at most {LONGEST_TEXT_BYTES}, and no zero")
        actor = self.world.get_actor(self._sensor_ids.get(sensor_id, 0))
        if actor is None or actor.type_id != TEXT_RADIO:
            raise ValueError(
                f"the sensor set has no {TEXT_RADIO} with the id '{sensor_id}', so nothing can be sent by it"
            )
        actor.send(text)
        self.world.get_weather()  # answered after the text has arrived, which the client does not wait for by itself

    def destroy(self) -> None:  # noqa: B027 - most agents have nothing to put away
        """Release what ``setup`` opened: files, windows, processes. BASU calls this once, however the run ends."""


class AddressedAgent(AutonomousAgent):
    """An agent of a plugin that drives by software at an address, which stands behind its name: ``NAME:ADDRESS``.

    Attributes:
        address: where the software is; the class has the one that an agent without an address takes.
    """

    address: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentConfig:
    """An agent's wishes; file names as given, looked for later."""

    routes: str = "routes/linden_leap.xml"
    sensors: str | None = None
    sumo: str | None = None
    track: str = WORLD
    vehicle: str = "vehicle.easymile.ez10"
    weather: str = "ClearNoon"

    def without_conditions(self) -> AgentConfig:
        """Return the wishes that an agent may have in a benchmark: its sensors and its track."""
        return AgentConfig(sensors=self.sensors, track=self.track)

    def conditions_asked(self) -> dict[str, str]:
        """Return the route file, vehicle, weather and SUMO folder that differ from the defaults, by key."""
        usual = self.without_conditions()
        return {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if getattr(self, field.name) != getattr(usual, field.name)
        }


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
    if given.get("track") not in (None, *TRACKS):
        raise UserError(f"config() of {agent}: 'track' is {given['track']!r}; it must be one of {', '.join(TRACKS)}")
    return AgentConfig(**{key: value for key, value in given.items() if value is not None})
