"""A place and a ``Stage`` without a simulator: bodies move exactly as commanded, the ego along its route."""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import ScenarioError
from basu.metrics.boxes import boxes, touching
from basu.routing import Route
from basu.scenarios.paths import Path
from basu.scenarios.place import Place
from basu.scenarios.stage import EGO, ActorBox, Controls, Door, Pose

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from basu.scenarios.stage import ActorSpec


def offline_place(
    points: Sequence[Sequence[float]],
    *,
    trigger_s_m: float = 0.0,
    lane_width_m: float = 3.5,
    junctions_m: Sequence[tuple[float, float]] = (),
) -> Place:
    """The ego's route through points (x, y), sampled each metre, with junctions from and to so far along it.

    Nothing that asks the map can be had there: ``place.carla_map`` is None.
    """
    path = Path.through(points)
    s_m = np.unique(np.append(np.arange(0.0, path.length_m, 1.0), path.length_m))
    poses = np.array([path.at(float(s)) for s in s_m])
    is_junction = np.zeros(len(s_m), dtype=np.bool_)
    for from_m, to_m in junctions_m:
        is_junction |= (s_m >= from_m) & (s_m <= to_m)
    route = Route(
        id="offline",
        town="offline",
        points_m=poses[:, :3],
        s_m=s_m,
        yaw_rad=poses[:, 3],
        lane_width_m=np.full(len(s_m), lane_width_m),
        speed_limit_mps=np.full(len(s_m), np.nan),
        is_junction=is_junction,
        road_id=np.zeros(len(s_m), dtype=np.int64),
        lane_id=np.full(len(s_m), -1, dtype=np.int64),
    )
    return Place(route=route, trigger_s_m=trigger_s_m, carla_map=None)


HELD_MPS2, ROLLING_MPS2 = 8.0, 0.5  # deceleration of a braked and of a rolling body
# half length and half width in m where a blueprint's id begins so; the first that fits. Rounded from CARLA's boxes.
SIZES_M: tuple[tuple[str, float, float], ...] = (
    ("walker.animal.deer", 0.85, 0.23),
    ("walker.animal.dog", 0.48, 0.13),
    ("walker.", 0.25, 0.25),
    ("static.prop.dirtdebris", 0.93, 0.75),
    ("static.", 0.5, 0.5),
    ("vehicle.easymile", 2.0, 1.0),
    ("vehicle.bh", 0.85, 0.3),
    ("vehicle.diamondback", 0.85, 0.3),
    ("vehicle.gazelle", 0.85, 0.3),
    ("vehicle.kawasaki", 1.05, 0.4),
    ("vehicle.yamaha", 1.05, 0.4),
    ("vehicle.harley", 1.2, 0.4),
    ("vehicle.vespa", 0.9, 0.35),
    ("vehicle.mitsubishi.fusorosa", 5.15, 1.95),
    ("vehicle.carlamotors", 3.0, 1.3),
    ("vehicle.mercedes.sprinter", 2.96, 1.0),
    ("", 2.3, 0.95),
)
ROLLED_OVER = ("static.prop.dirtdebris",)  # beginnings of blueprints that wheels roll over: 0.15 to 0.19 m high


class _Led(NamedTuple):
    """The command of a body until the next one."""

    velocity_x_mps: float
    velocity_y_mps: float
    yaw_rate_radps: float
    slows_mps2: float = 0.0  # of a braked or rolling body


class StageCommand(NamedTuple):
    """Something that was done to the world besides moving: for tests to ask about."""

    time_s: float
    what: str  # "weather", "friction", "light", "open door", "close door", "put", "remove", "disturb", "let go"
    details: tuple[object, ...]


