"""Readers of actions on traffic. What would bring too many vehicles is refused with its bound."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

from basu_openscenario.reading.entities import (
    PROGRAMS_OWN,
    BoundingBox,
    Entity,
    Performance,
    read_controller,
    read_entity,
)
from basu_openscenario.reading.position_reading import read_position
from basu_openscenario.reading.traffic import (
    FARTHEST_M,
    FASTEST_MPS,
    MOST_ENTRIES,
    MOST_PER_S,
    MOST_VEHICLES,
    RoadStretch,
    TrafficAction,
    TrafficAreaAction,
    TrafficMix,
    TrafficSinkAction,
    TrafficSourceAction,
    TrafficStopAction,
    TrafficSwarmAction,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.entities import Controller
    from basu_openscenario.reading.xml_node import Node

SIZES_M = {
    "car": (4.6, 1.9, 1.5),
    "van": (5.9, 2.0, 2.5),
    "truck": (6.0, 2.6, 2.6),
    "bus": (10.3, 2.6, 3.2),
    "motorbike": (2.1, 0.8, 1.6),
    "bicycle": (1.7, 0.6, 1.7),
}
"""Length, width and height of a vehicle of which a file gives the category alone."""
LIMITS = {
    "car": (60.0, 5.0, 9.0),
    "van": (45.0, 4.0, 8.0),
    "truck": (30.0, 2.0, 6.0),
    "bus": (30.0, 2.0, 6.0),
    "motorbike": (60.0, 6.0, 8.0),
    "bicycle": (8.0, 1.5, 4.0),
}
"""Their highest speed, acceleration and deceleration, in m/s and m/s²."""
T = TypeVar("T")
REAR_AXLE = 0.28
"""How far the middle of such a body is ahead of the rear axle, as a share of its length."""
ROLES = ("none", "civil", "ambulance", "fire", "police", "publicTransport", "roadAssistance", "military")


def read_traffic_action(holder: Node, catalogs: Catalogs) -> TrafficAction:
    """Return the action inside a ``TrafficAction``.

    Raises:
        ScenarioError: it is incomplete, or asks for more than the bounds of `basu_openscenario.reading.traffic`.
    """
    node = holder.only()
    if node.tag not in TRAFFIC_ACTIONS:
        raise node.fault(f"<{node.tag}> is no action on traffic; use one of {', '.join(TRAFFIC_ACTIONS)}")
    return TRAFFIC_ACTIONS[node.tag](node, holder.text("trafficName", ""), catalogs)


def _within(node: Node, name: str, most: float, unit: str, least: float = 0.0) -> float:
    """Return a number between bounds.

    Raises:
        ScenarioError: it is outside of them.
    """
    value = node.number(name)
    if not least <= value <= most:
        raise node.fault(
            f'{name}="{value:g}" of <{node.tag}> is not supported; write a number from {least:g} to {most:g} {unit}'
        )
    return value


def _count(node: Node, name: str) -> int:
    """Return a number of vehicles up to the bound."""
    count = node.integer(name)
    if not 0 <= count <= MOST_VEHICLES:
        raise node.fault(
            f'{name}="{count}" of <{node.tag}> is not supported: a scenario has up to {MOST_VEHICLES} vehicles of '
            f"traffic at a time; write a number from 0 to {MOST_VEHICLES}"
        )
    return count


def _source(node: Node, name: str, catalogs: Catalogs) -> TrafficAction:
    """Return a ``TrafficSourceAction``."""
    speed = next((one for one in ("speed", "velocity") if node.has(one)), None)
    return TrafficSourceAction(
        name,
        node.line,
        read_position(node.child("Position"), catalogs),
        _within(node, "radius", FARTHEST_M, "m"),
        _within(node, "rate", MOST_PER_S, "vehicles/s"),
        None if speed is None else _within(node, speed, FASTEST_MPS, "m/s"),
        _mix(node, catalogs),
    )


def _sink(node: Node, name: str, catalogs: Catalogs) -> TrafficAction:
    """Return a ``TrafficSinkAction``."""
    definition = node.find("TrafficDefinition")
    shares = [] if definition is None else _category_shares(definition)
    return TrafficSinkAction(
        name,
        node.line,
        read_position(node.child("Position"), catalogs),
        _within(node, "radius", FARTHEST_M, "m"),
        _within(node, "rate", MOST_PER_S, "vehicles/s") if node.has("rate") else None,
        None if definition is None else frozenset(category for category, weight in shares if weight > 0.0),
    )


def _swarm(node: Node, name: str, catalogs: Catalogs) -> TrafficAction:
    """Return a ``TrafficSwarmAction``; version 1.0 calls the central object otherwise."""
    central = node.find("CentralSwarmObject") or node.child("CentralObject")
    inner_m = _within(node, "innerRadius", FARTHEST_M, "m")
    axes_m = [_within(node, one, FARTHEST_M, "m") for one in ("semiMajorAxis", "semiMinorAxis")]
    if inner_m >= max(axes_m):
        raise node.fault(
            f'innerRadius="{inner_m:g}" of <{node.tag}> leaves no room inside the axes of {axes_m[0]:g} and '
            f"{axes_m[1]:g} m; make it smaller"
        )
    directions = node.find("DirectionOfTravelDistribution")
    weights = None if directions is None else tuple(_weight(directions, one) for one in ("same", "opposite"))
    if weights is not None and sum(weights) <= 0.0:
        assert directions is not None, "the weights are its own"
        raise directions.fault("both weights of <DirectionOfTravelDistribution> are 0; make one of them larger")
    return TrafficSwarmAction(
        name,
        node.line,
        central.text("entityRef"),
        inner_m,
        axes_m[0],
        axes_m[1],
        _within(node, "offset", FARTHEST_M, "m", -FARTHEST_M),
        _count(node, "numberOfVehicles"),
        _speeds(node),
        None if weights is None else (weights[0], weights[1]),
        _mix(node, catalogs),
    )


def _speeds(node: Node) -> tuple[float, float] | None:
    """Return the range of the first speeds of a swarm, in m/s; None where the file has none."""
    limits = node.find("InitialSpeedRange")
    if limits is None:
        return (_within(node, "velocity", FASTEST_MPS, "m/s"),) * 2 if node.has("velocity") else None
    low, high = (_within(limits, one, FASTEST_MPS, "m/s") for one in ("lowerLimit", "upperLimit"))
    if low > high:
        raise limits.fault(f'lowerLimit="{low:g}" is above upperLimit="{high:g}"; exchange them')
    return low, high


def _area(node: Node, name: str, catalogs: Catalogs) -> TrafficAction:
    """Return a ``TrafficAreaAction``."""
    area = node.child("TrafficArea")
    polygon = area.find("Polygon")
    corners = [] if polygon is None else list(polygon.children("Position"))
    ranges = list(area.children("RoadRange"))
    if (polygon is None) == (not ranges):
        raise area.fault("<TrafficArea> needs either one <Polygon> or one <RoadRange> or more; write one kind")
    if polygon is not None and not 3 <= len(corners) <= MOST_ENTRIES:
        raise polygon.fault(f"<Polygon> has {len(corners)} positions; it needs from 3 to {MOST_ENTRIES}")
    return TrafficAreaAction(
        name,
        node.line,
        _count(node, "numberOfEntities"),
        node.boolean("continuous"),
        tuple(read_position(one, catalogs) for one in corners),
        tuple(_stretch(one) for one in ranges),
        _mix(node, catalogs),
    )


def _stretch(node: Node) -> RoadStretch:
    """Return a ``RoadRange``."""
    cursors = list(node.children("RoadCursor"))
    if not 2 <= len(cursors) <= MOST_ENTRIES:
        raise node.fault(f"<RoadRange> has {len(cursors)} cursors; it needs from 2 to {MOST_ENTRIES}")
    lanes = [frozenset(lane.integer("id") for lane in one.children("Lane")) for one in cursors]
    return RoadStretch(
        tuple(one.text("roadId") for one in cursors),
        tuple(one.number("s") if one.has("s") else None for one in cursors),
        tuple(one or None for one in lanes),
        node.number("length") if node.has("length") else None,
        node.line,
    )


def _stop(node: Node, name: str, _: Catalogs) -> TrafficAction:
    """Return a ``TrafficStopAction``."""
    return TrafficStopAction(name, node.line)


TRAFFIC_ACTIONS: dict[str, Callable[[Node, str, Catalogs], TrafficAction]] = {
    "TrafficSourceAction": _source,
    "TrafficSinkAction": _sink,
    "TrafficSwarmAction": _swarm,
    "TrafficAreaAction": _area,
    "TrafficStopAction": _stop,
}
"""The reader of each action on traffic, by its element."""


def _mix(node: Node, catalogs: Catalogs) -> TrafficMix:
    """Return which vehicles an action brings: by templates, by categories, or cars where the file names none."""
    distribution, definition = node.find("TrafficDistribution"), node.find("TrafficDefinition")
    if distribution is not None:
        bodies = [
            (_template(one.child("ScenarioObjectTemplate"), catalogs), _weight(entry) * _weight(one))
            for entry in distribution.children("TrafficDistributionEntry")
            for one in entry.child("EntityDistribution").children("EntityDistributionEntry")
        ]
        return TrafficMix(tuple(_some(distribution, bodies)))
    if definition is None:
        return TrafficMix(((_body("car", node.line), 1.0),))
    shares = [(_body(category, definition.line), weight) for category, weight in _category_shares(definition)]
    roles = definition.find("VehicleRoleDistribution")
    given = [] if roles is None else list(roles.children("VehicleRoleDistributionEntry"))
    found = [(one.choice("role", ROLES), _weight(one)) for one in given]
    block = definition.find("ControllerDistribution")
    entries = [] if block is None else list(block.children("ControllerDistributionEntry"))
    drivers = [(read_controller(one, catalogs), _weight(one)) for one in entries]
    for entry, (controller, _) in zip(entries, drivers, strict=True):
        _check_controller(entry, controller)
    return TrafficMix(
        tuple(shares),
        tuple(found if roles is None else _some(roles, found)),
        tuple(drivers if block is None else _some(block, drivers)),
    )


def _category_shares(definition: Node) -> list[tuple[str, float]]:
    """Return the categories of a ``TrafficDefinition`` with their weights."""
    block = definition.child("VehicleCategoryDistribution")
    found = [
        (one.choice("category", tuple(SIZES_M)), _weight(one))
        for one in block.children("VehicleCategoryDistributionEntry")
    ]
    return _some(block, found)


def _weight(node: Node, name: str = "weight") -> float:
    """Return a weight: a finite number from 0 on."""
    value = node.number(name)
    if not 0.0 <= value < math.inf:
        raise node.fault(f'{name}="{value:g}" of <{node.tag}> is no weight; write a number from 0 on')
    return value


def _some(node: Node, shares: list[tuple[T, float]]) -> list[tuple[T, float]]:
    """Return the entries of a distribution; refuse one of which no entry can be chosen, or that is too long."""
    if not 0.0 < sum(weight for _, weight in shares) < math.inf:
        raise node.fault(f"<{node.tag}> has no entry with a weight above 0; add one")
    if len(shares) > MOST_ENTRIES:
        raise node.fault(f"<{node.tag}> has {len(shares)} entries; up to {MOST_ENTRIES} are read")
    return shares


def _body(category: str, line: str) -> Entity:
    """Return a vehicle of a category."""
    length_m, width_m, height_m = SIZES_M[category]
    box = BoundingBox((REAR_AXLE * length_m, 0.0, 0.5 * height_m), length_m, width_m, height_m)
    return Entity("", "vehicle", category, box, Performance(*LIMITS[category]), line=line)


def _template(node: Node, catalogs: Catalogs) -> Entity:
    """Return the vehicle of a ``ScenarioObjectTemplate``."""
    entity = read_entity(node, "", catalogs)
    if entity.kind != "vehicle" or entity.category in {"trailer", "semitrailer"}:
        raise node.fault(
            f"a {entity.category if entity.kind == 'vehicle' else entity.kind} does not drive by itself; "
            "let the template be a vehicle"
        )
    if entity.trailer:
        raise node.fault("vehicles of traffic have no trailers; remove the <Trailer> of the template")
    for controller in entity.controllers:
        _check_controller(node, controller)
    return entity


def _check_controller(node: Node, controller: Controller) -> None:
    """Refuse a controller of another program: traffic has one way to drive."""
    kind = controller.properties.get(PROGRAMS_OWN, "")
    if kind:
        raise node.fault(
            f"the controller '{controller.name}' is {kind}, which is esmini's own and not supported for traffic; "
            "name another controller: traffic follows its lane and keeps its distance"
        )
