"""What is done in one frame: to the weather, the road, lights, doors and actors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions.composition import Action
from basu.scenarios.stage import Door, Pose

if TYPE_CHECKING:
    from collections.abc import Mapping


class SetWeather(Action):
    """Change fields of the weather, those of ``carla.WeatherParameters``."""

    def __init__(self, **values: float) -> None:
        super().__init__("weather: " + ", ".join(f"{name} {value:g}" for name, value in values.items()))
        self.values: Mapping[str, float] = values

    def act(self) -> str | None:
        """Once."""
        self.stage.set_weather(self.values)
        return "set"


class SetFriction(Action):
    """Make the road slippery around a place."""

    def __init__(self, pose: Pose, radius_m: float, friction: float) -> None:
        super().__init__(f"friction {friction:g} within {radius_m:g} m")
        self.pose, self.radius_m, self.friction = pose, radius_m, friction

    def act(self) -> str | None:
        """Once."""
        self.stage.set_friction(self.pose, self.radius_m, self.friction)
        return f"around ({self.pose.x_m:.1f}, {self.pose.y_m:.1f})"


class SetLight(Action):
    """Let a traffic light show a colour and stay so; the id is the OpenDRIVE signal's."""

    def __init__(self, landmark_id: str, state: str) -> None:
        super().__init__(f"light {landmark_id} shows {state}")
        self.landmark_id, self.state = landmark_id, state

    def act(self) -> str | None:
        """Once."""
        self.stage.set_light(self.landmark_id, self.state)
        return f"{self.state} after {self.stage.time_s:.1f} s"


class OpenDoor(Action):
    """Open a vehicle's door, by default the one towards the street of who is parked on the right."""

    def __init__(self, actor: str, door: Door = Door.FRONT_LEFT) -> None:
        super().__init__(f"{actor} opens its {door.name.lower().replace('_', ' ')} door")
        self.actor, self.door = actor, door

    def act(self) -> str | None:
        """Once."""
        self.stage.open_door(self.actor, self.door)
        return f"open after {self.stage.time_s:.1f} s"


class CloseDoor(Action):
    """Close it."""

    def __init__(self, actor: str, door: Door = Door.FRONT_LEFT) -> None:
        super().__init__(f"{actor} closes its {door.name.lower().replace('_', ' ')} door")
        self.actor, self.door = actor, door

    def act(self) -> str | None:
        """Once."""
        self.stage.close_door(self.actor, self.door)
        return f"closed after {self.stage.time_s:.1f} s"


class PutAt(Action):
    """Put an actor elsewhere, at rest."""

    def __init__(self, actor: str, pose: Pose) -> None:
        super().__init__(f"{actor} is put elsewhere")
        self.actor, self.pose = actor, pose

    def act(self) -> str | None:
        """Once."""
        self.stage.put(self.actor, self.pose)
        return f"at ({self.pose.x_m:.1f}, {self.pose.y_m:.1f})"


class Remove(Action):
    """Take an actor out of the world."""

    def __init__(self, actor: str) -> None:
        super().__init__(f"{actor} leaves the world")
        self.actor = actor

    def act(self) -> str | None:
        """Once."""
        self.stage.remove(self.actor)
        return f"gone after {self.stage.time_s:.1f} s"


class LetGo(Action):
    """Lead a vehicle no more; it rolls as its own physics has it."""

    def __init__(self, actor: str) -> None:
        super().__init__(f"{actor} is let go")
        self.actor = actor

    def act(self) -> str | None:
        """Once."""
        speed_mps = self.stage.body(self.actor).speed_mps
        self.stage.let_go(self.actor)
        return f"at {speed_mps:.1f} m/s"
