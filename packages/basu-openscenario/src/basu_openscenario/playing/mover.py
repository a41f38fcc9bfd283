"""`Mover`: an entity on its way: its place, its motion, and what has moved it in this step."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from basu_openscenario.roads.place import wrapped

if TYPE_CHECKING:
    from basu_openscenario.playing.curves import Curve
    from basu_openscenario.reading.entities import Controller, Entity
    from basu_openscenario.roads.place import Place

STAND_STILL_MPS = 1e-3
"""An entity that is slower stands still."""


@dataclass(slots=True)
class Follower:
    """A trajectory that a mover follows, and how far it is along it; m."""

    curve: Curve
    s_m: float = 0.0


class Given(NamedTuple):
    """A motion that is not the scenario's own: m, rad and m/s in OpenDRIVE's axes."""

    x_m: float
    y_m: float
    h_rad: float
    vx_mps: float
    vy_mps: float


@dataclass(slots=True)
class Mover:
    """An entity with its state. ``speed_mps`` is along its heading, negative backwards."""

    entity: Entity
    place: Place
    speed_mps: float = 0.0
    velocity_mps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    acceleration_mps2: tuple[float, float, float] = (0.0, 0.0, 0.0)
    travelled_m: float = 0.0
    is_there: bool = True
    follower: Follower | None = None
    controllers: dict[str, Controller] = field(default_factory=dict)
    visibility: dict[str, bool] = field(default_factory=dict)
    lights: dict[str, str] = field(default_factory=dict)
    still_since_s: float | None = None
    end_since_s: float | None = None
    off_since_s: float | None = None
    moved_along: bool = False
    """Whether an action has moved it along its path in this step."""
    speed_is_set: bool = False
    """Whether its speed was set or used in this step, so that it does not follow from the motion."""
    teleported: bool = False
    given: Given | None = None
    """The motion by an agent; None where the scenario moves the entity."""
    before: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """x, y, z and heading at the end of the step before."""
    rear_m: tuple[float, float] | None = None
    """The rear axle of a vehicle with its reference point elsewhere; None: as its pose has it."""
    tow: Mover | None = None
    """The vehicle that tows this trailer; None for one that is not towed."""
    trailer: Mover | None = None
    """The trailer behind this vehicle; None for a vehicle without one."""

    def __post_init__(self) -> None:
        """Put the rear axle where the entity begins."""
        self.rear_m = self._rear_axle()

    def _rear_axle(self) -> tuple[float, float]:
        """Return where the rear axle is by the pose; m."""
        place, ahead_m = self.place, self.entity.ahead_m
        return place.x_m - ahead_m * math.cos(place.h_rad), place.y_m - ahead_m * math.sin(place.h_rad)

    def pull(self) -> None:
        """Let the rear axle follow a reference point that is not on it, so that the body turns as if it were towed."""
        if self.entity.ahead_m == 0.0 or self.given is not None:
            return
        place = self.place
        x_m, y_m = self.rear_m or self._rear_axle()
        self.turn_to(math.atan2(place.y_m - y_m, place.x_m - x_m))
        self.rear_m = self._rear_axle()

    @property
    def name(self) -> str:
        """The entity's name."""
        return self.entity.name

    def set_speed(self, speed_mps: float) -> None:
        """Set the speed along the heading."""
        self.speed_mps = speed_mps
        self.speed_is_set = True

    @property
    def forward_mps(self) -> float:
        """The component of the velocity along the heading."""
        return self.along(self.velocity_mps)[0]

    def along(self, vector: tuple[float, float, float]) -> tuple[float, float]:
        """Return the components of a vector of the world ahead and to the left of the entity."""
        cos, sin = math.cos(self.place.h_rad), math.sin(self.place.h_rad)
        return vector[0] * cos + vector[1] * sin, -vector[0] * sin + vector[1] * cos

    def remember(self) -> None:
        """Take the present pose as that of the step before."""
        place = self.place
        self.before = (place.x_m, place.y_m, place.z_m, place.h_rad)

    def follow(self, given: Given, step_s: float) -> None:
        """Take a motion that was given at the begin of a step: go on with its velocity, whatever actions ask for."""
        x_m, y_m = given.x_m + given.vx_mps * step_s, given.y_m + given.vy_mps * step_s
        self.given = given._replace(x_m=x_m, y_m=y_m)
        self.place.set_world(x_m, y_m, given.h_rad)
        along_mps = given.vx_mps * math.cos(given.h_rad) + given.vy_mps * math.sin(given.h_rad)
        self.set_speed(along_mps)
        self.before = (given.x_m, given.y_m, self.place.z_m, given.h_rad)
        self.teleported, self.moved_along = False, True

    def settle(self, step_s: float) -> None:
        """Derive velocity, acceleration and distance from the movement of a step, and begin the next one."""
        place, (x_m, y_m, z_m, _) = self.place, self.before
        dx, dy, dz = place.x_m - x_m, place.y_m - y_m, place.z_m - z_m
        old = self.velocity_mps
        if step_s <= 0.0 or self.teleported:
            cos, sin = math.cos(place.h_rad), math.sin(place.h_rad)
            self.velocity_mps = (self.speed_mps * cos, self.speed_mps * sin, 0.0)
        else:
            self.velocity_mps = (dx / step_s, dy / step_s, dz / step_s)
            if not self.speed_is_set:
                self.speed_mps = math.hypot(dx, dy) / step_s
        if step_s > 0.0:
            new = self.velocity_mps
            self.acceleration_mps2 = tuple((b - a) / step_s for a, b in zip(old, new, strict=True))  # type: ignore[assignment]
        if not self.teleported:
            self.travelled_m += math.hypot(dx, dy)
        self.moved_along = self.speed_is_set = self.teleported = False
        self.remember()

    def watch(self, time_s: float) -> None:
        """Note since when it stands still, is at the end of its road, or is beside all roads."""
        still = abs(self.speed_mps) < STAND_STILL_MPS
        self.still_since_s = (time_s if self.still_since_s is None else self.still_since_s) if still else None
        off = self.is_off_road
        self.off_since_s = (time_s if self.off_since_s is None else self.off_since_s) if off else None

    @property
    def is_off_road(self) -> bool:
        """Whether its reference point is beside all lanes of its road."""
        place = self.place
        if place.road is None:
            return True
        right, left = place.road.section(place.s_m).paved_edges_m(place.s_m)
        from_centre = place.t_m - place.road.lane_offset.value(place.s_m)
        return not right <= from_centre <= left

    def corners_m(self) -> list[tuple[float, float]]:
        """Return the corners of its box in the world, from the front left on to the left around; m."""
        box, place = self.entity.box, self.place
        cos, sin = math.cos(place.h_rad), math.sin(place.h_rad)
        half_l, half_w = box.length_m / 2.0, box.width_m / 2.0
        corners = []
        for along, aside in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
            u, v = box.centre_m[0] + along * half_l, box.centre_m[1] + aside * half_w
            corners.append((place.x_m + u * cos - v * sin, place.y_m + u * sin + v * cos))
        return corners

    def turn_to(self, h_rad: float) -> None:
        """Look in a direction of the world."""
        self.place.set_world(self.place.x_m, self.place.y_m, wrapped(h_rad), self.fixed_z_m)

    @property
    def fixed_z_m(self) -> float | None:
        """Its height where that does not follow the road."""
        return self.place.z_m if self.place.z_rel_m is None else None
