"""`BaseManager`; data of a run: `Run`, `Ego`, `Frame`, `DriverState`; `WorldChanges`: what was set last."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.records.history.numbering import Numbering
from basu.records.motion import VehicleMotion, motion_of

if TYPE_CHECKING:
    from pathlib import Path

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.gate import Gates
    from basu.managers.observations import Neighbours
    from basu.managers.person import Person
    from basu.records.history.sumo import SumoRecord
    from basu.routing import Route
    from basu.routing.weather import WeatherMark


@dataclass(slots=True)
class WorldChanges:
    """What the benchmark has set last in the world of one run. Managers write it and read it."""

    control: carla.VehicleControl | None = None  # that the vehicle was given for the coming step
    weather: carla.WeatherParameters | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What a run has once its vehicle stands at the beginning of its route."""

    client: carla.Client
    world: carla.World
    carla_map: carla.Map
    vehicle: carla.Vehicle
    route: Route
    config: AgentConfig
    step_s: float  # simulated time from tick to tick
    seed: int
    timeout_s: float  # of wall time to wait for the simulator
    folder: Path  # of the run; has another name until the run is over
    server_address: tuple[str, int] = ("127.0.0.1", 2000)
    gates: Gates | None = None  # between the simulator and agents with processes of their own
    weather: tuple[WeatherMark, ...] = ()  # along the route, where the route file gives it
    own_simulator: bool = False  # nothing but this run and its agent is connected to it
    neighbours: Neighbours | None = None  # other actors near the vehicle, shared by record and checks
    changes: WorldChanges = field(default_factory=WorldChanges)  # what the benchmark has set last
    numbering: Numbering = field(default_factory=Numbering)  # of other actors in the record


class Ego(VehicleMotion):
    """The motion of the vehicle under test in one frame."""

    __slots__ = ()

    @property
    def speed_mps(self) -> float:
        """Speed over ground."""
        return math.hypot(self.velocity_x_mps, self.velocity_y_mps, self.velocity_z_mps)


class Frame(NamedTuple):
    """One tick as all managers see it."""

    tick: int  # from 0 at the agent's first step
    server_frame: int
    snapshot: carla.WorldSnapshot
    ego: Ego


def ego_in(snapshot: carla.ActorSnapshot) -> Ego:
    """Read the vehicle's state out of its part of a world snapshot."""
    return Ego(*motion_of(snapshot))


@dataclass(slots=True)
class DriverState:
    """What drives: the last control, the agent's own answer, and whether a person gave the control.

    Before the first control, the brake is on.
    """

    control: carla.VehicleControl = field(default_factory=lambda: carla.VehicleControl(brake=1.0))
    requested: carla.VehicleControl = field(default_factory=lambda: carla.VehicleControl(brake=1.0))
    manual: bool = False
    person: Person | None = None


class BaseManager(ABC):
    """One concern of a run. The runner calls ``setup`` once, ``tick`` each frame, ``close`` once in every case."""

    @abstractmethod
    def setup(self, run: Run) -> None:
        """Get ready: the vehicle stands at the beginning of the route, nothing has moved yet."""

    @abstractmethod
    def tick(self, frame: Frame) -> None:
        """Do this concern's part of a frame."""

    @abstractmethod
    def close(self) -> None:
        """Give back what ``setup`` took; called after a failed ``setup`` too, and never raises for what was lost."""


class CoSimulation(BaseManager):
    """Another program's traffic in the world of a run. ``count`` says how many of its road users there were."""

    count: dict[str, int]

    @abstractmethod
    def record(self) -> SumoRecord | None:
        """Return its part of the record until now; None where it has not begun."""
