"""Actions on traffic as a file has them: sources, sinks, swarms, areas and their end; and which vehicles appear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from basu_openscenario.reading.entities import Controller, Entity
    from basu_openscenario.reading.positions import Position

MOST_VEHICLES = 200
"""Vehicles of traffic that a scenario may have at a time, of all its actions together."""
MOST_PER_S = 20.0
"""Vehicles that a source or a sink may bring or remove in a second."""
FARTHEST_M = 10_000.0
"""The largest radius, axis or offset of an action on traffic."""
FASTEST_MPS = 100.0
"""The largest speed of vehicles of traffic."""
MOST_ACTIONS = 100
"""Actions on traffic in a scenario."""
MOST_ENTRIES = 1000
"""Entries of a distribution, vertices of an area, and cursors of its roads."""


@dataclass(frozen=True, slots=True)
class TrafficMix:
    """Which vehicles appear. Each list has weights of any sum above zero; its choices are independent."""

    bodies: tuple[tuple[Entity, float], ...]
    """Vehicles without a name of their own."""
    roles: tuple[tuple[str, float], ...] = ()
    controllers: tuple[tuple[Controller, float], ...] = ()


@dataclass(frozen=True, slots=True)
class TrafficSourceAction:
    """Let vehicles appear around a position: ``rate_per_s`` of them in a second."""

    name: str
    line: str
    position: Position
    radius_m: float
    rate_per_s: float
    speed_mps: float | None
    mix: TrafficMix


@dataclass(frozen=True, slots=True)
class TrafficSinkAction:
    """Remove vehicles of traffic around a position: all of them, or ``rate_per_s`` in a second."""

    name: str
    line: str
    position: Position
    radius_m: float
    rate_per_s: float | None
    categories: frozenset[str] | None
    """The categories that are removed; None: all."""


@dataclass(frozen=True, slots=True)
class TrafficSwarmAction:
    """Keep up to ``count`` vehicles around an entity: inside an ellipse about it, and outside of an inner circle."""

    name: str
    line: str
    entity: str
    inner_radius_m: float
    semi_major_m: float
    """Half the axis of the ellipse along the entity's heading."""
    semi_minor_m: float
    offset_m: float
    """How far the middle of the ellipse is ahead of the entity."""
    count: int
    speeds_mps: tuple[float, float] | None
    directions: tuple[float, float] | None
    """The weights of vehicles in the entity's direction and against it; None: as the lanes are."""
    mix: TrafficMix


@dataclass(frozen=True, slots=True)
class RoadStretch:
    """Roads from one cursor to the next: ids, s in m (None: the end of the road), and the lanes that count."""

    roads: tuple[str, ...]
    s_m: tuple[float | None, ...]
    lanes: tuple[frozenset[int] | None, ...]
    length_m: float | None
    line: str


@dataclass(frozen=True, slots=True)
class TrafficAreaAction:
    """Let ``count`` vehicles appear in an area, once, or keep them there where ``is_continuous``."""

    name: str
    line: str
    count: int
    is_continuous: bool
    polygon: tuple[Position, ...]
    stretches: tuple[RoadStretch, ...]
    mix: TrafficMix


@dataclass(frozen=True, slots=True)
class TrafficStopAction:
    """End the actions on traffic of a name; without a name, all of them."""

    name: str
    line: str


TrafficAction = TrafficSourceAction | TrafficSinkAction | TrafficSwarmAction | TrafficAreaAction | TrafficStopAction
