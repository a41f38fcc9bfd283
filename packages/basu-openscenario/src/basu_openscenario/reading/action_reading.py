"""Readers of private actions: what one entity does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.reading.actions import (
    AcquirePositionAction,
    ActivateControllerAction,
    AssignControllerAction,
    AssignRouteAction,
    ConnectTrailerAction,
    DisconnectTrailerAction,
    Dynamics,
    FinalSpeed,
    FollowTrajectoryAction,
    LaneChangeAction,
    LaneOffsetAction,
    LaneTarget,
    LateralDistanceAction,
    LightStateAction,
    Limits,
    LongitudinalDistanceAction,
    PrivateAction,
    SpeedAction,
    SpeedProfileAction,
    SpeedTarget,
    SynchronizeAction,
    TeleportAction,
    VisibilityAction,
)
from basu_openscenario.reading.entities import read_controller
from basu_openscenario.reading.position_reading import read_position, read_route, read_trajectory

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.xml_node import Node

DYNAMIC_SHAPES = ("step", "linear", "sinusoidal", "cubic")
DIMENSIONS = ("time", "distance", "rate")
SYSTEMS = ("entity", "lane", "road", "trajectory", "world")
DISPLACEMENTS = ("any", "leadingReferencedEntity", "trailingReferencedEntity")
SIDES = ("any", "leftToReferencedEntity", "rightToReferencedEntity")


def read_private_action(holder: Node, catalogs: Catalogs) -> PrivateAction:
    """Return the action inside a ``PrivateAction``.

    Raises:
        ScenarioError: it is not supported, or incomplete.
    """
    node = holder.only()
    while node.tag in GROUPS:
        node = _first_of_group(node)
    if node.tag not in PRIVATE_ACTIONS:
        raise node.fault(f"<{node.tag}> is not supported as a private action; use one of {', '.join(PRIVATE_ACTIONS)}")
    return PRIVATE_ACTIONS[node.tag](node, catalogs)


GROUPS = ("LongitudinalAction", "LateralAction", "RoutingAction", "AppearanceAction", "ControllerAction")
"""Elements that only contain an action."""


def _first_of_group(node: Node) -> Node:
    """Return the action of a group; version 1.0 lets a controller action assign and override at once."""
    if node.tag == "ControllerAction":
        for child in node.children("OverrideControllerValueAction"):
            if any(flag.boolean("active") for flag in child.children()):
                raise child.fault("<OverrideControllerValueAction> is not supported; remove it, or set active to false")
        return node.only("OverrideControllerValueAction")
    return node.only()


def _dynamics(node: Node) -> Dynamics:
    """Return the dynamics of a transition."""
    return Dynamics(
        node.choice("dynamicsShape", DYNAMIC_SHAPES),
        node.choice("dynamicsDimension", DIMENSIONS, "time"),
        node.number("value", 0.0),
        node.choice("followingMode", ("position", "follow"), "position") == "position",
    )


def _limits(node: Node | None) -> Limits | None:
    """Return the limits inside ``DynamicConstraints``; None without the element."""
    if node is None:
        return None
    names = ("maxSpeed", "maxAcceleration", "maxDeceleration", "maxAccelerationRate", "maxDecelerationRate")
    return Limits(*(node.number(name) if node.has(name) else None for name in names))


def _speed_target(node: Node) -> SpeedTarget:
    """Return an absolute or relative speed."""
    if node.tag.startswith("Absolute"):
        return SpeedTarget(node.number("value"))
    kind = node.choice("speedTargetValueType", ("delta", "factor"), "delta")
    return SpeedTarget(
        node.number("value"), node.text("entityRef"), kind, continuous=node.boolean("continuous", default=False)
    )


def _speed(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``SpeedAction``."""
    target = node.child("SpeedActionTarget").only()
    if target.tag not in {"AbsoluteTargetSpeed", "RelativeTargetSpeed"}:
        raise target.fault(f"<{target.tag}> is no target of a speed; use AbsoluteTargetSpeed or RelativeTargetSpeed")
    return SpeedAction(_dynamics(node.child("SpeedActionDynamics")), _speed_target(target))