class OfflineStage:
    """See ``basu.scenarios.stage.Stage``. ``advance`` carries a frame's commands out.

    ``rolled_over`` has the names of things that wheels roll over. The ego does not touch them.

    The ego keeps to its route whatever is done to its controls; ``controls`` says what they would be. With
    ``turn_share`` below 1 bodies turn by that share of their command, as a simulated vehicle's tyres let it.
    """

    def __init__(
        self,
        place: Place,
        cast: Sequence[ActorSpec],
        driver: Callable[[OfflineStage], float],
        *,
        seed: int = 0,
        step_s: float = 0.05,
        ego_half_m: tuple[float, float] = (2.0, 1.0),
        ego_speed_mps: float = 0.0,
        turn_share: float = 1.0,
    ) -> None:
        self.step_s, self.route, self.carla_map = step_s, place.route, place.carla_map
        self.rng = random.Random(seed)  # noqa: S311 - chance that can be had again
        self.commands: list[StageCommand] = []
        self._driver, self._turn_share = driver, turn_share
        self._way = Path.through(place.route.points_m)
        self._ticks, self._ego_s_m, self._ego_half_m = 0, 0.0, ego_half_m
        self._touched: frozenset[str] = frozenset()
        self._changes: dict[str, Callable[[Controls], Controls]] = {}
        self._bodies = {spec.name: _entering(spec) for spec in cast}
        self.rolled_over = frozenset(spec.name for spec in cast if spec.blueprint.startswith(ROLLED_OVER))
        self._led: dict[str, _Led] = {
            name: _Led(body.velocity_x_mps, body.velocity_y_mps, 0.0) for name, body in self._bodies.items()
        }
        self._bodies[EGO] = self._ego_body(ego_speed_mps)

    @property
    def time_s(self) -> float:
        """Since the rehearsal began."""
        return self._ticks * self.step_s

    @property
    def ego(self) -> ActorBox:
        """The vehicle under test."""
        return self._bodies[EGO]

    @property
    def ego_s_m(self) -> float:
        """Along its route."""
        return self._ego_s_m

    @property
    def ego_contacts(self) -> frozenset[str]:
        """The actors that the ego has touched."""
        return self._touched

    @property
    def names(self) -> tuple[str, ...]:
        """All bodies present, the ego last."""
        return tuple(self._bodies)

    def body(self, name: str) -> ActorBox:
        """A body in this frame."""
        try:
            return self._bodies[name]
        except KeyError:
            raise ScenarioError(
                f"no actor on the stage is called '{name}'; there are {', '.join(self._bodies)}"
            ) from None

    def is_there(self, name: str) -> bool:
        """Whether an actor is on the stage."""
        return name in self._bodies

    def move(self, name: str, velocity_x_mps: float, velocity_y_mps: float, yaw_rate_radps: float) -> None:
        """Lead a vehicle; all zero holds it."""
        still = velocity_x_mps == velocity_y_mps == yaw_rate_radps == 0.0
        body = self.body(name)
        self._led[name] = (
            _Led(body.velocity_x_mps, body.velocity_y_mps, 0.0, HELD_MPS2)
            if still
            else _Led(velocity_x_mps, velocity_y_mps, yaw_rate_radps)
        )

    def walk(self, name: str, velocity_x_mps: float, velocity_y_mps: float) -> None:
        """Command a walker; it faces its direction of travel."""
        body = self.body(name)
        if velocity_x_mps or velocity_y_mps:
            self._bodies[name] = body._replace(yaw_rad=math.atan2(velocity_y_mps, velocity_x_mps))
        self._led[name] = _Led(velocity_x_mps, velocity_y_mps, 0.0)

    def put(self, name: str, pose: Pose) -> None:
        """Move an actor to another place, at rest."""
        self._bodies[name] = self.body(name)._replace(
            x_m=pose.x_m, y_m=pose.y_m, z_m=pose.z_m, yaw_rad=pose.yaw_rad, velocity_x_mps=0.0, velocity_y_mps=0.0
        )
        self._led[name] = _Led(0.0, 0.0, 0.0)
        self._note("put", name, pose)

    def let_go(self, name: str) -> None:
        """Let it roll out."""
        body = self.body(name)
        self._led[name] = _Led(body.velocity_x_mps, body.velocity_y_mps, 0.0, ROLLING_MPS2)
        self._note("let go", name)

    def add(self, spec: ActorSpec) -> None:
        """Bring a further actor onto the stage, with its speed."""
        if spec.name in self._bodies:
            raise ScenarioError(f"two actors are called '{spec.name}'; give each its own role")
        body = self._bodies[spec.name] = _entering(spec)
        self._led[spec.name] = _Led(body.velocity_x_mps, body.velocity_y_mps, 0.0)
        self._note("add", spec)

    def remove(self, name: str) -> None:
        """Remove an actor from the stage."""
        self.body(name)
        del self._bodies[name], self._led[name]
        self._note("remove", name)

    def open_door(self, name: str, door: Door) -> None:
        """Note it."""
        self.body(name)
        self._note("open door", name, door)

    def close_door(self, name: str, door: Door) -> None:
        """Note it."""
        self.body(name)
        self._note("close door", name, door)

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Note it."""
        self._note("weather", dict(values))

    def set_friction(self, pose: Pose, radius_m: float, friction: float) -> None:
        """Note it."""
        self._note("friction", pose, radius_m, friction)

    def set_light(self, landmark_id: str, state: str) -> None:
        """Note it."""
        self._note("light", landmark_id, state)

    def disturb(self, key: str, change: Callable[[Controls], Controls] | None) -> None:
        """Note it, and change what ``controls`` says."""
        self._changes.pop(key, None)
        if change is not None:
            self._changes[key] = change
        self._note("disturb", key, change is not None)

    def controls(self, meant: Controls) -> Controls:
        """What becomes of the ego's controls on their way to the vehicle in this frame."""
        for change in self._changes.values():
            meant = change(meant)
        return meant

    def advance(self) -> None:
        """The next frame: all bodies move as commanded, the ego as its driver says; contacts are recorded."""
        speed_mps = max(0.0, self._driver(self))
        for name, led in list(self._led.items()):
            self._bodies[name], self._led[name] = self._moved(self._bodies[name], led)
        self._ego_s_m = min(self._ego_s_m + speed_mps * self.step_s, self.route.length_m)
        self._bodies[EGO] = self._ego_body(speed_mps if self._ego_s_m < self.route.length_m else 0.0)
        self._ticks += 1
        self._touched |= {
            name for name in self._led if name not in self.rolled_over and self._touches(self._bodies[name])
        }

    def _moved(self, body: ActorBox, led: _Led) -> tuple[ActorBox, _Led]:
        """A body a frame later, and its command from then on."""
        speed_mps = math.hypot(led.velocity_x_mps, led.velocity_y_mps)
        if led.slows_mps2 and speed_mps:
            share = max(0.0, speed_mps - led.slows_mps2 * self.step_s) / speed_mps
            led = led._replace(velocity_x_mps=led.velocity_x_mps * share, velocity_y_mps=led.velocity_y_mps * share)
        turned_rad = led.yaw_rate_radps * self.step_s * self._turn_share
        return body._replace(
            x_m=body.x_m + led.velocity_x_mps * self.step_s,
            y_m=body.y_m + led.velocity_y_mps * self.step_s,
            yaw_rad=math.remainder(body.yaw_rad + turned_rad, math.tau),
            velocity_x_mps=led.velocity_x_mps,
            velocity_y_mps=led.velocity_y_mps,
        ), led

    def _ego_body(self, speed_mps: float) -> ActorBox:
        at = self._way.at(self._ego_s_m)
        return ActorBox(*at, speed_mps * math.cos(at.yaw_rad), speed_mps * math.sin(at.yaw_rad), *self._ego_half_m)

    def _touches(self, other: ActorBox) -> bool:
        reach_m = sum(body.half_length_m + body.half_width_m for body in (self.ego, other))
        if math.dist(self.ego[:2], other[:2]) > reach_m:
            return False
        ours, theirs = (
            boxes(
                np.array([body.x_m]),
                np.array([body.y_m]),
                np.array([body.yaw_rad]),
                np.array([[body.half_length_m, body.half_width_m]]),
            )
            for body in (self.ego, other)
        )
        return bool(touching(ours, theirs)[0])

    def _note(self, what: str, *details: object) -> None:
        self.commands.append(StageCommand(self.time_s, what, details))


def half_sizes_m(blueprint: str) -> tuple[float, float]:
    """Return half the length and half the width of the bodies of a blueprint, in m."""
    return next(size[1:] for size in SIZES_M if blueprint.startswith(size[0]))


def _entering(spec: ActorSpec) -> ActorBox:
    """An actor at its entrance."""
    half_m = half_sizes_m(spec.blueprint)
    yaw_rad = spec.pose.yaw_rad
    return ActorBox(*spec.pose, spec.speed_mps * math.cos(yaw_rad), spec.speed_mps * math.sin(yaw_rad), *half_m)
