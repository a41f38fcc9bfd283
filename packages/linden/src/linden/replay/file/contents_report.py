"""The report about the contents of a recording, frame by frame: ``show_recorder_file_info``.

One function writes the block of text of each packet. Source: ``CarlaRecorderQuery.cpp``.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import ActorAdded, Frame, PhysicsRecord, Records, WalkerBones
from linden.replay.file.read import Recording
from linden.replay.file.reports import ending, heading, number, triple

LAMPS = (
    ("Position", 0x1),
    ("LowBeam", 0x2),
    ("HighBeam", 0x4),
    ("Brake", 0x8),
    ("RightBlinker", 0x10),
    ("LeftBlinker", 0x20),
    ("Reverse", 0x40),
    ("Interior", 0x100),
    ("Fog", 0x80),
    ("Special1", 0x200),
    ("Special2", 0x400),
)
"""Lamps in the order in which CARLA names them, with their bits in VehicleLightState."""

DOORS = ("Front Left", "Front Right", "Rear Left", "Rear Right", "Hood", "Trunk", "All")
"""Doors by their numbers."""


def added(actors: Iterable[ActorAdded]) -> Iterator[str]:
    """Yield the lines about added actors."""
    for actor in actors:
        yield f" Create {actor.id}: {actor.description.id} ({actor.kind}) at {triple(actor.location_cm)}\n"
        for attribute in actor.description.attributes:
            yield f"  {attribute.id} = {attribute.value}\n"


def removed(records: Records) -> Iterator[str]:
    """Yield the lines about removed actors."""
    return (f" Destroy {actor_id}\n" for (actor_id,) in records.tolist())


def parents(records: Records) -> Iterator[str]:
    """Yield the lines about attached actors."""
    return (f" Parenting {child} with {parent} (parent)\n" for child, parent in records.tolist())


def collisions(records: Records) -> Iterator[str]:
    """Tell of contacts; only the first actor is marked as hero, for ScenarioRunner's parser fails at a second mark."""
    for collision, first, second, first_is_hero, _ in records.tolist():
        yield f" Collision id {collision} between {first}{' (hero) ' if first_is_hero else ''} with {second}\n"


def positions(records: Records) -> Iterator[str]:
    """Tell where everybody is: cm, and roll, pitch, yaw in degrees."""
    return (
        f"  Id: {actor_id} Location: ({x:g}, {y:g}, {z:g}) Rotation: ({roll:g}, {pitch:g}, {yaw:g})\n"
        for actor_id, (x, y, z), (roll, pitch, yaw) in records.tolist()
    )


def light_states(records: Records) -> Iterator[str]:
    """Tell how the traffic lights stand."""
    return (
        f"  Id: {actor_id} state: {state} frozen: {frozen} elapsedTime: {number(elapsed_s)}\n"
        for actor_id, frozen, elapsed_s, state in records.tolist()
    )


def vehicles(records: Records) -> Iterator[str]:
    """Tell how the vehicles are driven."""
    return (
        f"  Id: {actor_id} Steering: {number(steer)} Throttle: {number(throttle)} Brake: {number(brake)} "
        f"Handbrake: {hand_brake} Gear: {gear}\n"
        for actor_id, steer, throttle, brake, hand_brake, gear in records.tolist()
    )


def walkers(records: Records) -> Iterator[str]:
    """Tell how fast the walkers were told to walk."""
    return (f"  Id: {actor_id} speed: {number(speed_mps)}\n" for actor_id, speed_mps in records.tolist())


def vehicle_lights(records: Records) -> Iterator[str]:
    """Tell which lamps are lit."""
    for actor_id, bits in records.tolist():
        lit = " ".join(name for name, bit in LAMPS if bits & bit)
        yield f"  Id: {actor_id} {lit or 'None'}\n"


def scene_lights(records: Records) -> Iterator[str]:
    """Tell which lamps of streets and houses were switched."""
    for light_id, intensity, rgba, on, _ in records.tolist():
        yield (
            f"  Id: {light_id} enabled: {'True' if on else 'False'} intensity: {number(intensity)} "
            f"RGB_color: {triple(rgba[:3])}\n"
        )


def kinematics(records: Records) -> Iterator[str]:
    """Tell how everybody moves."""
    return (
        f"  Id: {actor_id} linear_velocity: {triple(velocity)} angular_velocity: {triple(turning)}\n"
        for actor_id, velocity, turning in records.tolist()
    )


def boxes(records: Records) -> Iterator[str]:
    """Tell how large actors are, or where the trigger volumes of signs lie."""
    return (
        f"  Id: {actor_id} origin: {triple(origin)} extension: {triple(extent)}\n"
        for actor_id, origin, extent in records.tolist()
    )


