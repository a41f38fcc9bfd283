"""Triggers on places: distances, regions and lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import touching
from basu.scenarios.stage import EGO
from basu.scenarios.triggers.motion import Trigger, named

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.paths import Path
    from basu.scenarios.stage import ActorBox, Pose


def _apart_m(one: ActorBox | Pose, other: ActorBox | Pose) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)


class Near(Trigger):
    """Two are nearer to each other than ``distance_m``, middle to middle."""

    def __init__(self, one: str, other: str, distance_m: float) -> None:
        super().__init__(f"{named(one)} within {distance_m:g} m of {named(other)}")
        self.one, self.other, self.distance_m = one, other, distance_m

    def has_come(self) -> str | None:
        """How near, once they are."""
        away_m = _apart_m(self.stage.body(self.one), self.stage.body(self.other))
        return f"{named(self.one)} at {away_m:.1f} m" if away_m <= self.distance_m else None


class EgoNear(Near):
    """The ego is nearer to an actor than ``distance_m``, middle to middle."""

    def __init__(self, actor: str, distance_m: float) -> None:
        super().__init__(EGO, actor, distance_m)


class EgoOver(Trigger):
    """The ego is over a thing: their boxes from above overlap."""

    def __init__(self, thing: str) -> None:
        super().__init__(f"ego is over {thing}")
        self.thing = thing

    def has_come(self) -> str | None:
        """Return a sentence with the ego's speed while the ego is over the thing."""
        ego, thing = self.stage.ego, self.stage.body(self.thing)
        is_over = bool(touching(_box(ego), _box(thing))[0])
        return f"ego over {self.thing} at {ego.speed_mps:.1f} m/s" if is_over else None


def _box(body: ActorBox) -> NDArray[np.float64]:
    """Return a body's box from above, (1, 5)."""
    return np.array([[body.x_m, body.y_m, body.yaw_rad, body.half_length_m, body.half_width_m]])


class NearPlace(Trigger):
    """An actor is nearer to a place than ``distance_m``."""

    def __init__(self, place: Pose, distance_m: float, *, actor: str = EGO, what: str = "") -> None:
        super().__init__(f"{named(actor)} within {distance_m:g} m of {what or f'({place.x_m:.0f}, {place.y_m:.0f})'}")
        self.place, self.distance_m, self.actor = place, distance_m, actor

    def has_come(self) -> str | None:
        """How near, once it is."""
        away_m = _apart_m(self.stage.body(self.actor), self.place)
        return f"{named(self.actor)} at {away_m:.1f} m" if away_m <= self.distance_m else None


class Circle(NamedTuple):
    """A region."""

    x_m: float
    y_m: float
    radius_m: float

    def holds(self, x_m: float, y_m: float) -> bool:
        """Whether a point lies in it."""
        return math.hypot(x_m - self.x_m, y_m - self.y_m) <= self.radius_m


class Polygon(NamedTuple):
    """A region by its corners, in order, either way round."""

    corners_m: tuple[tuple[float, float], ...]

    def holds(self, x_m: float, y_m: float) -> bool:
        """Whether a point lies in it: a ray from there crosses its edges an odd number of times."""
        corners_m = np.asarray(self.corners_m)
        following_m = np.roll(corners_m, -1, axis=0)
        straddles = (corners_m[:, 1] > y_m) != (following_m[:, 1] > y_m)
        edges, followed = corners_m[straddles], following_m[straddles]
        at_x_m = edges[:, 0] + (y_m - edges[:, 1]) * (followed[:, 0] - edges[:, 0]) / (followed[:, 1] - edges[:, 1])
        return bool(np.count_nonzero(at_x_m > x_m) % 2)


class Stretch(NamedTuple):
    """A region along a path, to both sides."""

    path: Path
    from_m: float
    to_m: float
    half_width_m: float = 2.0

    def holds(self, x_m: float, y_m: float) -> bool:
        """Whether a point lies in it."""
        near = self.path.nearest(x_m, y_m)
        return self.from_m <= near.s_m <= self.to_m and near.distance_m <= self.half_width_m


Region = Circle | Polygon | Stretch


class InRegion(Trigger):
    """An actor's middle is in a region."""

    def __init__(self, region: Region, *, actor: str = EGO, what: str = "the region") -> None:
        super().__init__(f"{named(actor)} in {what}")
        self.region, self.actor = region, actor

    def has_come(self) -> str | None:
        """Where, once it is."""
        body = self.stage.body(self.actor)
        return f"at ({body.x_m:.1f}, {body.y_m:.1f})" if self.region.holds(body.x_m, body.y_m) else None


class CrossesLine(Trigger):
    """An actor's front crosses a line through ``place``, square to its heading, in the direction of that heading."""

    def __init__(self, place: Pose, half_width_m: float = 3.0, *, actor: str = EGO, what: str = "the line") -> None:
        super().__init__(f"{named(actor)} crosses {what}")
        self.place, self.half_width_m, self.actor = place, half_width_m, actor

    def begin(self) -> None:
        """Nothing is known of the frame before."""
        self.was_m = math.inf

    def has_come(self) -> str | None:
        """How fast, once it has."""
        body, place = self.stage.body(self.actor), self.place
        dx_m = body.x_m + body.half_length_m * math.cos(body.yaw_rad) - place.x_m
        dy_m = body.y_m + body.half_length_m * math.sin(body.yaw_rad) - place.y_m
        beyond_m = dx_m * math.cos(place.yaw_rad) + dy_m * math.sin(place.yaw_rad)
        right_m = dy_m * math.cos(place.yaw_rad) - dx_m * math.sin(place.yaw_rad)
        was_m, self.was_m = self.was_m, beyond_m
        if was_m < 0.0 <= beyond_m and abs(right_m) <= self.half_width_m:
            return f"over it at {body.speed_mps:.1f} m/s"
        return None
