"""What the driving agents read of their own vehicle and of the traffic lights."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.agents.builtin.rules.traffic_lights import Light
from basu.agents.builtin.scene import Ego

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla


def see_ego(snapshot: carla.WorldSnapshot, own: carla.ActorSnapshot, gear: int) -> Ego:
    """The driven vehicle of a snapshot, which does not tell its gear."""
    pose, velocity = own.get_transform(), own.get_velocity()
    yaw_rad = math.radians(pose.rotation.yaw)
    speed_mps = velocity.x * math.cos(yaw_rad) + velocity.y * math.sin(yaw_rad)
    return Ego(snapshot.timestamp.elapsed_seconds, pose.location.x, pose.location.y, yaw_rad, speed_mps, gear)


class Lights:
    """The traffic lights on the way, by the id of their OpenDRIVE signal."""

    def __init__(self, world: carla.World, landmark_ids: Iterable[str]) -> None:
        found = {landmark_id: world.get_traffic_light_from_opendrive_id(landmark_id) for landmark_id in landmark_ids}
        self._actors = {landmark_id: actor for landmark_id, actor in found.items() if actor is not None}

    def shows(self, landmark_id: str) -> Light:
        """What a light shows; one that the server does not have is dark."""
        actor = self._actors.get(landmark_id)
        return Light.DARK if actor is None else _LIGHT_OF_NAME.get(str(actor.get_state()), Light.DARK)


_LIGHT_OF_NAME = {"Green": Light.GREEN, "Yellow": Light.YELLOW, "Red": Light.RED}
