"""Entities of a scenario: vehicles, pedestrians and objects with their boxes, limits and controllers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from basu_openscenario.reading.catalogs import referred, resolved

if TYPE_CHECKING:
    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.xml_node import Node

KINDS = {"Vehicle": "vehicle", "Pedestrian": "pedestrian", "MiscObject": "miscellaneous"}
PROGRAMS_OWN = "esminiController"
"""The property by which files ask for a controller that is built into esmini."""
UNLIMITED = 1e10
"""A limit that no motion reaches, m/s or m/s²."""


@dataclass(frozen=True, slots=True)
class BoundingBox:
    """The box of an entity about its reference point: m, x forwards, y to the left, z up."""

    centre_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    length_m: float = 0.0
    width_m: float = 0.0
    height_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Performance:
    """The limits of an entity's motion along its path."""

    max_speed_mps: float = UNLIMITED
    max_acceleration_mps2: float = UNLIMITED
    max_deceleration_mps2: float = UNLIMITED


@dataclass(frozen=True, slots=True)
class Controller:
    """A controller that a file assigns, with its properties by name."""

    name: str
    properties: dict[str, str]
    line: str
    """File and line, for sentences."""


@dataclass(frozen=True, slots=True)
class Entity:
    """An entity: a role in the scenario with a body."""

    name: str
    kind: str
    category: str
    box: BoundingBox
    performance: Performance
    properties: dict[str, str] = field(default_factory=dict)
    controllers: tuple[Controller, ...] = ()
    line: str = ""
    model: str = ""
    """The name that the file gives the body, such as a blueprint of CARLA."""
    role: str = ""
    """What a vehicle is used for, such as ``police``."""
    ahead_m: float = 0.0
    """How far the reference point is ahead of the rear axle, by esmini's property `refpoint_x_offset`."""
    hitch_m: float | None = None
    """Where a trailer is connected: m ahead of the reference point."""
    coupler_m: float | None = None
    """Where a trailer itself is connected: m ahead of its reference point."""
    trailer: str = ""
    """The entity that it tows from the begin."""


def read_entity(node: Node, name: str, catalogs: Catalogs) -> Entity:
    """Return the entity of a ``ScenarioObject`` or a ``ScenarioObjectTemplate``.

    Raises:
        ScenarioError: it is of a kind that is not supported, or cannot be read.
    """
    described = resolved(node.only("ObjectController", "MonitorDeclarations"), catalogs)
    if described.tag not in KINDS:
        raise described.fault(f"<{described.tag}> is not supported as an entity; use one of {', '.join(KINDS)}")
    kind = KINDS[described.tag]
    category = described.text(f"{'miscObject' if kind == 'miscellaneous' else kind}Category", "")
    holders = [one for one in node.children("ObjectController") if any(True for _ in one.children())]
    controllers = [read_controller(one, catalogs) for one in holders]
    ahead_m = _ahead_m(described) if kind == "vehicle" else 0.0
    return Entity(
        name,
        kind,
        category,
        _box(described, ahead_m),
        _performance(described),
        _properties(described),
        tuple(controllers),
        node.line,
        described.text("name", ""),
        described.text("role", ""),
        ahead_m,
        _offset(described.find("TrailerHitch")),
        _offset(described.find("TrailerCoupler")),
        _trailer(described.find("Trailer"), name),
    )


def _offset(node: Node | None) -> float | None:
    """Return where a hitch or a coupler is, in m ahead of the reference point; None without one."""
    return None if node is None else node.number("dx")


def _trailer(node: Node | None, name: str) -> str:
    """Return the name of a vehicle's trailer; empty without one."""
    if node is None:
        return ""
    reference = node.find("TrailerRef") or node.find("EntityRef")
    if reference is not None:
        return reference.text("entityRef", "")
    node.child("Trailer")
    return f"{name}+"


def _ahead_m(node: Node) -> float:
    """Return how far the reference point of a vehicle is ahead of its rear axle; the standard has it there."""
    for one in () if node.find("Properties") is None else node.child("Properties").children("Property"):
        if one.text("name") == "refpoint_x_offset":
            return one.number("value")
    return 0.0


def _box(node: Node, ahead_m: float) -> BoundingBox:
    """Return the bounding box of a body about a reference point that lies ``ahead_m`` before the standard's."""
    box = node.child("BoundingBox")
    centre, size = box.child("Center"), box.child("Dimensions")
    return BoundingBox(
        (centre.number("x") - ahead_m, centre.number("y"), centre.number("z")),
        size.number("length"),
        size.number("width"),
        size.number("height"),
    )


def _performance(node: Node) -> Performance:
    """Return the limits of a vehicle; other bodies have none."""
    block = node.find("Performance")
    if block is None:
        return Performance()
    return Performance(
        block.number("maxSpeed", 100.0), block.number("maxAcceleration", 10.0), block.number("maxDeceleration", 10.0)
    )


def _properties(node: Node) -> dict[str, str]:
    """Return the properties of a body or a controller by name."""
    block = node.find("Properties")
    return {} if block is None else {one.text("name"): one.text("value") for one in block.children("Property")}


def read_controller(holder: Node, catalogs: Catalogs) -> Controller:
    """Return the controller inside ``holder``, written out or by reference.

    Raises:
        ScenarioError: there is none.
    """
    node = referred(holder, "Controller", catalogs)
    return Controller(node.text("name"), _properties(node), node.line)