def _speed_profile(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``SpeedProfileAction``."""
    entries = tuple(
        (one.number("speed"), one.number("time") if one.has("time") else None)
        for one in node.children("SpeedProfileEntry")
    )
    if not entries:
        raise node.fault("<SpeedProfileAction> has no entry; add a <SpeedProfileEntry>")
    follows = node.choice("followingMode", ("position", "follow")) == "follow"
    entity = node.text("entityRef") if node.has("entityRef") else None
    return SpeedProfileAction(entries, entity, follows, _limits(node.find("DynamicConstraints")) or Limits())


def _longitudinal_distance(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``LongitudinalDistanceAction``."""
    if node.has("distance") == node.has("timeGap"):
        raise node.fault("<LongitudinalDistanceAction> needs either 'distance' or 'timeGap'; give one of them")
    return LongitudinalDistanceAction(
        node.text("entityRef"),
        node.number("distance") if node.has("distance") else None,
        node.number("timeGap") if node.has("timeGap") else None,
        node.boolean("freespace"),
        node.boolean("continuous"),
        node.choice("displacement", DISPLACEMENTS, "trailingReferencedEntity"),
        node.choice("coordinateSystem", SYSTEMS, "entity"),
        _limits(node.find("DynamicConstraints")),
    )


def _lane_target(node: Node, absolute: str, relative: str) -> LaneTarget:
    """Return the target of a lane change or an offset."""
    if node.tag == absolute:
        return LaneTarget(node.number("value"))
    if node.tag == relative:
        return LaneTarget(node.number("value"), node.text("entityRef"))
    raise node.fault(f"<{node.tag}> is no target here; use {absolute} or {relative}")


def _lane_change(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``LaneChangeAction``."""
    target = _lane_target(node.child("LaneChangeTarget").only(), "AbsoluteTargetLane", "RelativeTargetLane")
    return LaneChangeAction(
        _dynamics(node.child("LaneChangeActionDynamics")), target, node.number("targetLaneOffset", 0.0)
    )


def _lane_offset(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``LaneOffsetAction``."""
    dynamics = node.child("LaneOffsetActionDynamics")
    most = dynamics.number("maxLateralAcc") if dynamics.has("maxLateralAcc") else None
    target = _lane_target(node.child("LaneOffsetTarget").only(), "AbsoluteTargetLaneOffset", "RelativeTargetLaneOffset")
    return LaneOffsetAction(
        dynamics.choice("dynamicsShape", DYNAMIC_SHAPES), most, target, node.boolean("continuous", default=False)
    )


def _lateral_distance(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``LateralDistanceAction``."""
    return LateralDistanceAction(
        node.text("entityRef"),
        node.number("distance") if node.has("distance") else None,
        node.boolean("freespace"),
        node.boolean("continuous"),
        node.choice("displacement", SIDES, "any"),
        node.choice("coordinateSystem", SYSTEMS, "entity"),
        _limits(node.find("DynamicConstraints")),
    )


def _teleport(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return a ``TeleportAction``."""
    return TeleportAction(read_position(node.child("Position"), catalogs))


def _synchronize(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return a ``SynchronizeAction``."""
    master_target = read_position(node.child("TargetPositionMaster"), catalogs)
    target = read_position(node.child("TargetPosition"), catalogs)
    return SynchronizeAction(
        node.text("masterEntityRef"),
        master_target,
        target,
        _final_speed(node.find("FinalSpeed"), catalogs),
        node.number("targetToleranceMaster", 0.0),
        node.number("targetTolerance", 0.0),
    )


def _final_speed(node: Node | None, catalogs: Catalogs) -> FinalSpeed | None:
    """Return the speed at the end of a synchronisation."""
    if node is None:
        return None
    speed = node.only()
    if speed.tag == "AbsoluteSpeed":
        target = SpeedTarget(speed.number("value"))
    elif speed.tag == "RelativeSpeedToMaster":
        kind = speed.choice("speedTargetValueType", ("delta", "factor"))
        target = SpeedTarget(speed.number("value"), "", kind)
    else:
        raise speed.fault(f"<{speed.tag}> is no final speed; use AbsoluteSpeed or RelativeSpeedToMaster")
    for steady in speed.children("SteadyState", "TargetTimeSteadyState", "TargetDistanceSteadyState"):
        if steady.tag == "TargetTimeSteadyState":
            return FinalSpeed(target, "time", steady.number("time" if steady.has("time") else "value"))
        if steady.tag == "TargetDistanceSteadyState":
            return FinalSpeed(target, "distance", steady.number("distance" if steady.has("distance") else "value"))
        return FinalSpeed(target, "position", 0.0, read_position(steady.child("Position"), catalogs))
    return FinalSpeed(target)


def _assign_route(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return an ``AssignRouteAction``."""
    return AssignRouteAction(read_route(node, catalogs))


def _acquire(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return an ``AcquirePositionAction``."""
    return AcquirePositionAction(read_position(node.child("Position"), catalogs))


def _follow_trajectory(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return a ``FollowTrajectoryAction``; version 1.0 has the trajectory beside its reference."""
    holder = node.find("TrajectoryRef") or node
    trajectory = read_trajectory(holder, catalogs)
    timing = node.child("TimeReference").find("Timing")
    mode = node.find("TrajectoryFollowingMode")
    follows = (mode or node).choice("followingMode", ("position", "follow"), "position") == "follow"
    start_m = node.number("initialDistanceOffset", 0.0)
    if timing is None:
        return FollowTrajectoryAction(trajectory, None, 1.0, 0.0, follows, start_m)
    domain = timing.choice("domainAbsoluteRelative", ("absolute", "relative"))
    return FollowTrajectoryAction(trajectory, domain, timing.number("scale"), timing.number("offset"), follows, start_m)


def _visibility(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``VisibilityAction``."""
    return VisibilityAction(node.boolean("graphics"), node.boolean("sensors"), node.boolean("traffic"))


def _flag(node: Node, name: str) -> bool | None:
    """Return a truth value; None where the attribute is missing."""
    return node.boolean(name) if node.has(name) else None


def _assign_controller(node: Node, catalogs: Catalogs) -> PrivateAction:
    """Return an ``AssignControllerAction``."""
    controller = read_controller(node.find("ObjectController") or node, catalogs)
    return AssignControllerAction(controller, _flag(node, "activateLateral"), _flag(node, "activateLongitudinal"))


def _activate(node: Node, _: Catalogs) -> PrivateAction:
    """Return an ``ActivateControllerAction``."""
    name = node.text("objectControllerRef") if node.has("objectControllerRef") else None
    name = node.text("controllerRef") if node.has("controllerRef") else name
    return ActivateControllerAction(name, _flag(node, "lateral"), _flag(node, "longitudinal"))


def _lights(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``LightStateAction``."""
    light = node.child("LightType").only()
    name = light.text("vehicleLightType" if light.tag == "VehicleLight" else "userDefinedLightType")
    mode = node.child("LightState").choice("mode", ("on", "off", "flashing"))
    return LightStateAction(name, mode, node.number("transitionTime", 0.0))


def _trailer(node: Node, _: Catalogs) -> PrivateAction:
    """Return a ``ConnectTrailerAction`` or a ``DisconnectTrailerAction``."""
    inside = node.only()
    if inside.tag == "ConnectTrailerAction":
        return ConnectTrailerAction(inside.text("trailerRef"))
    if inside.tag == "DisconnectTrailerAction":
        return DisconnectTrailerAction()
    raise inside.fault(f"<{inside.tag}> is no action on a trailer; use ConnectTrailerAction or DisconnectTrailerAction")


PRIVATE_ACTIONS: dict[str, Callable[[Node, Catalogs], PrivateAction]] = {
    "SpeedAction": _speed,
    "SpeedProfileAction": _speed_profile,
    "LongitudinalDistanceAction": _longitudinal_distance,
    "LaneChangeAction": _lane_change,
    "LaneOffsetAction": _lane_offset,
    "LateralDistanceAction": _lateral_distance,
    "TeleportAction": _teleport,
    "SynchronizeAction": _synchronize,
    "AssignRouteAction": _assign_route,
    "AcquirePositionAction": _acquire,
    "FollowTrajectoryAction": _follow_trajectory,
    "VisibilityAction": _visibility,
    "AssignControllerAction": _assign_controller,
    "ActivateControllerAction": _activate,
    "LightStateAction": _lights,
    "TrailerAction": _trailer,
}
"""The reader of each private action, by its element."""
