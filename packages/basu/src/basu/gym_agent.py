"""`GymAgent`: drives in a run as a policy that was trained in the gymnasium environment, by the same observations.

Without other road users the observations equal those of `basu.gym` to the last bit. An agent sees others as
`AutonomousAgent.visible_actors` has them, with a line of sight, whereas the environment shows all within 60 m.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.errors import UserError
from basu.gym_spaces import DriversView, control_from
from basu.managers.base_manager import ego_in
from basu.managers.observations import LaneFinder, vehicle_of
from basu.managers.routes_manager import moment_at
from basu.metrics.validity import PlannedLanes
from basu.routing.planned_route import Progress, advance

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import ArrayLike, NDArray


class GymAgent(AutonomousAgent):
    """An agent that acts on the observations of the gymnasium environment; a subclass has ``act`` and ``config``."""

    @abstractmethod
    def act(self, seen: dict[str, NDArray[np.float32]]) -> ArrayLike:
        """Return the action (2,) for an observation; `basu.gym` describes shapes and units of both."""

    def setup(self) -> None:
        """Begin at the beginning of the route.

        Raises:
            UserError: the run has no route.
        """
        if self.route is None:
            raise UserError(f"{type(self).__name__} follows a route and was given none; name one with --routes")
        self._view = DriversView(self.route, vehicle_of(self.vehicle))
        self._lanes, self._planned = LaneFinder(self.map), PlannedLanes(self.route)
        self._progress = Progress.at_start()

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Observe, and return the control of the action."""
        del sensor_data
        own = self.world.get_snapshot().find(self.vehicle.id)
        if own is None:
            return carla.VehicleControl(brake=1.0)  # not in the world before its first tick
        assert self.route is not None, "setup has checked it"
        ego = ego_in(own)
        self._progress = advance(self.route, self._progress, ego.x_m, ego.y_m)
        in_lane = self._planned.check(moment_at(ego, self._progress, self._lanes.under(ego)), None).in_lane
        limit_mps = self.vehicle.get_speed_limit() / 3.6
        others = [
            (other.x_m, other.y_m, other.z_m, other.yaw_rad, other.velocity_x_mps, other.velocity_y_mps)
            for other in self.visible_actors()
        ]
        return control_from(self.act(self._view.of(ego, self._progress, limit_mps, others, in_lane=in_lane)))
