"""DDS types of ROS messages: the structures that ROS 2 puts on the wire, made of the definitions, with ready bytes."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

from cyclonedds import idl
from cyclonedds.idl import types as idl_types

if TYPE_CHECKING:
    from linden_ros2.types import Types

dds: Any = idl_types  # its generics are no generics to the type checker
TEXTS = ("string", "wstring")


def dds_name(name: str) -> str:
    """Return the DDS name of a ROS type: ``std_msgs/msg/Header`` is ``std_msgs::msg::dds_::Header_`` (rmw)."""
    package, kind, message = name.split("/")
    return f"{package}.{kind}.dds_.{message}_"


@cache
def dds_type(types: Types, name: str) -> Any:  # noqa: ANN401 - a class of cyclonedds
    """Return the class of a topic's samples, for messages of the type ``name``."""
    made = idl_structure(types, name)
    made.__init__, made.serialize = _hold, _held
    made.deserialize = made.deserialize_key = classmethod(_of_bytes)  # the second one when a writer has left
    return made


def _hold(self: Any, data: Any) -> None:  # noqa: ANN401 - a sample, and its bytes
    """Let a sample be its bytes: CDR with its header, made or read by ROS's serialiser.

    The serialiser of the wheel takes 68 ms for a point cloud of 60,000 points.
    """
    self.data = data


def _held(self: Any, *_: object, **__: object) -> bytes:  # noqa: ANN401 - a sample
    return bytes(self.data)


def _of_bytes(cls: Any, /, data: bytes, *_: object, **__: object) -> Any:  # noqa: ANN401 - the class, and a sample
    return cls(data)


def idl_structure(types: Types, name: str) -> Any:  # noqa: ANN401 - a class of cyclonedds
    """Return a new structure with the fields of a message."""
    fields = {key: _member(types, kind) for key, kind in types.store.fielddefs[name][1]}
    return idl.make_idl_struct(name.rpartition("/")[2], dds_name(name), fields)


def _member(known: Types, kind: Any) -> Any:  # noqa: ANN401 - a description of rosbags in, a type of cyclonedds out
    """The type of a field."""
    node, rest = int(kind[0]), kind[1]
    if node == 1:
        name, bound = rest
        if name in TEXTS:
            return dds.bounded_str[bound] if bound else str
        return bool if name == "bool" else getattr(dds, {"char": "uint8", "octet": "byte"}.get(name, name))
    if node == 2:
        return _inner(known, rest)
    inner = _member(known, rest[0])
    if node == 3:
        return dds.array[inner, rest[1]]
    return dds.sequence[inner, rest[1]] if rest[1] else dds.sequence[inner]


@cache
def _inner(types: Types, name: str) -> Any:  # noqa: ANN401 - as above
    """The structure of a message inside of others."""
    return idl_structure(types, name)
