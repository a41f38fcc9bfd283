"""A scenario's actors in a live simulator: spawned, commanded in one batch a frame, and destroyed.

A vehicle's velocity and turning are set in every frame, as ScenarioRunner's ``SimpleVehicleControl`` does it, so that
a scenario's timing is exact; it still stands on its wheels and takes part in collisions. Upwards it moves by itself.
"""

from __future__ import annotations

import contextlib
import difflib
import math
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.errors import ScenarioError
from basu.records.partners import ANIMALS
from basu.scenarios.stage import EGO

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from basu.scenarios.stage import ActorSpec, Pose


LOOK_FROM_M, LOOK_DOWN_M = 3.0, 12.0  # above a place, and from there down to its ground: under every roof
DROP_M = 0.05  # above the ground, so that no wheel begins inside of it
ADULT_M, CHILD_M = 0.93, 0.55  # half the height of CARLA's walkers
ROOFS_FROM_M = 60.0  # above every house of a town
INDOORS = frozenset({carla.CityObjectLabel.Buildings})


class Member(NamedTuple):
    """An actor of the cast, and what does not change about it."""

    actor: carla.Actor
    name: str
    kind: str  # `vehicle`, `walker` or `static`
    box_x_m: float  # of the box's middle before the actor's origin
    half_length_m: float
    half_width_m: float
    height_m: float


def spawn_actors(client: carla.Client, world: carla.World, specs: Sequence[ActorSpec], case: str) -> list[Member]:
    """Put all actors of ``specs`` into the world for a ``case``; all of them, or none.

    Raises:
        ScenarioError: a blueprint or an attribute is not there, a name is given twice, or a place is taken.
    """
    names = [EGO, *(spec.name for spec in specs)]
    for name in names:
        if names.count(name) > 1:
            raise ScenarioError(f"{case} has two actors called '{name}'; give each its own role")
    library = world.get_blueprint_library()
    members: list[Member] = []
    try:
        for spec in specs:
            members.append(_spawned(world, library, spec, case))  # noqa: PERF401 - spawned actors go if one cannot come
    except BaseException:
        destroy_actors(client, [member.actor for member in members])
        raise
    return members


def destroy_actors(client: carla.Client, actors: Iterable[carla.Actor]) -> None:
    """Take actors out of the world; where the simulator is gone, so are they.

    By commands: of an actor that no snapshot has shown yet, ``destroy`` now and then says that it is dead already, and
    leaves it in the world.
    """
    commands = [carla.command.DestroyActor(actor.id) for actor in actors]
    if commands:
        with contextlib.suppress(RuntimeError):
            client.apply_batch_sync(commands)


def member_of(actor: carla.Actor, name: str) -> Member:
    """What does not change about an actor."""
    box = actor.bounding_box
    kind = actor.type_id.split(".", 1)[0]
    return Member(
        actor=actor,
        name=name,
        kind=kind,
        box_x_m=float(box.location.x),
        half_length_m=max(float(box.extent.x), 0.1),
        half_width_m=max(float(box.extent.y), 0.1),
        height_m=2.0 * float(box.extent.z),
    )


def _spawned(world: carla.World, library: carla.BlueprintLibrary, spec: ActorSpec, case: str) -> Member:
    """Spawn one of the actors."""
    blueprint = _blueprint(library, spec, case)
    pose = carla.Transform(
        carla.Location(spec.pose.x_m, spec.pose.y_m, _ground_m(world, spec.pose) if spec.on_ground else spec.pose.z_m),
        carla.Rotation(yaw=math.degrees(spec.pose.yaw_rad)),
    )
    if blueprint.id.startswith("walker."):
        pose.location.z += _half_height_m(blueprint)
    _out_of_doors(world, spec, case)
    try:
        actor = world.spawn_actor(blueprint, pose)
    except RuntimeError as error:
        raise ScenarioError(
            f"{case} puts '{spec.name}' ({blueprint.id}) at ({spec.pose.x_m:.1f}, {spec.pose.y_m:.1f}), where there is "
            f"no room for it ({error}); move it"
        ) from error
    return member_of(actor, spec.name)


def _blueprint(library: carla.BlueprintLibrary, spec: ActorSpec, case: str) -> carla.ActorBlueprint:
    """Its blueprint with its attributes: of a pattern, the first in alphabetical order, people before animals."""
    kinds = library.filter(spec.blueprint) or library.filter(spec.stand_in or spec.blueprint)
    found = sorted(kinds, key=lambda blueprint: (str(blueprint.id).startswith(ANIMALS), str(blueprint.id)))
    if not found:
        known = sorted(blueprint.id for blueprint in library)
        close = difflib.get_close_matches(spec.blueprint, known, 1)
        hint = f"did you mean '{close[0]}'?" if close else "`world.get_blueprint_library()` has them all"
        raise ScenarioError(f"{case} needs a '{spec.blueprint}' ('{spec.name}'), which the simulator has not; {hint}")
    blueprint = found[0]
    if blueprint.has_attribute("role_name"):
        blueprint.set_attribute("role_name", spec.name)
    if blueprint.has_attribute("is_invincible"):
        blueprint.set_attribute("is_invincible", "false")
    for name, value in spec.attributes:
        if not blueprint.has_attribute(name):
            raise ScenarioError(f"{case}: {blueprint.id} ('{spec.name}') has no attribute '{name}'")
        blueprint.set_attribute(name, value)
    return blueprint


