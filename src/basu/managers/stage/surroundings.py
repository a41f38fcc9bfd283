"""Weather, friction and lights that a scenario changes, and gives back."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla

from basu.managers.stage.cast import take_away

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.managers.stage.shared_world import SharedWorld
    from basu.scenarios.stage import Pose

TRIGGER_HEIGHT_M = 3.0  # of the box in which wheels feel the friction


class Surroundings:
    """Of one scenario, ``who``; weather and lights are shared with the others of its run."""

    def __init__(self, client: carla.Client, world: carla.World, shared: SharedWorld, who: str) -> None:
        self._client, self._world, self._shared, self._who = client, world, shared, who
        self._patches: list[carla.Actor] = []

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Change fields of the weather.

        Raises:
            ScenarioError: weather has no such field.
        """
        self._shared.ask_weather(self._who, values)

    def set_friction(self, pose: Pose, radius_m: float, friction: float) -> None:
        """Make a square of the road slippery, ``radius_m`` to each side."""
        blueprint = self._world.get_blueprint_library().find("static.trigger.friction")
        blueprint.set_attribute("friction", str(friction))
        for axis, half_m in (("x", radius_m), ("y", radius_m), ("z", TRIGGER_HEIGHT_M)):
            blueprint.set_attribute(f"extent_{axis}", str(100.0 * half_m))  # CARLA's boxes are in cm here
        place = carla.Transform(
            carla.Location(pose.x_m, pose.y_m, pose.z_m), carla.Rotation(yaw=math.degrees(pose.yaw_rad))
        )
        self._patches.append(self._world.spawn_actor(blueprint, place))
        self._shared.changes.frictions.add(friction)

    def set_light(self, landmark_id: str, state: str) -> None:
        """Let a traffic light show a state and stay so.

        Raises:
            ScenarioError: there is no such light or state.
        """
        self._shared.ask_light(self._who, landmark_id, state)

    def give_back(self) -> None:
        """Leave everything as it was; where the simulator is gone, so is all this."""
        take_away(self._client, self._patches)
        self._patches = []
        self._shared.give_back(self._who)
