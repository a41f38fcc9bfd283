"""ROS 2 over DDS without ROS: a node with ROS 2's names, types and QoS, and its entry in the list of nodes.

The import raises UserError where cyclonedds is not installed.
"""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.errors import UserError
from basu.extras import CYCLONEDDS
from basu.ros.dds_types import dds_type
from basu.ros.topics import Topic
from basu.ros.types import Generation, types_of

try:
    from cyclonedds.core import (
        DDSException,
        InstanceState,
        Policy,
        Qos,
        ReadCondition,
        SampleState,
        ViewState,
        WaitSet,
    )
    from cyclonedds.domain import Domain, DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic as DdsTopic
    from cyclonedds.util import duration
except ImportError as error:
    raise UserError(CYCLONEDDS.missing) from error

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.ros.topics import Message

DOMAINS = 232  # the highest domain: its ports still lie below 65536 (DDSI-RTPS 2.3, 9.6.1.1)
DISCOVERY = Topic("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", is_latched=True, depth=1)
GID_BYTES = 24  # rmw_dds_common/Gid of Humble
NS_PER_S = 1_000_000_000
ONLY_HERE = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
"""The settings of Cyclone DDS for this machine alone: the loopback interface, without multicast."""

_domains: dict[int, Any] = {}


def domain_of_environment() -> int:
    """Return the domain that ``ROS_DOMAIN_ID`` names, 0 without it.

    Raises:
        UserError: it names none.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not text.isdecimal() or int(text) > DOMAINS:
        raise UserError(f"ROS_DOMAIN_ID is '{text}'; it must be a number from 0 to {DOMAINS}")
    return int(text)


def is_local() -> bool:
    """Return whether ROS is to stay on this machine, by ``ROS_LOCALHOST_ONLY`` or ``ROS_AUTOMATIC_DISCOVERY_RANGE``."""
    return (
        os.environ.get("ROS_LOCALHOST_ONLY", "").strip() == "1"
        or os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").strip().upper() == "LOCALHOST"
    )


class Node:
    """A node of ROS 2 on a domain: it publishes messages of any of our types and keeps what it receives."""

    kind, settings = "ROS 2", "ROS_DOMAIN_ID and ROS_LOCALHOST_ONLY"
    missed_s = 12.0  # a killed node's lease lasts 10 s

    def __init__(self, name: str, domain: int | None = None) -> None:
        """Join a domain, by default that of the environment.

        Raises:
            UserError: DDS finds no network.
        """
        self.types = types_of(Generation.ROS_2)
        self.name = name
        self.domain = domain_of_environment() if domain is None else domain
        self.realm = f"the domain {self.domain}"
        self._writers: dict[str, Any] = {}
        self._readers: dict[str, tuple[Topic, Any]] = {}
        self._waits: dict[tuple[Topic, ...], Any] = {}
        try:
            if is_local() and self.domain not in _domains:
                _domains[self.domain] = Domain(self.domain, ONLY_HERE)
            self._participant: Any = DomainParticipant(self.domain)
        except DDSException as error:
            raise UserError(
                f"DDS cannot join the domain {self.domain}: {error}; see ROS_DOMAIN_ID, CYCLONEDDS_URI and whether "
                "this machine has a network, or set ROS_LOCALHOST_ONLY=1"
            ) from error

    def announce(self, *topics: Topic) -> None:
        """Make writers, so that peers find the topics before the first message, and enter them in the list of nodes."""
        for topic in topics:
            self._writer(topic)
        self._enter()

    def listen(self, *topics: Topic) -> None:
        """Make readers, and enter them in the list of nodes."""
        for topic in topics:
            if topic.name not in self._readers:
                self._readers[topic.name] = (topic, DataReader(self._participant, self._topic(topic), _qos(topic)))
        self._enter()

    def publish(self, *messages: Message) -> None:
        """Publish messages on their topics."""
        for topic, content in messages:
            self._writer(topic).write(_sample(self.types, topic, content))

    def received(self, topic: Topic) -> list[Any]:
        """Return the messages that have arrived since the last call, the oldest first.

        DDS has compared their types with ours before: a peer with another version of a type is no peer.
        """
        _, reader = self._readers[topic.name]
        samples = reader.take(N=topic.depth)
        return [self.types.parsed(sample.data, topic.type) for sample in samples if hasattr(sample, "data")]

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
        return len(self._readers[topic.name][1].get_matched_publications())

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
        """Leave the domain."""
        self._waits, self._writers, self._readers, self._participant = {}, {}, {}, None

    def _writer(self, topic: Topic) -> Any:  # noqa: ANN401 - of cyclonedds
        """The writer of a topic, made at its first use."""
        if topic.name not in self._writers:
            self._writers[topic.name] = DataWriter(self._participant, self._topic(topic), _qos(topic))
        return self._writers[topic.name]

    def _topic(self, topic: Topic) -> Any:  # noqa: ANN401 - of cyclonedds
        """A topic as ROS 2 names it in DDS: with rt before its name (design.ros2.org, topic and service names)."""
        name = f"rt{topic.name}" if topic.name.startswith("/") else topic.name
        return DdsTopic(self._participant, name, dds_type(self.types, topic.type))

    def _enter(self) -> None:
        """Tell the readers and writers of this node to ROS 2's list of nodes."""
        own = [writer for name, writer in self._writers.items() if name != DISCOVERY.name]
        make = self.types.message
        node = make(
            "rmw_dds_common/msg/NodeEntitiesInfo",
            node_namespace="/",
            node_name=self.name,
            reader_gid_seq=[self._gid(reader) for _, reader in self._readers.values()],
            writer_gid_seq=[self._gid(writer) for writer in own],
        )
        entry = make(DISCOVERY.type, gid=self._gid(self._participant), node_entities_info_seq=[node])
        self._writer(DISCOVERY).write(_sample(self.types, DISCOVERY, entry))

    def _gid(self, entity: Any) -> Any:  # noqa: ANN401 - of cyclonedds in, a message out
        """The identifier of an entity as ROS 2 writes it."""
        data = np.zeros(GID_BYTES, dtype=np.uint8)
        data[:16] = np.frombuffer(entity.guid.bytes, dtype=np.uint8)
        return self.types.message("rmw_dds_common/msg/Gid", data=data)


def _sample(types: Any, topic: Topic, content: Any) -> Any:  # noqa: ANN401 - as above
    return dds_type(types, topic.type)(types.data(content))


def _qos(topic: Topic) -> Any:  # noqa: ANN401 - of cyclonedds
    """The QoS of a topic, as ROS 2's profiles have it."""
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)) if topic.is_reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if topic.is_latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(topic.depth),
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )
