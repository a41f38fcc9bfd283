"""The conditions of triggers: dataclasses and their readers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from basu_openscenario.reading.position_reading import read_position

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.positions import Position
    from basu_openscenario.reading.xml_node import Node

RULES = ("equalTo", "greaterThan", "lessThan", "greaterOrEqual", "lessOrEqual", "notEqualTo")
EDGES = ("none", "rising", "falling", "risingOrFalling")
STATES = (
    "standbyState",
    "runningState",
    "completeState",
    "startTransition",
    "endTransition",
    "stopTransition",
    "skipTransition",
)
ELEMENTS = ("story", "act", "maneuverGroup", "maneuver", "event", "action")
SYSTEMS = ("entity", "lane", "road", "trajectory", "world")
DISTANCES = ("euclidianDistance", "cartesianDistance", "longitudinal", "lateral")
DIRECTIONS = ("longitudinal", "lateral", "vertical")


@dataclass(frozen=True, slots=True)
class Measure:
    """A figure of an entity that is compared: what, in relation to what, and how it is measured."""

    name: str
    rule: str = "greaterThan"
    value: float = 0.0
    entity: str | None = None
    position: Position | None = None
    freespace: bool = False
    system: str = "entity"
    distance: str = "euclidianDistance"
    direction: str | None = None
    tolerance: float = 0.0
    kind: str | None = None
    """A type of entity, or an angle: heading, pitch or roll."""
    lanes: tuple[int, int] | None = None
    reach_m: tuple[float, float] = (0.0, 0.0)
    opposite_lanes: bool = False
    entities: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ByEntity:
    """A condition of entities: of ``any`` of them or of ``all``."""

    entities: tuple[str, ...]
    of_all: bool
    measure: Measure


@dataclass(frozen=True, slots=True)
class ByTime:
    """A condition of the simulated time in s."""

    rule: str
    value: float


@dataclass(frozen=True, slots=True)
class ByElement:
    """A condition of the state of an element of the storyboard, by kind and name."""

    kind: str
    name: str
    state: str


@dataclass(frozen=True, slots=True)
class ByVariable:
    """A condition of the value of a variable or a parameter."""

    name: str
    rule: str
    value: str


@dataclass(frozen=True, slots=True)
class BySignal:
    """A condition of the state of a signal."""

    signal: str
    state: str


@dataclass(frozen=True, slots=True)
class BySignalController:
    """A condition of the phase of a controller of signals."""

    controller: str
    phase: str


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition with its edge and its delay in s."""

    name: str
    edge: str
    delay_s: float
    test: ByEntity | ByTime | ByElement | ByVariable | BySignal | BySignalController
    line: str


@dataclass(frozen=True, slots=True)
class Trigger:
    """Groups of conditions: true where all conditions of one group are."""

    groups: tuple[tuple[Condition, ...], ...]


def read_trigger(node: Node | None, catalogs: Catalogs) -> Trigger | None:
    """Return a trigger; None where the element is missing.

    Raises:
        ScenarioError: a condition is not supported, or incomplete.
    """
    if node is None:
        return None
    groups = [
        tuple(_condition(one, catalogs) for one in group.children("Condition"))
        for group in node.children("ConditionGroup")
    ]
    return Trigger(tuple(groups))


def _condition(node: Node, catalogs: Catalogs) -> Condition:
    """Return one condition."""
    inside = node.only()
    test: ByEntity | ByTime | ByElement | ByVariable | BySignal | BySignalController
    if inside.tag == "ByEntityCondition":
        test = _by_entity(inside, catalogs)
    elif inside.tag == "ByValueCondition":
        value = inside.only()
        if value.tag not in VALUE_CONDITIONS:
            raise value.fault(f"<{value.tag}> is not supported; use one of {', '.join(VALUE_CONDITIONS)}")
        test = VALUE_CONDITIONS[value.tag](value)
    else:
        raise inside.fault(f"<{inside.tag}> is no condition; use ByEntityCondition or ByValueCondition")
    delay_s = node.number("delay", 0.0)
    if delay_s < 0.0:
        raise node.fault(f"the delay {delay_s:g} s is negative; give 0 or more")
    return Condition(node.text("name", ""), node.choice("conditionEdge", EDGES), delay_s, test, node.line)


