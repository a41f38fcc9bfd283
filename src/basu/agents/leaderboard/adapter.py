"""Drives an agent of the leaderboard or of ScenarioRunner as one of BASU's: the same calls, in the same order."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.leaderboard.feeds import Feeds
from basu.agents.leaderboard.foreign import Dialect, ForeignAgent
from basu.agents.leaderboard.global_plan import global_plan
from basu.agents.leaderboard.gps import Gps
from basu.agents.leaderboard.sensor_sets import SPEEDOMETER, translated
from basu.agents.sensor_data import as_array

if TYPE_CHECKING:
    from collections.abc import Mapping

VEHICLE = "vehicle.lincoln.mkz_2020"  # the leaderboard's


class LeaderboardAgent(AutonomousAgent):
    """One of theirs; :func:`adapted` makes the class for a given one."""

    foreign: ClassVar[ForeignAgent]
    conf_file: ClassVar[str]  # the text of --agent-config, "" without
    gives_sensors_late = True  # an agent may say what it wants to see only once it is set up, in its world

    _agent: Any = None
    _gps: Gps
    _feeds: Feeds | None = None
    _pseudo: Mapping[str, str]
    _opendrive: str

    def config(self) -> dict[str, str]:
        """The leaderboard's car; the route is the user's to choose."""
        return {"vehicle": VEHICLE}

    def setup(self) -> None:
        """Make the agent, and give it its plan and its file, in the order that it is used to."""
        assert self.route is not None  # a run of BASU's has one
        self._gps = Gps(self.map)
        plan = global_plan(self.route, self._gps)
        self._feeds = Feeds(self.client, self.world, self.vehicle, plan.world)
        agent_class, dialect = self.foreign
        if dialect is Dialect.LEADERBOARD_2:
            self._agent = agent_class(*self.server_address, 0)
            self._agent.set_global_plan(plan.gps, plan.world)
            self._agent.setup(self.conf_file)
        else:
            self._agent = agent_class(self.conf_file)
            self._agent.set_global_plan(plan.gps, plan.world)

    def sensors(self) -> list[Any]:
        """What the agent wants to see, without what is answered here."""
        given, source = self._agent.sensors(), f"sensors() of {self.foreign.agent_class.__name__}"
        entries, self._pseudo = translated(given, self.foreign.dialect, source)
        self._opendrive = self.map.to_opendrive()
        return entries

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """One step of the agent's, with its measurements in the leaderboard's form."""
        assert self._feeds is not None  # setup came first
        snapshot = self.world.get_snapshot()
        timestamp_s = self._feeds.tick(snapshot.timestamp)
        input_data = {name: (frame, self._measured(measured)) for name, (frame, measured) in sensor_data.items()}
        input_data |= {name: (snapshot.frame, self._answer(kind)) for name, kind in self._pseudo.items()}
        control = self._agent.run_step(input_data, timestamp_s)
        if isinstance(control, carla.VehicleControl):
            control.manual_gear_shift = False  # as the leaderboard's agents do in __call__
        return control

    def destroy(self) -> None:
        """Let the agent put its things away, and take the world from it."""
        agent, self._agent = self._agent, None
        try:
            if agent is not None:
                agent.destroy()
        finally:
            if self._feeds is not None:
                self._feeds.close()

    def _measured(self, measured: Any) -> Any:  # noqa: ANN401 - by its sensor
        """A measurement as the leaderboard gives it, positions in its degrees."""
        array = as_array(measured)
        return self._gps.measured(array) if isinstance(measured, carla.GnssMeasurement) else array

    def _answer(self, kind: str) -> dict[str, Any]:
        """What a sensor of the leaderboard's own measures: the speed ahead in m/s, or the map's text."""
        if kind != SPEEDOMETER:
            return {"opendrive": self._opendrive}
        velocity, turned = self.vehicle.get_velocity(), self.vehicle.get_transform().rotation
        pitch, yaw = math.radians(turned.pitch), math.radians(turned.yaw)
        level = math.cos(pitch)
        return {
            "speed": (velocity.x * math.cos(yaw) + velocity.y * math.sin(yaw)) * level + velocity.z * math.sin(pitch)
        }


def adapted(foreign: ForeignAgent, conf_file: str | None) -> type[LeaderboardAgent]:
    """A class of BASU's for one of theirs, called as theirs is."""
    members = {
        "foreign": foreign,
        "conf_file": conf_file or "",
        "__doc__": foreign.agent_class.__doc__,
        "__module__": __name__,
    }
    return type(foreign.agent_class.__name__, (LeaderboardAgent,), members)
