"""Infractions with their penalties, incidents without a penalty, and the evidence of both."""

from __future__ import annotations

import enum
from collections import Counter
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.records.history import History


class Infraction(enum.Enum):
    """What enters the score: the kinds of section 5.2.1 of the thesis, and red lights, which its route has none of."""

    COLLISION_PEDESTRIAN = "collision_pedestrian"
    COLLISION_VEHICLE = "collision_vehicle"
    COLLISION_STATIC = "collision_static"
    RED_LIGHT = "red_light"
    STOP_SIGN = "stop_sign"
    SPEEDING = "speeding"


class Incident(enum.Enum):
    """What is reported and not scored."""

    OUTSIDE_LANES = "outside_lanes"
    WRONG_WAY = "wrong_way"
    ROUTE_DEVIATION = "route_deviation"
    DISENGAGEMENT = "disengagement"
    BLOCKED = "blocked"
    ROUTE_TIMEOUT = "route_timeout"


@dataclass(frozen=True, slots=True)
class OwnKind:
    """A kind of event that a user's metric finds."""

    value: str


# Factor on the infraction score for each occurrence: section 5.2.1 of the thesis, the collisions and the stop sign
# as in the CARLA leaderboard; so is the red light, for routes that have one.
DEFAULT_PENALTIES: Mapping[Infraction, float] = {
    Infraction.COLLISION_PEDESTRIAN: 0.50,
    Infraction.COLLISION_VEHICLE: 0.60,
    Infraction.COLLISION_STATIC: 0.65,
    Infraction.RED_LIGHT: 0.70,
    Infraction.STOP_SIGN: 0.80,
    Infraction.SPEEDING: 0.80,
}


class CollisionKind(enum.Enum):
    """The five types of nuPlan's ``CollisionType``."""

    STOPPED_EGO = "stopped_ego"
    STOPPED_OTHER = "stopped_other"
    REAR = "rear"
    FRONT = "front"
    LATERAL = "lateral"


@dataclass(frozen=True, slots=True, kw_only=True)
class Responsibility:
    """Whether the vehicle under test is at fault for one collision, and by which clause of the rule."""

    at_fault: bool
    kind: CollisionKind
    sentence: str

    def document(self) -> dict[str, bool | str]:
        """The responsibility as plain values."""
        return {"at_fault": self.at_fault, "kind": self.kind.value, "sentence": self.sentence}


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """One infraction or incident: time, place, speed, and the other party."""

    kind: Infraction | Incident | OwnKind
    tick: int
    t_s: float
    x_m: float  # of the vehicle under test, CARLA frame
    y_m: float
    z_m: float
    speed_mps: float
    route_s_m: float
    other: str | None  # the other party: blueprint id and actor id, or the sign
    detail: str  # a sentence with the figures
    responsibility: Responsibility | None = None  # of a collision, once a whole run is judged


def row_of(found: Evidence) -> dict[str, Any]:
    """One infraction or incident as plain values; only a collision has a responsibility."""
    row = {**asdict(found), "kind": found.kind.value}
    del row["responsibility"]
    return row if found.responsibility is None else {**row, "responsibility": found.responsibility.document()}


def evidence(
    history: History,
    kind: Infraction | Incident | OwnKind,
    tick: int,
    *,
    speed_mps: float,
    other: str | None,
    detail: str,
) -> Evidence:
    """The evidence for what happened in ``tick``, its place and time from the record."""
    frame = history.frames[tick]
    return Evidence(
        kind=kind,
        tick=tick,
        t_s=float(frame["t_s"]),
        x_m=float(frame["x_m"]),
        y_m=float(frame["y_m"]),
        z_m=float(frame["z_m"]),
        speed_mps=speed_mps,
        route_s_m=float(frame["route_s_m"]),
        other=other,
        detail=detail,
    )


def counts(found: tuple[Evidence, ...]) -> dict[Infraction, int]:
    """How often each kind of infraction occurred; kinds that did not are left out."""
    number = Counter(e.kind for e in found)
    return {kind: number[kind] for kind in Infraction if number[kind]}