def _by_entity(node: Node, catalogs: Catalogs) -> ByEntity:
    """Return a condition of entities."""
    triggering = node.child("TriggeringEntities")
    names = tuple(one.text("entityRef") for one in triggering.children("EntityRef"))
    if not names:
        raise triggering.fault("<TriggeringEntities> names no entity; add an <EntityRef>")
    inside = node.child("EntityCondition").only()
    if inside.tag not in ENTITY_CONDITIONS:
        raise inside.fault(f"<{inside.tag}> is not supported; use one of {', '.join(ENTITY_CONDITIONS)}")
    of_all = triggering.choice("triggeringEntitiesRule", ("any", "all")) == "all"
    return ByEntity(names, of_all, ENTITY_CONDITIONS[inside.tag](inside, catalogs))


def _rule(node: Node) -> str:
    """Return the rule by which a value is compared."""
    return node.choice("rule", RULES)


def _system(node: Node) -> str:
    """Return the system of coordinates; ``alongRoute`` of version 1.0 means the road's."""
    along = node.boolean("alongRoute", default=False)
    return node.choice("coordinateSystem", SYSTEMS, "road" if along else "entity")


def _duration(name: str) -> Callable[[Node, Catalogs], Measure]:
    """Return the reader of a condition that lasts for some seconds."""

    def read(node: Node, _: Catalogs) -> Measure:
        return Measure(name, value=node.number("duration"))

    return read


def _collision(node: Node, _: Catalogs) -> Measure:
    """Return a ``CollisionCondition``."""
    other, kind = node.find("EntityRef"), node.find("ByType")
    if (other is None) == (kind is None):
        raise node.fault("<CollisionCondition> needs either an <EntityRef> or a <ByType>; give one of them")
    if other is not None:
        return Measure("collision", entity=other.text("entityRef"))
    assert kind is not None, "one of both is there"
    return Measure("collision", kind=kind.choice("type", ("vehicle", "pedestrian", "miscellaneous")))


def _headway(node: Node, _: Catalogs) -> Measure:
    """Return a ``TimeHeadwayCondition``."""
    return Measure(
        "headway",
        _rule(node),
        node.number("value"),
        node.text("entityRef"),
        freespace=node.boolean("freespace"),
        system=_system(node),
        distance=node.choice("relativeDistanceType", DISTANCES, "euclidianDistance"),
    )


def _time_to_collision(node: Node, catalogs: Catalogs) -> Measure:
    """Return a ``TimeToCollisionCondition``."""
    target = node.child("TimeToCollisionConditionTarget").only()
    entity = target.text("entityRef") if target.tag == "EntityRef" else None
    return Measure(
        "time-to-collision",
        _rule(node),
        node.number("value"),
        entity,
        None if entity is not None else read_position(node.child("TimeToCollisionConditionTarget").only(), catalogs),
        node.boolean("freespace"),
        _system(node),
        node.choice("relativeDistanceType", DISTANCES, "euclidianDistance"),
    )


def _directed(name: str) -> Callable[[Node, Catalogs], Measure]:
    """Return the reader of a condition of a vector or one of its components."""

    def read(node: Node, _: Catalogs) -> Measure:
        entity = node.text("entityRef") if name == "relative-speed" else None
        direction = node.choice("direction", DIRECTIONS) if node.has("direction") else None
        return Measure(name, _rule(node), node.number("value"), entity, direction=direction)

    return read


def _travelled(node: Node, _: Catalogs) -> Measure:
    """Return a ``TraveledDistanceCondition``."""
    return Measure("travelled", "greaterOrEqual", node.number("value"))


def _reach(node: Node, catalogs: Catalogs) -> Measure:
    """Return a ``ReachPositionCondition``."""
    return Measure(
        "reach", position=read_position(node.child("Position"), catalogs), tolerance=node.number("tolerance")
    )


def _distance(node: Node, catalogs: Catalogs) -> Measure:
    """Return a ``DistanceCondition``."""
    return Measure(
        "distance",
        _rule(node),
        node.number("value"),
        position=read_position(node.child("Position"), catalogs),
        freespace=node.boolean("freespace"),
        system=_system(node),
        distance=node.choice("relativeDistanceType", DISTANCES, "euclidianDistance"),
    )


def _relative_distance(node: Node, _: Catalogs) -> Measure:
    """Return a ``RelativeDistanceCondition``."""
    return Measure(
        "distance",
        _rule(node),
        node.number("value"),
        node.text("entityRef"),
        freespace=node.boolean("freespace"),
        system=_system(node),
        distance=node.choice("relativeDistanceType", DISTANCES, "euclidianDistance"),
    )


def _clearance(node: Node, _: Catalogs) -> Measure:
    """Return a ``RelativeClearanceCondition``."""
    lanes = [(one.integer("from", -1000), one.integer("to", 1000)) for one in node.children("RelativeLaneRange")]
    if len(lanes) > 1:
        raise node.fault("<RelativeClearanceCondition> has several ranges of lanes; one is supported")
    return Measure(
        "clearance",
        freespace=node.boolean("freeSpace"),
        lanes=lanes[0] if lanes else None,
        reach_m=(node.number("distanceForward", 0.0), node.number("distanceBackward", 0.0)),
        opposite_lanes=node.boolean("oppositeLanes"),
        entities=tuple(one.text("entityRef") for one in node.children("EntityRef")),
    )


def _angle(node: Node, _: Catalogs) -> Measure:
    """Return an ``AngleCondition``."""
    return Measure(
        "angle",
        value=node.number("angle"),
        system=node.choice("coordinateSystem", ("road", "lane", "world"), "world"),
        tolerance=node.number("angleTolerance"),
        kind=node.choice("angleType", ("heading", "pitch", "roll")),
    )


def _element_state(node: Node) -> ByElement:
    """Return a ``StoryboardElementStateCondition``."""
    return ByElement(
        node.choice("storyboardElementType", ELEMENTS),
        node.text("storyboardElementRef"),
        node.choice("state", STATES),
    )


def _variable(node: Node) -> ByVariable:
    """Return a ``VariableCondition`` or a ``ParameterCondition``."""
    name = node.text("variableRef" if node.tag == "VariableCondition" else "parameterRef").lstrip("$")
    return ByVariable(name, _rule(node), node.text("value"))


ENTITY_CONDITIONS: dict[str, Callable[[Node, Catalogs], Measure]] = {
    "EndOfRoadCondition": _duration("end-of-road"),
    "CollisionCondition": _collision,
    "OffroadCondition": _duration("off-road"),
    "TimeHeadwayCondition": _headway,
    "TimeToCollisionCondition": _time_to_collision,
    "AccelerationCondition": _directed("acceleration"),
    "StandStillCondition": _duration("stand-still"),
    "SpeedCondition": _directed("speed"),
    "RelativeSpeedCondition": _directed("relative-speed"),
    "TraveledDistanceCondition": _travelled,
    "ReachPositionCondition": _reach,
    "DistanceCondition": _distance,
    "RelativeDistanceCondition": _relative_distance,
    "RelativeClearanceCondition": _clearance,
    "AngleCondition": _angle,
}
"""The reader of each condition of entities, by its element."""

VALUE_CONDITIONS: dict[str, Callable[[Node], ByTime | ByElement | ByVariable | BySignal | BySignalController]] = {
    "SimulationTimeCondition": lambda node: ByTime(_rule(node), node.number("value")),
    "StoryboardElementStateCondition": _element_state,
    "ParameterCondition": _variable,
    "VariableCondition": _variable,
    "TrafficSignalCondition": lambda node: BySignal(node.text("name"), node.text("state")),
    "TrafficSignalControllerCondition": lambda node: BySignalController(
        node.text("trafficSignalControllerRef"), node.text("phase")
    ),
}
"""The reader of each condition of values, by its element."""
