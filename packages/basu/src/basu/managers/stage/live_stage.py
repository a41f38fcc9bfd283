"""The ``Stage`` of a scenario in a live simulator."""

from __future__ import annotations

import contextlib
import math
import random
from typing import TYPE_CHECKING, Any

import carla

from basu.errors import ScenarioError
from basu.managers.stage.environment import Surroundings
from basu.managers.stage.scenario_actors import ActorCommands, destroy_actors, member_of, spawn_actors
from basu.scenarios.criteria.criterion import Move, StandingThing
from basu.scenarios.stage import EGO, ActorBox
from basu.thresholds import is_rolled_over

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from basu.managers.base_manager import Frame, Run
    from basu.managers.metrics_manager import MetricsManager
    from basu.managers.routes_manager import RoutesManager
    from basu.managers.stage.environment import SharedWorld
    from basu.managers.stage.scenario_actors import Member
    from basu.routing import Route
    from basu.scenarios.stage import ActorSpec, Controls, Door, Pose

# A contact comes on a thread of the client's, in its frame or soon after: each is known exactly so many frames later.
HEARD_TICKS = 3
LOOK_BACK_TICKS = 12


class LiveStage:
    """See ``basu.scenarios.stage.Stage``. ``look`` begins a frame, ``carry_out`` ends it, ``clear`` ends all."""

    def __init__(
        self, run: Run, routes: RoutesManager, metrics: MetricsManager, case: str, shared: SharedWorld, route: Route
    ) -> None:
        """Set it in a run; ``case`` is its name for messages, ``route`` the part of the run's that is its own."""
        self.step_s, self.route, self.carla_map = run.step_s, route, run.carla_map
        self.rng = random.Random(f"{run.seed} {case}")  # noqa: S311 - chance that can be had again
        self._run, self._routes, self._metrics, self._case = run, routes, metrics, case
        self._cast: dict[str, Member] = {EGO: member_of(run.vehicle, EGO)}
        self._roles: dict[int, str] = {}  # of all actors that were ever in the cast
        self._types: dict[int, str] = {}
        self._commands = ActorCommands(run.client)
        self._surroundings = Surroundings(run.client, run.world, shared, case)
        self._changes: dict[str, Callable[[Controls], Controls]] = {}
        self._bodies: dict[str, ActorBox] = {}
        self._frame: Frame | None = None
        self._began_tick = 0
        self._moves: list[Move] = []
        self._touched: frozenset[str] = frozenset()

    @property
    def roles(self) -> Mapping[int, str]:
        """The roles of all actors that were ever in the cast, by their number in the record."""
        return {self._run.numbering.of(actor_id): role for actor_id, role in self._roles.items()}

    @property
    def types(self) -> Mapping[int, str]:
        """Their blueprints' ids, likewise."""
        return {self._run.numbering.of(actor_id): type_id for actor_id, type_id in self._types.items()}

    def enter(self, specs: Sequence[ActorSpec]) -> None:
        """Bring a part of the cast into the world; no actor moves yet, and vehicles are held by their brakes.

        Raises:
            ScenarioError: an actor cannot be spawned.
        """
        self._spawn(specs)
        self._commands.carry_out()

    def _spawn(self, specs: Sequence[ActorSpec]) -> None:
        """Spawn actors; vehicles are commanded to stand."""
        for member, spec in zip(spawn_actors(self._run.client, self._run.world, specs, self._case), specs, strict=True):
            self._cast[spec.name] = member
            self._roles[member.actor.id], self._types[member.actor.id] = spec.name, member.actor.type_id
            if member.kind == "vehicle":
                self.move(spec.name, 0.0, 0.0, 0.0)

    def set_off(self, specs: Sequence[ActorSpec]) -> None:
        """Set off the actors that begin in motion."""
        for spec in specs:
            self._set_off(spec)
        self._commands.carry_out()

    def _set_off(self, spec: ActorSpec) -> None:
        """Command the speed with which an actor begins."""
        if spec.speed_mps:
            yaw_rad, speed_mps, kind = spec.pose.yaw_rad, spec.speed_mps, self._member(spec.name).kind
            if kind == "vehicle":
                self.move(spec.name, speed_mps * math.cos(yaw_rad), speed_mps * math.sin(yaw_rad), 0.0)
            elif kind == "walker":
                self.walk(spec.name, speed_mps * math.cos(yaw_rad), speed_mps * math.sin(yaw_rad))

    def begin(self, tick: int) -> None:
        """Let the scenario's clock begin."""
        self._began_tick = tick

    def look(self, frame: Frame) -> None:
        """Take in a frame."""
        self._frame = frame
        self._bodies.clear()
        new = {
            self._roles.get(contact.other_id, contact.other_type)
            for contact in self._metrics.contacts_since(max(self._began_tick, frame.tick - LOOK_BACK_TICKS))
            if contact.tick <= frame.tick - HEARD_TICKS
        }
        if new:
            self._touched |= new

    def carry_out(self) -> None:
        """Send this frame's commands."""
        self._commands.carry_out()

    def clear(self) -> None:
        """Leave the world as it was before."""
        self._changes.clear()
        self._surroundings.give_back()
        actors = [member.actor for name, member in self._cast.items() if name != EGO]
        destroy_actors(self._run.client, actors)
        self._cast = {EGO: self._cast[EGO]}
        self._commands.forget()

    def through(self, controls: Controls) -> Controls:
        """The ego's controls after every disturbance, in the order in which they began."""
        for change in self._changes.values():
            controls = change(controls)
        return controls

    def things(self) -> tuple[StandingThing, ...]:
        """Those of the cast that are neither vehicle nor walker."""
        members = [member for member in self._cast.values() if member.kind == "static"]
        bodies = [(member, self.body(member.name)) for member in members]
        return tuple(
            StandingThing(
                member.name,
                body.x_m,
                body.y_m,
                body.yaw_rad,
                body.half_length_m,
                body.half_width_m,
                rolled_over=is_rolled_over(member.height_m),
            )
            for member, body in bodies
        )

    @property
    def moves(self) -> tuple[Move, ...]:
        """The actors that were moved or removed, and when on the record's clock."""
        return tuple(self._moves)

    # what a tree may ask ------------------------------------------------------------------------------------------

    @property
    def time_s(self) -> float:
        """Simulated time since the scenario began."""
        return (self._now.tick - self._began_tick) * self.step_s

    @property
    def ego(self) -> ActorBox:
        """The vehicle under test."""
        return self.body(EGO)

    @property
    def ego_s_m(self) -> float:
        """How far along its route the ego's origin is."""
        return self._routes.progress.s_m

    @property
    def ego_contacts(self) -> frozenset[str]:
        """The actors that the ego has touched since the scenario began."""
        return self._touched

    def body(self, name: str) -> ActorBox:
        """An actor of the cast in this frame."""
        if name not in self._bodies:
            self._bodies[name] = self._seen(self._member(name))
        return self._bodies[name]

    def is_there(self, name: str) -> bool:
        """Whether an actor is in the world."""
        return name in self._cast

    # what a tree may do -------------------------------------------------------------------------------------------

    def move(self, name: str, velocity_x_mps: float, velocity_y_mps: float, yaw_rate_radps: float) -> None:
        """Let a vehicle have this velocity and turning until the next command."""
        self._commands.move(self._kind(name, "vehicle"), velocity_x_mps, velocity_y_mps, yaw_rate_radps)

    def walk(self, name: str, velocity_x_mps: float, velocity_y_mps: float) -> None:
        """Let a walker go."""
        self._commands.walk(self._kind(name, "walker"), velocity_x_mps, velocity_y_mps)

    def put(self, name: str, pose: Pose) -> None:
        """Put an actor elsewhere, at rest."""
        member = self._member(name)
        rotation = carla.Rotation(yaw=math.degrees(pose.yaw_rad))
        member.actor.set_transform(carla.Transform(carla.Location(pose.x_m, pose.y_m, pose.z_m), rotation))
        self._moves.append(Move(name, self._next_s, pose))

    def let_go(self, name: str) -> None:
        """Lead it no more."""
        self._commands.let_go(self._member(name))

    def add(self, spec: ActorSpec) -> None:
        """Bring a further actor into the world, with its speed."""
        if spec.name in self._cast:
            raise ScenarioError(f"{self._case} has two actors called '{spec.name}'; give each its own role")
        self._spawn([spec])
        self._set_off(spec)

    def remove(self, name: str) -> None:
        """Take an actor out of the world."""
        member = self._member(name)
        self._commands.let_go(member)
        destroy_actors(self._run.client, [self._cast.pop(name).actor])
        self._moves.append(Move(name, self._next_s, None))
        self._bodies.pop(name, None)

    def open_door(self, name: str, door: Door) -> None:
        """Open a vehicle's door."""
        self._kind(name, "vehicle").actor.open_door(carla.VehicleDoor.values[int(door)])

    def close_door(self, name: str, door: Door) -> None:
        """Close it."""
        self._kind(name, "vehicle").actor.close_door(carla.VehicleDoor.values[int(door)])

    def set_weather(self, values: Mapping[str, float]) -> None:
        """Change fields of the weather."""
        self._surroundings.set_weather(values)

    def set_friction(self, pose: Pose, radius_m: float, friction: float) -> None:
        """Make the road slippery around a place."""
        self._surroundings.set_friction(pose, radius_m, friction)

    def set_light(self, landmark_id: str, state: str) -> None:
        """Let a traffic light show a state and stay so."""
        self._surroundings.set_light(landmark_id, state)

    def disturb(self, key: str, change: Callable[[Controls], Controls] | None) -> None:
        """Change the ego's controls on their way to the vehicle until ``None`` ends it."""
        self._changes.pop(key, None)
        if change is not None:
            self._changes[key] = change

    @property
    def _next_s(self) -> float:
        """When this frame's commands have come true, on the record's clock."""
        return (self._now.tick + 1) * self.step_s

    @property
    def _now(self) -> Frame:
        assert self._frame is not None, "look comes first"
        return self._frame

    def _member(self, name: str) -> Member:
        try:
            return self._cast[name]
        except KeyError:
            there = ", ".join(self._cast)
            raise ScenarioError(
                f"{self._case} speaks of '{name}', and no actor has this name; there are {there}"
            ) from None

    def _kind(self, name: str, kind: str) -> Member:
        member = self._member(name)
        if member.kind != kind:
            raise ScenarioError(f"{self._case} leads '{name}' as a {kind}; it is a {member.actor.type_id}")
        return member

    def _seen(self, member: Member) -> ActorBox:
        """A member in this frame; before the first, where it was put."""
        seen: Any = self._now.snapshot.find(member.actor.id)
        source = member.actor if seen is None else seen
        with contextlib.suppress(RuntimeError):
            pose, velocity = source.get_transform(), source.get_velocity()
            yaw_rad = math.radians(pose.rotation.yaw)
            return ActorBox(
                pose.location.x + member.box_x_m * math.cos(yaw_rad),
                pose.location.y + member.box_x_m * math.sin(yaw_rad),
                pose.location.z,
                yaw_rad,
                velocity.x,
                velocity.y,
                member.half_length_m,
                member.half_width_m,
            )
        raise ScenarioError(f"{self._case}: '{member.name}' is gone from the world")
