"""ROS 2 over DDS without ROS: a node with ROS 2's names, types and QoS, and its entry in the list of nodes."""

from __future__ import annotations

import os
import time
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from cyclonedds.core import (
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic
from cyclonedds.util import duration

from linden_ros2.dds_domain import domain_of_environment, joined
from linden_ros2.dds_peers import Publishers, SameType, user_data
from linden_ros2.dds_types import dds_type
from linden_ros2.topic import Topic
from linden_ros2.types import HUMBLE, KILTED, Generation, Types, types_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from linden_ros2.topic import Message

DISCOVERY = Topic("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", is_latched=True, depth=1)
BEFORE_IRON = ("foxy", "galactic", "humble")  # an identifier of an endpoint has 24 bytes there, 16 since
NS_PER_S = 1_000_000_000


class DdsNode:
    """A node of ROS 2 on a domain: it publishes messages of any of our types and keeps what it receives."""

    kind, settings = "ROS 2", "ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY"
    missed_s = 12.0  # a killed node's lease lasts 10 s

    def __init__(self, name: str, domain: int | None = None) -> None:
        """Join a domain, by default that of the environment.

        Raises:
            DdsError: DDS finds no network.
        """
        self.types = types_of(Generation.ROS_2)
        self.name = name
        self.domain = domain_of_environment() if domain is None else domain
        self.realm = f"the domain {self.domain}"
        self._writers: dict[str, Any] = {}
        self._readers: dict[str, tuple[Topic, Any]] = {}
        self._waits: dict[tuple[Topic, ...], Any] = {}
        self._same: dict[str, SameType] = {}
        self._publishers: Publishers | None = None
        self._of_services: tuple[list[bytes], list[bytes]] = ([], [])
        self._participant: Any = joined(self.domain)

    def announce(self, *topics: Topic) -> None:
        """Make writers, so that peers find the topics before the first message, and enter them in the list of nodes."""
        for topic in topics:
            self._writer(topic)
        self._enter()

    def listen(self, *topics: Topic) -> None:
        """Make readers, and enter them in the list of nodes."""
        for topic in topics:
            if topic.name not in self._readers:
                reader = DataReader(*self._endpoint(topic))
                self._readers[topic.name] = (topic, reader)
                self._same[topic.name] = SameType(self.types, topic.type, reader.get_matched_publication_data)
        self._enter()

    def enter_services(self, readers: list[bytes], writers: list[bytes]) -> None:
        """Enter endpoints of services, which another participant of this process has, in the list of nodes."""
        self._of_services = (readers, writers)
        self._enter()

    def drop(self, *topics: Topic) -> None:
        """Take back the readers and writers of topics."""
        for topic in topics:
            self._writers.pop(topic.name, None)
            self._readers.pop(topic.name, None)
            self._same.pop(topic.name, None)
        self._waits = {}
        self._enter()

    def publish(self, *messages: Message) -> None:
        """Publish messages on their topics."""
        for topic, content in messages:
            self._writer(topic).write(_sample(self.types, topic, content))

    def received(self, topic: Topic) -> list[Any]:
        """Return the messages that have arrived since the last call, the oldest first.

        A peer with another version of the type is no peer.
        """
        same = self._same[topic.name]
        samples = [each for each in self._readers[topic.name][1].take(N=topic.depth) if hasattr(each, "data")]
        ours = [each for each in samples if same.has(each.sample_info.publication_handle)]
        return [self.types.parsed(sample.data, topic.type) for sample in ours]

    def wait(self, topic: Topic, timeout_s: float) -> bool:
        """Wait until something has arrived on a topic; whether it has."""
        return self.wait_any([topic], timeout_s)

    def wait_any(self, topics: Sequence[Topic], timeout_s: float) -> bool:
        """Wait until something has arrived on one of the topics; whether it has."""
        waiting = self._waits.get(tuple(topics))
        if waiting is None:
            waiting = self._waits[tuple(topics)] = self._waiting(topics)
        return bool(waiting.wait(max(1, int(timeout_s * NS_PER_S))))

    def _waiting(self, topics: Sequence[Topic]) -> Any:  # noqa: ANN401 - of cyclonedds
        """What waits for several readers."""
        waiting = WaitSet(self._participant)
        for topic in topics:
            reader = self._readers[topic.name][1]
            waiting.attach(ReadCondition(reader, SampleState.Any | ViewState.Any | InstanceState.Any))
        return waiting

    def writers_of(self, topic: Topic) -> int:
        """Return how many peers publish on a topic that this node listens to."""
        return self._same[topic.name].count(self._readers[topic.name][1].get_matched_publications())

    def unheard(self, topic: Topic) -> list[str]:
        """Return why each peer that publishes on a topic, and that this node does not hear, does not fit."""
        if self._publishers is None:
            self._publishers = Publishers(self._participant)
        reader, same = self._readers[topic.name][1], self._same[topic.name]
        matched = [each for each in reader.get_matched_publications() if same.has(each)]
        peers = [reader.get_matched_publication_data(each) for each in matched]
        heard = {peer.key for peer in peers if peer is not None}
        return self._publishers.unheard(topic, _dds_topic(topic), self.types, heard)

    def readers_of(self, topic: Topic) -> int:
        """Return how many peers listen to a topic of this node."""
        return len(self._writer(topic).get_matched_subscriptions())

    def wait_for_readers(self, topic: Topic, timeout_s: float) -> bool:
        """Wait until a peer listens to a topic; whether one does."""
        until_s = time.monotonic() + timeout_s
        while not self.readers_of(topic):
            if time.monotonic() > until_s:
                return False
            time.sleep(0.01)  # DDS has no event for it that could be waited for together with a time limit
        return True

    def close(self) -> None:
        """Remove this node from its ROS 2 domain; it publishes and hears nothing more."""
        self._waits, self._writers, self._readers, self._same = {}, {}, {}, {}
        self._publishers = self._participant = None

    def _writer(self, topic: Topic) -> Any:  # noqa: ANN401 - of cyclonedds
        """The writer of a topic, made at its first use."""
        if topic.name not in self._writers:
            self._writers[topic.name] = DataWriter(*self._endpoint(topic))
        return self._writers[topic.name]

    def _endpoint(self, topic: Topic) -> tuple[Any, Any, Any]:
        """What a reader or a writer is made of."""
        types = _types_for(topic, self.types)
        made = DdsTopic(self._participant, _dds_topic(topic), dds_type(types, topic.type))
        return self._participant, made, _qos(topic, types)

    def _enter(self) -> None:
        """Tell the readers and writers of this node to ROS 2's list of nodes."""
        own = [writer for name, writer in self._writers.items() if name != DISCOVERY.name]
        readers, writers = self._of_services
        types = node_list_types()
        node = types.message(
            "rmw_dds_common/msg/NodeEntitiesInfo",
            node_namespace="/",
            node_name=self.name,
            reader_gid_seq=[_gid(guid) for guid in [*_guids(each[1] for each in self._readers.values()), *readers]],
            writer_gid_seq=[_gid(guid) for guid in [*_guids(own), *writers]],
        )
        entry = types.message(DISCOVERY.type, gid=_gid(self._participant.guid.bytes), node_entities_info_seq=[node])
        self._writer(DISCOVERY).write(_sample(types, DISCOVERY, entry))


def _guids(entities: Iterable[Any]) -> list[bytes]:
    """The identifiers of entities of Cyclone DDS."""
    return [entity.guid.bytes for entity in entities]


def _gid(guid: bytes) -> Any:  # noqa: ANN401 - a message
    """An identifier as ROS 2 writes it."""
    gid = node_list_types().message("rmw_dds_common/msg/Gid")
    gid.data[:16] = np.frombuffer(guid, dtype=np.uint8)
    return gid


@cache
def node_list_types() -> Types:
    """Return the types of ROS 2's list of nodes: those since Iron, or those before it where ``ROS_DISTRO`` says so."""
    is_old = os.environ.get("ROS_DISTRO", "").strip().lower() in BEFORE_IRON
    return Types(Generation.ROS_2, release=HUMBLE if is_old else KILTED)


def _types_for(topic: Topic, types: Types) -> Types:
    return node_list_types() if topic.name == DISCOVERY.name else types


def _dds_topic(topic: Topic) -> str:
    """The name of a topic as ROS 2 has it in DDS: with rt before it (design.ros2.org, topic and service names)."""
    return f"rt{topic.name}" if topic.name.startswith("/") else topic.name


def _sample(types: Any, topic: Topic, content: Any) -> Any:  # noqa: ANN401 - as above
    return dds_type(types, topic.type)(types.data(content))


def _qos(topic: Topic, types: Types) -> Any:  # noqa: ANN401 - of cyclonedds
    """The QoS of a topic, as ROS 2's profiles have it."""
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)) if topic.is_reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if topic.is_latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(topic.depth),
        user_data(types, topic.type),
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )
