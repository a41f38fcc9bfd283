"""The actions of a scenario as dataclasses; m, s, m/s and rad."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from basu_openscenario.reading.traffic import TrafficAction

if TYPE_CHECKING:
    from basu_openscenario.reading.entities import Controller
    from basu_openscenario.reading.positions import Position, RouteSpec, TrajectorySpec


@dataclass(frozen=True, slots=True)
class Dynamics:
    """How a value goes to its target: a shape, and a range in s or m, or a rate of change."""

    shape: str
    dimension: str
    value: float
    by_position: bool = True


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of a motion; None: those of the entity."""

    max_speed_mps: float | None = None
    max_acceleration_mps2: float | None = None
    max_deceleration_mps2: float | None = None
    max_acceleration_rate_mps3: float | None = None
    max_deceleration_rate_mps3: float | None = None


@dataclass(frozen=True, slots=True)
class SpeedTarget:
    """A speed: absolute, or ``delta`` or ``factor`` of an entity's."""

    value: float
    entity: str | None = None
    kind: str = "absolute"
    continuous: bool = False


@dataclass(frozen=True, slots=True)
class SpeedAction:
    """Change the speed."""

    dynamics: Dynamics
    target: SpeedTarget


@dataclass(frozen=True, slots=True)
class SpeedProfileAction:
    """Follow speeds over time: pairs of speed, and of time since the entry before, None where it is free."""

    entries: tuple[tuple[float, float | None], ...]
    entity: str | None
    follows: bool
    limits: Limits


@dataclass(frozen=True, slots=True)
class LongitudinalDistanceAction:
    """Keep a distance in m, or a time gap in s, to an entity along the road."""

    entity: str
    distance_m: float | None
    time_gap_s: float | None
    freespace: bool
    continuous: bool
    displacement: str
    system: str
    limits: Limits | None


@dataclass(frozen=True, slots=True)
class LaneTarget:
    """A lane: by number, or counted from an entity's; an offset in m by the same rule."""

    value: float
    entity: str | None = None


@dataclass(frozen=True, slots=True)
class LaneChangeAction:
    """Change the lane."""

    dynamics: Dynamics
    target: LaneTarget
    offset_m: float


@dataclass(frozen=True, slots=True)
class LaneOffsetAction:
    """Change the offset from the lane's middle."""

    shape: str
    max_lateral_acceleration_mps2: float | None
    target: LaneTarget
    continuous: bool


@dataclass(frozen=True, slots=True)
class LateralDistanceAction:
    """Keep a distance in m to the side of an entity."""

    entity: str
    distance_m: float | None
    freespace: bool
    continuous: bool
    displacement: str
    system: str
    limits: Limits | None


@dataclass(frozen=True, slots=True)
class TeleportAction:
    """Put the entity elsewhere at once."""

    position: Position


@dataclass(frozen=True, slots=True)
class FinalSpeed:
    """The speed at the end of a synchronisation, and the steady stretch before it: a time in s or a distance in m."""

    target: SpeedTarget
    steady: str = ""
    steady_value: float = 0.0
    steady_position: Position | None = None


@dataclass(frozen=True, slots=True)
class SynchronizeAction:
    """Arrive at a place at the time at which a master arrives at another."""

    master: str
    master_target: Position
    target: Position
    final: FinalSpeed | None
    master_tolerance_m: float
    tolerance_m: float


@dataclass(frozen=True, slots=True)
class AssignRouteAction:
    """Follow a route from now on."""

    route: RouteSpec


@dataclass(frozen=True, slots=True)
class AcquirePositionAction:
    """Go to a place by the shortest way."""

    position: Position


@dataclass(frozen=True, slots=True)
class FollowTrajectoryAction:
    """Follow a trajectory; ``timing`` is absolute, relative, or None where the speed decides."""

    trajectory: TrajectorySpec
    timing: str | None
    scale: float
    offset_s: float
    follows: bool
    start_m: float


@dataclass(frozen=True, slots=True)
class VisibilityAction:
    """Show or hide the entity: for pictures, sensors and traffic."""

    graphics: bool
    sensors: bool
    traffic: bool


@dataclass(frozen=True, slots=True)
class AssignControllerAction:
    """Give the entity a controller, and activate it per domain where the file says so; None: as it was."""

    controller: Controller
    lateral: bool | None
    longitudinal: bool | None


@dataclass(frozen=True, slots=True)
class ActivateControllerAction:
    """Activate or deactivate a controller per domain; None: as it was."""

    name: str | None
    lateral: bool | None
    longitudinal: bool | None


@dataclass(frozen=True, slots=True)
class LightStateAction:
    """Switch a light of the entity, over ``transition_s``; a flashing light goes on until another action ends it."""

    light: str
    mode: str
    transition_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ConnectTrailerAction:
    """Connect a trailer to the vehicle that the action is for."""

    entity: str


@dataclass(frozen=True, slots=True)
class DisconnectTrailerAction:
    """Let the entity go on without its trailer."""


PrivateAction = (
    SpeedAction
    | SpeedProfileAction
    | LongitudinalDistanceAction
    | LaneChangeAction
    | LaneOffsetAction
    | LateralDistanceAction
    | TeleportAction
    | SynchronizeAction
    | AssignRouteAction
    | AcquirePositionAction
    | FollowTrajectoryAction
    | VisibilityAction
    | AssignControllerAction
    | ActivateControllerAction
    | LightStateAction
    | ConnectTrailerAction
    | DisconnectTrailerAction
)


@dataclass(frozen=True, slots=True)
class EnvironmentAction:
    """Set the environment: elements and attributes of the file by name, kept for the record."""

    values: dict[str, str]


@dataclass(frozen=True, slots=True)
class AddEntityAction:
    """Bring an entity into the scenario."""

    entity: str
    position: Position


@dataclass(frozen=True, slots=True)
class DeleteEntityAction:
    """Take an entity out of the scenario."""

    entity: str


@dataclass(frozen=True, slots=True)
class SetVariableAction:
    """Set a variable or a parameter."""

    name: str
    value: str


@dataclass(frozen=True, slots=True)
class ModifyVariableAction:
    """Add a number to a variable or a parameter, or multiply it: ``add`` or ``multiply``."""

    name: str
    rule: str
    value: float


@dataclass(frozen=True, slots=True)
class TrafficSignalStateAction:
    """Let a signal show a state."""

    signal: str
    state: str


@dataclass(frozen=True, slots=True)
class TrafficSignalControllerAction:
    """Let a controller of signals begin a phase."""

    controller: str
    phase: str


GlobalAction = (
    EnvironmentAction
    | AddEntityAction
    | DeleteEntityAction
    | SetVariableAction
    | ModifyVariableAction
    | TrafficSignalStateAction
    | TrafficSignalControllerAction
    | TrafficAction
)
Action = PrivateAction | GlobalAction
