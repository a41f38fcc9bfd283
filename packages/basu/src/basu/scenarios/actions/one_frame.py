"""The base of actions, their composition, and actions of one frame: on weather, road, lights, doors, actors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from py_trees.common import ParallelPolicy, Status
from py_trees.composites import Parallel, Sequence

from basu.scenarios.stage import Door, Pose
from basu.scenarios.tree_node import Node

if TYPE_CHECKING:
    from collections.abc import Mapping

    from py_trees.behaviour import Behaviour


class Action(Node):
    """The base of all: ``begin`` once, ``act`` each frame until it says in words what is done, ``leave`` once."""

    def act(self) -> str | None:
        """Do what belongs to this frame; say what is done, in words with figures, or None until then."""
        raise NotImplementedError

    def leave(self, *, broken_off: bool) -> None:
        """What is handed back in the last frame; nothing for most."""

    def done(self) -> str | None:
        """Act."""
        return self.act()

    def terminate(self, new_status: Status) -> None:
        """Leave, once: done, or broken off by others."""
        super().terminate(new_status)
        if self.status == Status.RUNNING or new_status == Status.SUCCESS:
            self.leave(broken_off=new_status == Status.INVALID)


class Wait(Action):
    """Let some seconds go by."""

    def __init__(self, seconds: float) -> None:
        super().__init__(f"wait {seconds:.3g} s")
        self.seconds = seconds

    def begin(self) -> None:
        """Look at the clock."""
        self.until_s = self.stage.time_s + self.seconds

    def act(self) -> str | None:
        """When the time is over."""
        return f"{self.seconds:.3g} s over" if self.stage.time_s >= self.until_s - 1e-6 else None


class InTurn(Sequence):
    """One after another, each from the frame in which the one before it is done."""

    def __init__(self, *steps: Behaviour, name: str = "in turn") -> None:
        super().__init__(name, memory=True, children=list(steps))


class Together(Parallel):
    """All at once, until all are done."""

    def __init__(self, *parts: Behaviour, name: str = "together") -> None:
        super().__init__(name, ParallelPolicy.SuccessOnAll(synchronise=True), children=list(parts))


class Either(Parallel):
    """All at once, until one is done; the others are broken off."""

    def __init__(self, *parts: Behaviour, name: str = "whichever comes first") -> None:
        super().__init__(name, ParallelPolicy.SuccessOnOne(), children=list(parts))


class Meanwhile(Parallel):
    """All at once, until the first of them is done; the others are broken off then, or are done before."""

    def __init__(self, until: Behaviour, *others: Behaviour, name: str = "") -> None:
        super().__init__(
            name or f"until {until.name}",
            ParallelPolicy.SuccessOnSelected([until], synchronise=True),
            children=[until, *others],
        )


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
    """Open a vehicle's door, by default the street side of a car parked on the right."""

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
