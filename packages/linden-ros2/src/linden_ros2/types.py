"""ROS message types from their definitions: messages with defaults, and their bytes for ROS 1 and ROS 2."""

from __future__ import annotations

import enum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rosbags.typesys.store import Typestore

NOETIC, HUMBLE, KILTED = Stores.ROS1_NOETIC, Stores.ROS2_HUMBLE, Stores.ROS2_KILTED
DEFINITIONS = Path(__file__).parent / "definitions"


class Generation(enum.Enum):
    """A generation of ROS: its standard types and its serialisation."""

    ROS_1 = "ros1"
    ROS_2 = "ros2"


class Types:
    """The message types of one generation: those of Noetic or Humble, CARLA's, Autoware's and Ackermann's."""

    def __init__(
        self, generation: Generation, foreign: Mapping[str, str] | None = None, release: Stores | None = None
    ) -> None:
        """Read all definitions; ``foreign`` are definitions of other versions, with all that they hold, by type.

        ``release`` has the standard types, by default Noetic or Humble.
        """
        self.generation = generation
        usual = NOETIC if generation is Generation.ROS_1 else HUMBLE
        self.store: Typestore = get_typestore(release or usual)
        own: dict[str, Any] = {}
        for name, text in (foreign or {}).items():
            found = get_types_from_msg(text, name)
            own.update({each: found[each] for each in found if each not in self.store.fielddefs})
        for file in sorted(DEFINITIONS.glob("*/*.msg")):
            name = f"{file.parent.name}/msg/{file.stem}"
            if name not in self.store.fielddefs and name not in own:
                own.update(get_types_from_msg(file.read_text(encoding="utf-8"), name))
        if generation is Generation.ROS_2:
            own.update(_services())
        self.store.register(own)

    def message(self, name: str, /, **fields: Any) -> Any:  # noqa: ANN401 - a class made of its definition
        """Return a message of a type such as ``nav_msgs/msg/Odometry``; fields that are not given are zero or empty.

        Raises:
            TypeError: the type has no such field.
        """
        given = dict(fields)
        values = {
            key: given.pop(key) if key in given else self._blank(kind) for key, kind in self.store.fielddefs[name][1]
        }
        if given:
            raise TypeError(f"{name} has no field {', '.join(sorted(given))}")
        return self.store.types[name](**values)

    def data(self, message: Any) -> memoryview:  # noqa: ANN401 - as above
        """Return the bytes of a message: CDR for ROS 2, ROS 1's own serialisation for ROS 1."""
        if self.generation is Generation.ROS_1:
            return self.store.serialize_ros1(message, message.__msgtype__)
        return self.store.serialize_cdr(message, message.__msgtype__)

    def parsed(self, data: bytes | memoryview, name: str) -> Any:  # noqa: ANN401 - as above
        """Return the message of the type ``name`` in ``data``; an error of any kind where there is none."""
        if self.generation is Generation.ROS_1:
            return self.store.deserialize_ros1(data, name)
        return self.store.deserialize_cdr(data, name)

    def _blank(self, kind: Any) -> Any:  # noqa: ANN401 - a description of rosbags in, a value out
        """The default of a field."""
        node, rest = int(kind[0]), kind[1]
        if node == _NAME:
            return self.message(rest)
        if node == _BASE:
            return _ZEROS.get(rest[0], 0)
        inner, length = rest[0], rest[1] if node == _ARRAY else 0
        if int(inner[0]) == _BASE and inner[1][0] not in {"string", "wstring"}:
            return np.zeros(length, dtype=_DTYPES.get(inner[1][0], inner[1][0]))
        return [self._blank(inner) for _ in range(length)]


def _services() -> dict[str, Any]:
    """The requests and responses of the services, as types such as ``carla_msgs/srv/SpawnObject_Request``."""
    found: dict[str, Any] = {}
    for file in sorted(DEFINITIONS.glob("*/*.srv")):
        parts = file.read_text(encoding="utf-8").split("---\n")
        for part, text in zip(("Request", "Response"), parts, strict=True):
            name = f"{file.stem}_{part}"
            [fields] = get_types_from_msg(text, f"{file.parent.name}/msg/{name}").values()
            found[f"{file.parent.name}/srv/{name}"] = fields
    return found


_BASE, _NAME, _ARRAY = 1, 2, 3  # rosbags.interfaces.Nodetype
_ZEROS = {"string": "", "wstring": "", "bool": False, "float32": 0.0, "float64": 0.0}
_DTYPES = {"char": "uint8", "byte": "uint8", "octet": "uint8"}


@cache
def types_of(generation: Generation) -> Types:
    """Return the types of a generation, read once a process."""
    return Types(generation)
