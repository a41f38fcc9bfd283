"""``Scene``: objects and their upright boxes, as arrays and as CARLA's environment objects.

A thing is what Unreal calls an actor, a box one of its meshes; clients know every box as an environment object.
"""

import hashlib
import math
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linden.background import young_collector
from linden.protocol.values.enums import MapLayer, SemanticTag
from linden.protocol.values.episode import EnvironmentObject
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.structured import StructuredArray


class ObjectKind(IntEnum):
    """What a thing is."""

    TRAFFIC_LIGHT = 0
    TRAFFIC_SIGN = 1
    HOUSE = 2
    TREE = 3
    STREET_LAMP = 4
    WALL = 5
    PORCH = 6
    HEDGE = 7
    FENCE = 8
    PARKED_CAR = 9
    UTILITY_POLE = 10
    SHELTER = 11
    BUILDING = 12  # on the footprint that the map gives
    BENCH = 13
    BIN = 14
    MAILBOX = 15
    STREET_NAME_SIGN = 16


_NAMES = {
    ObjectKind.TRAFFIC_LIGHT: "TrafficLight",
    ObjectKind.TRAFFIC_SIGN: "TrafficSign",
    ObjectKind.HOUSE: "House",
    ObjectKind.TREE: "Tree",
    ObjectKind.STREET_LAMP: "StreetLamp",
    ObjectKind.WALL: "Wall",
    ObjectKind.PORCH: "Porch",
    ObjectKind.HEDGE: "Hedge",
    ObjectKind.FENCE: "Fence",
    ObjectKind.PARKED_CAR: "ParkedCar",
    ObjectKind.UTILITY_POLE: "UtilityPole",
    ObjectKind.SHELTER: "BusStop",
    ObjectKind.BUILDING: "Building",
    ObjectKind.BENCH: "Bench",
    ObjectKind.BIN: "Bin",
    ObjectKind.MAILBOX: "Mailbox",
    ObjectKind.STREET_NAME_SIGN: "StreetNameSign",
}
_TAG_NAMES: dict[int, str] = {SemanticTag.POLES: "Poles", SemanticTag.TRAFFIC_LIGHT: "TrafficLight"}
"""How CARLA writes the tags of a traffic light's parts into their names (Tagger.cpp, GetTagAsString)."""

LAYER = {
    ObjectKind.TRAFFIC_LIGHT: MapLayer.NONE,
    ObjectKind.TRAFFIC_SIGN: MapLayer.NONE,
    ObjectKind.HOUSE: MapLayer.BUILDINGS,
    ObjectKind.TREE: MapLayer.FOLIAGE,
    ObjectKind.STREET_LAMP: MapLayer.STREET_LIGHTS,
    ObjectKind.WALL: MapLayer.WALLS,
    ObjectKind.PORCH: MapLayer.BUILDINGS,
    ObjectKind.HEDGE: MapLayer.FOLIAGE,
    ObjectKind.FENCE: MapLayer.WALLS,
    ObjectKind.PARKED_CAR: MapLayer.PARKED_VEHICLES,
    ObjectKind.UTILITY_POLE: MapLayer.PROPS,
    ObjectKind.SHELTER: MapLayer.PROPS,
    ObjectKind.BUILDING: MapLayer.BUILDINGS,
    ObjectKind.BENCH: MapLayer.PROPS,
    ObjectKind.BIN: MapLayer.PROPS,
    ObjectKind.MAILBOX: MapLayer.PROPS,
    ObjectKind.STREET_NAME_SIGN: MapLayer.PROPS,
}
"""The layer that a thing is loaded and unloaded with."""

THING = np.dtype(
    [
        ("kind", "u1"),  # of Kind
        ("base", "f8", 3),  # where it stands, m, world
        ("yaw_rad", "f8"),
    ]
)
BOX = np.dtype(
    [
        ("centre", "f8", 3),  # m, world
        ("half", "f8", 3),  # m
        ("yaw_rad", "f8"),
        ("tag", "u1"),  # values.enums.SemanticTag
        ("thing", "i4"),  # row of THING
    ]
)