def _ground_m(world: carla.World, pose: Pose) -> float:
    """The height of what lies under a place."""
    found = world.ground_projection(carla.Location(pose.x_m, pose.y_m, pose.z_m + LOOK_FROM_M), LOOK_DOWN_M)
    return (pose.z_m if found is None else float(found.location.z)) + DROP_M


def _out_of_doors(world: carla.World, spec: ActorSpec, case: str) -> None:
    """See that no house stands over the place.

    Raises:
        ScenarioError: one does.
    """
    high, low = (carla.Location(spec.pose.x_m, spec.pose.y_m, spec.pose.z_m + up_m) for up_m in (ROOFS_FROM_M, -1.0))
    if any(point.label in INDOORS for point in world.cast_ray(high, low)):
        raise ScenarioError(
            f"{case} puts '{spec.name}' at ({spec.pose.x_m:.1f}, {spec.pose.y_m:.1f}), which is inside a house; move it"
        )


def _half_height_m(blueprint: carla.ActorBlueprint) -> float:
    """How high a walker's origin, its middle, is above its feet, which CARLA's blueprints do not say."""
    if blueprint.has_attribute("height"):
        return 0.5 * float(blueprint.get_attribute("height").as_float())
    grown = not blueprint.has_attribute("age") or blueprint.get_attribute("age").as_str() != "child"
    return ADULT_M if grown else CHILD_M


ROLLING = carla.VehicleControl()
HELD = carla.VehicleControl(brake=1.0, hand_brake=True)


class Motion(NamedTuple):
    """The command of a vehicle, in m/s and rad/s, or of a walker (its turning is 0)."""

    velocity_x_mps: float
    velocity_y_mps: float
    yaw_rate_radps: float


STILL = Motion(0.0, 0.0, 0.0)


class ActorCommands:
    """The commands of vehicles and walkers, sent in one batch a frame."""

    def __init__(self, client: carla.Client) -> None:
        self._client = client
        self._vehicles: dict[int, tuple[carla.Actor, Motion]] = {}
        self._new: list[object] = []  # commands that are sent once
        self._held: set[int] = set()
        self._walkers: dict[int, tuple[float, float]] = {}  # the last command of each, in m/s

    def move(self, member: Member, velocity_x_mps: float, velocity_y_mps: float, yaw_rate_radps: float) -> None:
        """Lead a vehicle; the pedals of the ego stay the agent's."""
        motion, actor = Motion(velocity_x_mps, velocity_y_mps, yaw_rate_radps), member.actor
        before = self._vehicles.get(actor.id)
        if member.name == EGO:
            pass
        elif motion == STILL and actor.id not in self._held:
            self._held.add(actor.id)
            self._control(actor, HELD)
            self._new.append(carla.command.ApplyTargetVelocity(actor.id, carla.Vector3D()))
        elif motion != STILL and (before is None or actor.id in self._held):
            self._held.discard(actor.id)
            self._control(actor, ROLLING)
        self._vehicles[actor.id] = (actor, motion)

    def walk(self, member: Member, velocity_x_mps: float, velocity_y_mps: float) -> None:
        """Lead a walker."""
        gait = (velocity_x_mps, velocity_y_mps)
        if self._walkers.get(member.actor.id) == gait:
            return
        self._walkers[member.actor.id] = gait
        speed_mps = math.hypot(velocity_x_mps, velocity_y_mps)
        control = carla.WalkerControl()
        control.speed = speed_mps
        if speed_mps > 0.0:
            control.direction = carla.Vector3D(velocity_x_mps / speed_mps, velocity_y_mps / speed_mps, 0.0)
        self._new.append(carla.command.ApplyWalkerControl(member.actor.id, control))

    def let_go(self, member: Member) -> None:
        """Lead it no more."""
        if self._vehicles.pop(member.actor.id, None) is not None and member.actor.id in self._held:
            self._held.discard(member.actor.id)
            self._control(member.actor, ROLLING)

    def forget(self) -> None:
        """Command no actor any more."""
        self._vehicles.clear()
        self._held.clear()
        self._walkers.clear()
        self._new.clear()

    def _control(self, actor: carla.Actor, control: carla.VehicleControl) -> None:
        """Give a vehicle a control, once."""
        self._new.append(carla.command.ApplyVehicleControl(actor.id, control))

    def carry_out(self) -> None:
        """Send the commands of all of them."""
        commands, self._new = self._new, []
        for actor_id, (actor, motion) in self._vehicles.items():
            if actor_id in self._held:
                continue  # its brakes hold it
            rise_mps = actor.get_velocity().z
            velocity = carla.Vector3D(motion.velocity_x_mps, motion.velocity_y_mps, rise_mps)
            turning = carla.Vector3D(0.0, 0.0, math.degrees(motion.yaw_rate_radps))
            commands.append(carla.command.ApplyTargetVelocity(actor_id, velocity))
            commands.append(carla.command.ApplyTargetAngularVelocity(actor_id, turning))
        if commands:
            self._client.apply_batch(commands)
