"""A case as its ``<scenario>`` element has it, not yet laid on a map."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from basu.scenarios.stage import Pose

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.routing.route_file import StopMark


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenActor:
    """An ``<ego_vehicle>`` or ``<other_actor>``."""

    role: str  # `rolename`; "hero" for the ego, "scenario" where another says nothing
    model: str  # a blueprint's id or pattern
    pose: Pose
    attributes: tuple[tuple[str, str], ...] = ()  # such as ("color", "255,0,0")
    speed_mps: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One instance of a scenario: who, where, with which values."""

    name: str  # its id, unique among all cases of a command
    type: str  # of the scenario
    town: str
    ego: GivenActor
    others: tuple[GivenActor, ...] = ()
    way: tuple[Pose, ...] = ()  # points of the ego's route after its place; the last is where it is bound for
    stops: tuple[StopMark, ...] = ()  # service stops on the way, where the ego is due
    trigger: Pose | None = None  # None: the ego's place
    weather: Mapping[str, float] | None = None  # fields of carla.WeatherParameters that the file gives; None: ClearNoon
    values: Mapping[str, str] = field(default_factory=dict)  # of its parameters, as text
    characteristics: Mapping[str, str] = field(
        default_factory=dict
    )  # stated in the file (`basu.scenarios.characteristics`)
    place: str = ""  # where it is, in words
    on_route: bool = False  # whether on the shuttle's route
    source: str = ""  # file and line, for sentences
