"""Peers on a topic of ROS 2: whether their version of its type is ours, and why a publisher cannot be heard."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import InstanceState, Policy, ReadCondition, SampleState, ViewState

from linden_ros2.dds_types import dds_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from linden_ros2.topic import Topic
    from linden_ros2.types import Types

TYPE_HASH = re.compile(rb"typehash=(RIHS01_[0-9a-f]{64});")  # in the user data of an endpoint: REP 2016, rmw since Iron
MOST = 1000  # publishers that are looked through


def user_data(types: Types, name: str) -> Any:  # noqa: ANN401 - of cyclonedds
    """Return the policy by which an endpoint tells the hash of its type, as ROS 2 does since Iron."""
    return Policy.Userdata(f"typehash={types.store.hash_rihs01(name)};".encode())


class SameType:
    """Whether the peers of a reader or writer have our version of the type.

    Cyclone DDS compares the types of its own peers. Those of Fast DDS are joined by the type's name alone; since Iron
    they tell the hash of the type. A peer without one is trusted.
    """

    def __init__(self, types: Types, name: str, data_of: Callable[[int], Any]) -> None:
        """Compare with the type ``name``; ``data_of`` returns what DDS knows of a peer, by its handle."""
        self._hash, self._data_of = types.store.hash_rihs01(name).encode(), data_of
        self._known: dict[int, bool] = {}

    def has(self, handle: int) -> bool:
        """Return whether a peer has our version."""
        if handle not in self._known:
            peer = self._data_of(handle)
            if peer is None:  # it has left
                return True
            self._known[handle] = _type_hash(peer.qos) in (None, self._hash)
        return self._known[handle]

    def count(self, handles: list[int]) -> int:
        """Return how many peers have our version."""
        return sum(map(self.has, handles))


class Publishers:
    """All publishers of a domain that DDS knows, heard or not."""

    def __init__(self, participant: Any) -> None:  # noqa: ANN401 - of cyclonedds
        """Listen to what ``participant`` discovers."""
        self._reader = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        self._alive = ReadCondition(self._reader, SampleState.Any | ViewState.Any | InstanceState.Alive)

    def unheard(self, topic: Topic, dds_topic: str, types: Types, heard: set[Any]) -> list[str]:
        """Return why each publisher on a topic is not heard by a reader of ours; ``heard`` are its peers."""
        found = self._reader.read(N=MOST, condition=self._alive)
        return [
            _reason(topic, types, each)
            for each in found
            if getattr(each, "topic_name", None) == dds_topic and each.key not in heard
        ]


def _reason(topic: Topic, types: Types, publisher: Any) -> str:  # noqa: ANN401 - of cyclonedds
    """Why a publisher does not fit."""
    qos, wanted = publisher.qos, dds_name(topic.type).replace(".", "::")
    if publisher.type_name != wanted:
        return f"with the type {_ros_name(publisher.type_name)}; it must be {topic.type}"
    if topic.is_reliable and qos[Policy.Reliability] == Policy.Reliability.BestEffort:
        return "with the QoS reliability BEST_EFFORT; it must be RELIABLE"
    if topic.is_latched and qos[Policy.Durability] == Policy.Durability.Volatile:
        return "with the QoS durability VOLATILE; it must be TRANSIENT_LOCAL"
    told, own = _type_hash(qos), types.store.hash_rihs01(topic.type)
    if told not in (None, own.encode()):
        return f"with another version of {topic.type}: its type hash is {told.decode()}, it must be {own}"
    return f"with another definition of {topic.type}, or a QoS that does not fit"


def _type_hash(qos: Any) -> Any:  # noqa: ANN401 - of cyclonedds in, bytes or None out
    """Return the type hash in an endpoint's user data; None if it has none."""
    found = TYPE_HASH.search(qos[Policy.Userdata].data) if Policy.Userdata in qos else None
    return None if found is None else found[1]


def _ros_name(name: str) -> str:
    """A type as ROS writes it, of its name in DDS."""
    return name.replace("::dds_::", "::").removesuffix("_").replace("::", "/")