@dataclass(frozen=True, eq=False)
class Scene:
    """Things and their boxes, those of one thing next to each other, in the order of the things. It never changes."""

    things: StructuredArray  # of THING
    boxes: StructuredArray  # of BOX
    labels: tuple[tuple[int, str], ...] = ()  # rows of things with a name of their own, and that name

    @cached_property
    def layers(self) -> NDArray[np.int64]:
        """Return the layer of each box."""
        of_kind = np.array([int(LAYER[kind]) for kind in ObjectKind])
        layers: NDArray[np.int64] = of_kind[self.things["kind"][self.boxes["thing"]]]
        return layers

    @cached_property
    def thing_names(self) -> tuple[str, ...]:
        """The name of each thing, as ``get_names_of_all_objects`` lists them; numbered within its kind."""
        count = dict.fromkeys(ObjectKind, 0)
        names = []
        for kind in map(ObjectKind, self.things["kind"].tolist()):
            names.append(f"{_NAMES[kind]}_{count[kind]}")
            count[kind] += 1
        for thing, label in self.labels:
            names[thing] += f"_{label}"
        return tuple(names)

    @cached_property
    def world_boxes(self) -> tuple[BoundingBox, ...]:
        """Every box as clients see it, in their order."""
        columns = (self.boxes[name].tolist() for name in ("centre", "half", "yaw_rad"))
        with young_collector():
            return tuple(
                BoundingBox(Vector3D(*centre), Vector3D(*half), _turned(yaw))
                for centre, half, yaw in zip(*columns, strict=True)
            )

    @cached_property
    def box_names(self) -> tuple[str, ...]:
        """The name of each box: that of its thing, what it is, and its number within the thing."""
        is_light = (self.things["kind"] == ObjectKind.TRAFFIC_LIGHT).tolist()
        names, last, nth = [], -1, 0
        for thing, tag in zip(self.boxes["thing"].tolist(), self.boxes["tag"].tolist(), strict=True):
            nth = nth + 1 if thing == last else 0
            last = thing
            names.append(f"{self.thing_names[thing]}_{_TAG_NAMES[tag] if is_light[thing] else 'SM'}_{nth}")
        return tuple(names)

    @cached_property
    def objects(self) -> tuple[EnvironmentObject, ...]:
        """Every box with its name, its id and the place of its thing, in their order."""
        bases, yaws = self.things["base"].tolist(), self.things["yaw_rad"].tolist()
        columns = (self.boxes["thing"].tolist(), self.boxes["tag"].tolist())
        with young_collector():
            poses = [Transform(Vector3D(*base), _turned(yaw)) for base, yaw in zip(bases, yaws, strict=True)]
            return tuple(
                EnvironmentObject(poses[thing], box, object_id(name), name, tag)
                for box, name, thing, tag in zip(self.world_boxes, self.box_names, *columns, strict=True)
            )

    @cached_property
    def box_of_id(self) -> dict[int, int]:
        """The row of each box by the id that clients know it by."""
        return {object_id(name): number for number, name in enumerate(self.box_names)}

    def boxes_of(self, thing: int) -> NDArray[np.intp]:
        """Return the rows of a thing's boxes."""
        rows = np.searchsorted(self.boxes["thing"], [thing, thing + 1])
        return np.arange(rows[0], rows[1])


def object_id(name: str) -> int:
    """Return the id of an object: 63 bits that its name decides, so that it is the same in every run (CARLA: 64)."""
    return int.from_bytes(hashlib.blake2b(name.encode(), digest_size=8).digest(), "little") >> 1


def join(scenes: "list[Scene]") -> Scene:
    """Return one scene of several, in their order."""
    before = np.cumsum([0, *(len(scene.things) for scene in scenes)])
    boxes = np.concatenate([scene.boxes for scene in scenes])
    boxes["thing"] += np.repeat(before[:-1], [len(scene.boxes) for scene in scenes]).astype(np.int32)
    labels = [
        (int(start) + row, label) for start, scene in zip(before, scenes, strict=False) for row, label in scene.labels
    ]
    return Scene(np.concatenate([scene.things for scene in scenes]), boxes, tuple(labels))


def things_with(kind: ObjectKind, base_m: NDArray[np.float64], yaw_rad: NDArray[np.float64]) -> StructuredArray:
    """Return things (N,) of a kind that stand at ``base_m`` (N, 3)."""
    things = np.zeros(len(base_m), THING)
    things["kind"], things["base"], things["yaw_rad"] = kind, base_m, yaw_rad
    return things


def boxes_on(
    things: StructuredArray, offset_m: NDArray[np.float64], half_m: NDArray[np.float64], tag: SemanticTag
) -> StructuredArray:
    """Return one box for each thing; ``offset_m`` of its middle (in the thing's frame) and ``half_m`` are (N, 3)."""
    cosine, sine = np.cos(things["yaw_rad"]), np.sin(things["yaw_rad"])
    x, y, z = np.broadcast_to(offset_m, (len(things), 3)).T
    boxes = np.zeros(len(things), BOX)
    boxes["centre"] = things["base"] + np.column_stack([cosine * x - sine * y, sine * x + cosine * y, z])
    boxes["half"], boxes["yaw_rad"], boxes["tag"] = half_m, things["yaw_rad"], tag
    boxes["thing"] = np.arange(len(things))
    return boxes


def assembled(things: StructuredArray, *parts: StructuredArray) -> Scene:
    """Return the scene of things with boxes that come part by part, as :func:`boxes_on` makes them."""
    boxes = np.concatenate(parts)
    return Scene(things, boxes[np.argsort(boxes["thing"], kind="stable")])


def _turned(yaw_rad: float) -> Rotation:
    return Rotation(0.0, math.degrees(math.remainder(yaw_rad, math.tau)), 0.0)
