"""Vehicles of the blueprint library: their attributes, boxes, physics and where their wheels stand.

What is recorded, published or estimated of each is marked in data/blueprints.json.
"""

from typing import Any, NamedTuple

from linden.blueprints.attributes import constant, names, variation
from linden.protocol.values.actors import ActorAttribute
from linden.protocol.values.control import UNKNOWN_UNDERCARRIAGE, Gear, Undercarriage, VehiclePhysicsControl, Wheel
from linden.protocol.values.enums import AttributeType, SemanticTag
from linden.protocol.values.space import BoundingBox, Vector2D, Vector3D

ROLES = ("autopilot", "scenario", "ego_vehicle")
TWO_WHEELERS = ("bicycle", "motorcycle")

TAGS_OF_BASE_TYPE = {
    "car": bytes([SemanticTag.CAR]),
    "van": bytes([SemanticTag.CAR]),  # CARLA's list of tags knows no vans; they are built like its cars
    "truck": bytes([SemanticTag.TRUCK]),
    "bus": bytes([SemanticTag.BUS]),
    "motorcycle": bytes([SemanticTag.MOTORCYCLE, SemanticTag.RIDER]),
    "bicycle": bytes([SemanticTag.BICYCLE, SemanticTag.RIDER]),
}


class VehicleModel(NamedTuple):
    """How a vehicle drives.

    ``wheel_offsets_m``: centres of the wheels in the vehicle's frame (x forward, y right, z above the ground), in the
    order FL, FR, BL, BR, or front, back. ``physics`` has four wheels, those of two-wheelers in pairs, as CARLA's have;
    it leaves the wheels' positions at zero: they are in the world.
    """

    physics: VehiclePhysicsControl
    wheel_offsets_m: tuple[Vector3D, ...]
    undercarriage: Undercarriage = UNKNOWN_UNDERCARRIAGE


def box(facts: dict[str, Any]) -> BoundingBox:
    """Return the local box, m; the origin lies on the ground."""
    centre_x, centre_z = facts["centre_m"]
    return BoundingBox(Vector3D(centre_x, 0.0, centre_z), Vector3D(*facts["half_m"]))


def wheel_count(facts: dict[str, Any]) -> int:
    """Return 2 or 4; CARLA's heavy trucks are driven as four-wheelers too."""
    return 2 if facts["base_type"] in TWO_WHEELERS else 4


def attributes(facts: dict[str, Any], palettes: dict[str, list[str]]) -> tuple[ActorAttribute, ...]:
    """Return a vehicle's attributes in CARLA's order: first what can be set, then what can only be read."""
    second_generation = facts.get("generation", 1) == 2
    without = facts.get("without", ())
    found = list(names(*ROLES))
    if "colours" in facts:
        found.append(variation("color", AttributeType.RGB_COLOR, *palettes[facts["colours"]]))
    if "drivers" in facts:
        drivers = map(str, facts["drivers"])
        found.append(variation("driver_id", AttributeType.INT, *drivers, restricted=True))
    return (
        *found,
        variation("sticky_control", AttributeType.BOOL, "true"),
        variation("terramechanics", AttributeType.BOOL, "false"),
        constant("object_type", ""),
        constant("base_type", facts["base_type"]),
        constant("special_type", facts.get("special_type", "")),
        constant("number_of_wheels", wheel_count(facts)),
        constant("generation", facts.get("generation", 1)),
        constant("has_dynamic_doors", second_generation and "doors" not in without),
        constant("has_lights", second_generation and "lights" not in without),
    )


def chassis(kinds: dict[str, dict[str, Any]], name: str) -> dict[str, Any]:
    """Return a chassis with all that it takes over from the one it is like."""
    own = kinds[name]
    if "like" not in own:
        return own
    parent = chassis(kinds, own["like"])
    return {**parent, **own, "wheel": {**parent["wheel"], **own.get("wheel", {})}}


def model(facts: dict[str, Any], kind: dict[str, Any]) -> VehicleModel:
    """Return the physics of a vehicle on a chassis, which grows with the vehicle's mass where it says so."""
    growth = facts["mass_kg"] / kind["mass_kg"] if kind["scales_with_mass"] else 1.0
    full, engaged, disengaged = kind["damping"]
    physics = VehiclePhysicsControl(
        torque_curve=tuple(Vector2D(float(rpm), torque_nm * growth) for rpm, torque_nm in kind["torque_nm"]),
        max_rpm=kind["max_rpm"],
        moi=kind["moi_kgm2"],
        damping_rate_full_throttle=full,
        damping_rate_zero_throttle_clutch_engaged=engaged,
        damping_rate_zero_throttle_clutch_disengaged=disengaged,
        use_gear_autobox=True,
        gear_switch_time=kind["gear_switch_s"],
        clutch_strength=kind["clutch_strength"],
        final_ratio=kind["final_ratio"],
        forward_gears=tuple(Gear(*gear) for gear in kind["gears"]),
        mass=float(facts["mass_kg"]),
        drag_coefficient=kind["drag"],
        center_of_mass=Vector3D(*kind["centre_of_mass_m"]),
        steering_curve=tuple(Vector2D(float(kmh), share) for kmh, share in kind["steering_kmh"]),
        wheels=_wheels(kind["wheel"], growth, wheel_count(facts)),
    )
    undercarriage = Undercarriage(kind["sway_m"], facts.get("hull_x_m"), kind["reverse_ratio"], kind["tyres_lag"])
    return VehicleModel(physics, _offsets(facts, kind), undercarriage)


def _wheels(facts: dict[str, float], growth: float, count: int) -> tuple[Wheel, ...]:
    """Return four wheels: CARLA's two-wheelers have two on each axle, which share what the table says of one."""
    share = 0.5 if count == 2 else 1.0
    front = Wheel(
        tire_friction=facts["friction"],
        damping_rate=facts["damping"] * share,
        max_steer_angle=facts["steer_front_deg"],
        radius=100.0 * facts["radius_m"],
        max_brake_torque=facts["brake_nm"] * growth * share,
        max_handbrake_torque=0.0,
        lat_stiff_max_load=facts["lat_load"],
        lat_stiff_value=facts["lat_stiffness"],
        long_stiff_value=facts["long_stiffness"] * growth * share,
    )
    rear = front._replace(
        max_steer_angle=facts["steer_rear_deg"],
        max_handbrake_torque=facts["handbrake_rear_nm"] * growth * share,
    )
    return front, front, rear, rear


def _offsets(facts: dict[str, Any], kind: dict[str, Any]) -> tuple[Vector3D, ...]:
    """Return the wheels' centres; unless told, the axles lie evenly about the middle of the box, as a share of it."""
    half_length_m, half_width_m, _ = facts["half_m"]
    half_base_m = 0.5 * facts.get("wheelbase_m", 2.0 * half_length_m * kind["wheelbase_share"])
    half_track_m = 0.5 * facts.get("track_m", 2.0 * half_width_m * kind["track_share"])
    middle_m, radius_m = facts.get("axles_middle_m", facts["centre_m"][0]), kind["wheel"]["radius_m"]
    sides = (0.0,) if wheel_count(facts) == 2 else (-half_track_m, half_track_m)
    return tuple(Vector3D(middle_m + end, side, radius_m) for end in (half_base_m, -half_base_m) for side in sides)