def physics(records: Iterable[PhysicsRecord]) -> Iterator[str]:
    """Tell what vehicles are made of."""
    for actor_id, control in records:
        yield f"  Id: {actor_id}\n   max_rpm = {number(control.max_rpm)}\n   MOI = {number(control.moi)}\n"
        for name in (
            "damping_rate_full_throttle",
            "damping_rate_zero_throttle_clutch_engaged",
            "damping_rate_zero_throttle_clutch_disengaged",
        ):
            yield f"   {name} = {number(getattr(control, name))}\n"
        yield f"   use_gear_auto_box = {'true' if control.use_gear_autobox else 'false'}\n"
        for name in ("gear_switch_time", "clutch_strength", "final_ratio", "mass", "drag_coefficient"):
            yield f"   {name} = {number(getattr(control, name))}\n"
        yield f"   center_of_mass = {triple(control.center_of_mass)}\n"
        for name in ("torque_curve", "steering_curve"):
            yield f"   {name} ={''.join(f' {triple(point)}' for point in getattr(control, name))}\n"
        yield "   forward_gears:\n"
        for place, (ratio, down, up) in enumerate(control.forward_gears):
            yield f"    gear {place}: ratio {number(ratio)} down_ratio {number(down)} up_ratio {number(up)}\n"
        yield "   wheels:\n"
        for place, wheel in enumerate(control.wheels):
            yield (
                f"    wheel {place}: tire_friction {number(wheel.tire_friction)} "
                f"damping_rate {number(wheel.damping_rate)} max_steer_angle {number(wheel.max_steer_angle)} "
                f"radius {number(wheel.radius)} max_brake_torque {number(wheel.max_brake_torque)} "
                f"max_handbrake_torque {number(wheel.max_handbrake_torque)} position {triple(wheel.position)}\n"
            )


def light_times(records: Records) -> Iterator[str]:
    """Tell how long the colours of lights last."""
    return (
        f"  Id: {actor_id} green_time: {number(green)} yellow_time: {number(yellow)} red_time: {number(red)}\n"
        for actor_id, green, yellow, red in records.tolist()
    )


def bones(walkers_bones: Iterable[WalkerBones]) -> Iterator[str]:
    """Tell the poses of walkers."""
    for actor_id, found in walkers_bones:
        yield f"  Id: {actor_id}\n"
        for name, location, rotation in found:
            yield f'     Bone: "{name}" relative: Loc{triple(location)} Rot{triple(rotation)}\n'


def doors(records: Records) -> Iterator[str]:
    """Tell which doors were moved; CARLA says "opened" of closed doors too."""
    for actor_id, door, _ in records.tolist():
        yield f"  Id: {actor_id}\n  Doors opened:  {DOORS[door] if door < len(DOORS) else ''} \n"


def weathers(records: Records) -> Iterator[str]:
    """Tell how the weather was."""
    names = ["".join(word.capitalize() for word in name.split("_")) for name in records.dtype.names or ()]
    for values in records.tolist():
        yield "  " + " ".join(f"{name}: {number(value)}" for name, value in zip(names, values, strict=True)) + "\n"


EVENTS: tuple[tuple[PacketId, Callable[[Any], Iterator[str]]], ...] = (
    (PacketId.ADDED, added),
    (PacketId.REMOVED, removed),
    (PacketId.COLLISIONS, collisions),
    (PacketId.PARENTS, parents),
)
"""The events of every frame, in the order that ScenarioRunner's parser needs; CARLA lists parents first."""

STATES: tuple[tuple[PacketId, str, Callable[[Any], Iterator[str]]], ...] = (
    (PacketId.POSITIONS, "Positions", positions),
    (PacketId.LIGHT_STATES, "State traffic lights", light_states),
    (PacketId.VEHICLES, "Vehicle animations", vehicles),
    (PacketId.WALKERS, "Walker animations", walkers),
    (PacketId.VEHICLE_LIGHTS, "Vehicle light animations", vehicle_lights),
    (PacketId.SCENE_LIGHTS, "Scene light changes", scene_lights),
    (PacketId.KINEMATICS, "Dynamic actors", kinematics),
    (PacketId.BOXES, "Actor bounding boxes", boxes),
    (PacketId.TRIGGER_VOLUMES, "Actor trigger volumes", boxes),
    (PacketId.PLATFORM_TIME, "Current platform time", lambda _: iter(())),
    (PacketId.PHYSICS, "Physics Control events", physics),
    (PacketId.LIGHT_TIMES, "Traffic Light time events", light_times),
    (PacketId.BONES, "Walkers Bones", bones),
    (PacketId.DOORS, "Vehicle door animations", doors),
    (PacketId.WEATHER, "Weathers", weathers),
)
"""The states of a full report, with headings: CARLA's order, then what ScenarioRunner's parser stops at."""


_LEFT_OUT_WHEN_EMPTY = (PacketId.DOORS, PacketId.WEATHER)
"""CARLA writes a heading for no doors before all positions, and ScenarioRunner's parser then reads none of them."""


def file_info(recording: Recording, *, show_all: bool) -> str:
    """Return the report; without ``show_all`` only of frames with added, removed, attached or colliding actors."""
    parts = [heading(recording.header)]
    last_number, elapsed_s = 0, 0.0
    for frame in recording.whole_frames():
        last_number, elapsed_s = frame.number, frame.elapsed_s
        told = "".join((*_events(frame), *_states(frame, show_all=show_all)))
        if told or show_all:
            parts.append(f"Frame {frame.number} at {number(frame.elapsed_s)} seconds\n{told}")
        parts.append("\n")
    parts.append("\n")  # CARLA meets the last frame's end twice
    parts.append(ending(last_number, number(elapsed_s)))
    return "".join(parts)


def _events(frame: Frame) -> Iterator[str]:
    for packet, tell in EVENTS:
        if packet in frame.packets:
            yield from tell(frame.packets[packet])


def _states(frame: Frame, *, show_all: bool) -> Iterator[str]:
    for packet, name, tell in STATES:
        if packet not in frame.packets or not (show_all or packet is PacketId.WEATHER):
            continue
        content = frame.packets[packet]
        if packet is PacketId.PLATFORM_TIME:
            yield f" {name}: {number(content)}\n"
        elif len(content) or packet not in _LEFT_OUT_WHEN_EMPTY:
            yield f" {name}: {len(content)}\n"
            yield from tell(content)
