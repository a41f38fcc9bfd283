"""The interface between a scenario's tree and its world: bodies of a frame, commands; live or in ``basu.testing``.

World coordinates are CARLA's: x east, y south, z up, yaw clockwise from above; m, s, rad.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Mapping

    import carla

    from basu.routing import Route

EGO = "hero"  # the role of the vehicle under test


class Pose(NamedTuple):
    """A place and a heading."""

    x_m: float
    y_m: float
    z_m: float = 0.0
    yaw_rad: float = 0.0


class ActorBox(NamedTuple):
    """The box of an actor in this frame; the place is the box's middle."""

    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    velocity_x_mps: float
    velocity_y_mps: float
    half_length_m: float
    half_width_m: float

    @property
    def speed_mps(self) -> float:
        """Over ground."""
        return math.hypot(self.velocity_x_mps, self.velocity_y_mps)

    @property
    def forward_mps(self) -> float:
        """Along the heading; negative backwards."""
        return self.velocity_x_mps * math.cos(self.yaw_rad) + self.velocity_y_mps * math.sin(self.yaw_rad)


class ActorSpec(NamedTuple):
    """An actor of a scenario: a vehicle, a walker or a thing."""

    name: str  # its role, by which the tree speaks of it; unique in the scenario
    blueprint: str  # an id or a pattern such as `vehicle.*`: the first in alphabetical order is taken
    pose: Pose  # z is found from the road where `on_ground`
    on_ground: bool = True
    attributes: tuple[tuple[str, str], ...] = ()  # of the blueprint, such as ("color", "255,0,0")
    speed_mps: float = 0.0  # along its heading, from the first frame on
    stand_in: str = ""  # the blueprint to take where the simulator lacks the first: CARLA has no animals


class Controls(NamedTuple):
    """The commands to the ego's pedals and wheel, as ``carla.VehicleControl`` has it."""

    throttle: float
    steer: float
    brake: float


class Door(enum.IntEnum):
    """``carla.VehicleDoor``."""

    FRONT_LEFT = 0
    FRONT_RIGHT = 1
    REAR_LEFT = 2
    REAR_RIGHT = 3


class Stage(Protocol):
    """One frame of a scenario and the commands that are carried out before the next.

    A name is a role given by an ``ActorSpec``; a name without an actor raises ``ScenarioError``.
    """

    step_s: float
    route: Route  # the ego's
    carla_map: carla.Map
    rng: random.Random  # seeded for this case; the only source of chance

    @property
    def time_s(self) -> float:
        """Simulated time since the scenario began."""

    @property
    def ego(self) -> ActorBox:
        """The vehicle under test."""

    @property
    def ego_s_m(self) -> float:
        """How far along its route the ego's origin is."""

    @property
    def ego_contacts(self) -> frozenset[str]:
        """The actors that the ego has touched since the scenario began: roles, or blueprint ids without a role."""

    def body(self, name: str) -> ActorBox:
        """An actor of the scenario; ``EGO`` for the vehicle under test."""

    def is_there(self, name: str) -> bool:
        """Whether it is in the world: not any more once removed, and not yet where it comes later."""

    def move(self, name: str, velocity_x_mps: float, velocity_y_mps: float, yaw_rate_radps: float) -> None:
        """Let a vehicle have this velocity and turning until the next command; (0, 0, 0) holds it by its brakes."""

    def walk(self, name: str, velocity_x_mps: float, velocity_y_mps: float) -> None:
        """Let a walker go, likewise."""

    def put(self, name: str, pose: Pose) -> None:
        """Put an actor elsewhere, at rest."""

    def let_go(self, name: str) -> None:
        """Lead it no more: it rolls as its own physics has it."""

    def add(self, spec: ActorSpec) -> None:
        """Bring a further actor into the world, with its speed; other commands follow from the next frame on.

        Raises:
            ScenarioError: its name is taken, or there is no room for it.
        """

    def remove(self, name: str) -> None:
        """Take an actor out of the world."""

    def open_door(self, name: str, door: Door) -> None:
        """Open a vehicle's door."""

    def close_door(self, name: str, door: Door) -> None:
        """Close a vehicle's door."""

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Change fields of the weather; those not named stay."""

    def set_friction(self, pose: Pose, radius_m: float, friction: float) -> None:
        """Make the road slippery around a place: ``static.trigger.friction``."""

    def set_light(self, landmark_id: str, state: str) -> None:
        """Let a traffic light show "Red", "Yellow", "Green" or "Off" and stay so; the id is the OpenDRIVE signal's."""

    def disturb(self, key: str, change: Callable[[Controls], Controls] | None) -> None:
        """Change the ego's controls on their way to the vehicle until ``None`` ends it, by the name ``key``."""
