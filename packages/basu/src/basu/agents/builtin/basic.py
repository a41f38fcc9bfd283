"""The basic agent, which follows the route and keeps the rules of the road, and the human agent with it as relief.

This file joins the official client to ``driving`` and ``rules``, which decide and know nothing of it. The agent uses no
sensors and no clock: the same ticks give the same drive.

The human agent's driver decides in every step, as a driving instructor does. Its decision counts while the person does
not drive. ``basu_window.manual.inputs`` decides between the two.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.builtin.driving.controllers import HOLD_BRAKE
from basu.agents.builtin.driving.driver import Driver
from basu.agents.builtin.driving.task import make_task
from basu.agents.builtin.perception import SHUTTLE, Lights, read_facts, see_ego
from basu.agents.sight import RADIUS_M, Knowledge, Sight
from basu.errors import UserError
from basu.records.partners import Partner
from basu.routing import ControlKind

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.agents.builtin.driving.driver import DrivingCommand
    from basu.agents.builtin.perception import VehicleFacts
    from basu.agents.sight import Other
    from basu.routing import Route

PARTNER_OF_CONTROL = {
    ControlKind.STOP_SIGN: Partner.SIGN,
    ControlKind.YIELD_SIGN: Partner.SIGN,
    ControlKind.TRAFFIC_LIGHT: Partner.LIGHT,
}


class BasicAgent(AutonomousAgent):
    """A careful driver; from ``setup`` on, ``driver`` holds its plan and may be looked at."""

    sight_m = RADIUS_M  # others farther away than this do not matter to it
    knowledge = Knowledge.SEEN
    blind_to: frozenset[Partner] = frozenset()  # what it does not see, as a control driver
    cruise_mps = math.inf  # never faster than this, whatever vehicle and limits allow
    driver: Driver | None = None
    facts: VehicleFacts | None = None

    def setup(self) -> None:
        """Look up the lights on the way; the vehicle is read at the first step, when it stands where it starts."""
        if self.route is None:
            raise UserError(f"{type(self).__name__} follows a route and was given none; name one with --routes")
        self._sees = Sight(self.world, self.vehicle, self.sight_m, self.knowledge, self.blind_to)
        lights = [c.landmark_id for c in self.seen_route.controls if c.kind is ControlKind.TRAFFIC_LIGHT]
        self._lights = Lights(self.world, lights)

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Look, decide, act."""
        snapshot = self.world.get_snapshot()
        own = snapshot.find(self.vehicle.id)
        if own is None:
            return carla.VehicleControl(brake=HOLD_BRAKE)  # not in the world before its first tick
        if self.driver is None or self.facts is None:
            self.driver, self.facts = self._get_in(own.get_transform())
        ego = see_ego(snapshot, own, self.vehicle.get_control())
        command = self.driver.step(ego, self.others(snapshot, sensor_data), self._lights.shows)
        return _control(command, self.facts, ego.speed_mps)

    def others(self, snapshot: carla.WorldSnapshot, sensor_data: Mapping[str, tuple[int, Any]]) -> list[Other]:
        """Return the actors in sight, by which the driver decides; an agent with radios may add some."""
        del sensor_data
        return self._sees.others(snapshot)

    def config(self) -> dict[str, str]:
        """The shuttle on its round."""
        return {
            "routes": "routes/linden_leap.xml",
            "sensors": "config/sensors.json",
            "vehicle": SHUTTLE,
            "weather": "ClearNoon",
        }

    @property
    def seen_route(self) -> Route:
        """The route with the signs and lights that it sees."""
        assert self.route is not None  # setup refuses
        controls = tuple(c for c in self.route.controls if PARTNER_OF_CONTROL[c.kind] not in self.blind_to)
        return replace(self.route, controls=controls)

    def _get_in(self, pose: carla.Transform) -> tuple[Driver, VehicleFacts]:
        """Read the vehicle and plan its task."""
        facts = read_facts(self.vehicle, pose)
        task = make_task(self.seen_route, facts.body, min(self.cruise_mps, facts.top_mps))
        return Driver(task, facts.body, facts.model, self.time_step_s), facts


def _control(command: DrivingCommand, facts: VehicleFacts, speed_mps: float) -> carla.VehicleControl:
    """The decision in CARLA's terms."""
    return carla.VehicleControl(
        throttle=command.throttle,
        steer=facts.steering.command(command.steer_rad, speed_mps),
        brake=command.brake,
    )


TEST_RUNS = {
    "routes": "routes/linden_short.xml",
    "sensors": "config/sensors.json",
    "vehicle": "vehicle.tesla.model3",
    "weather": "ClearSunset",
}
"""The route, sensors, car and weather of the thesis's test runs."""


class HumanAgent(BasicAgent):
    """The driver while the person does not drive; BASU adds a person's input to agents of this class."""

    driven_by_person = True

    def config(self) -> dict[str, str]:
        """Return the route, sensors, car and weather of the thesis's test runs."""
        return dict(TEST_RUNS)
