"""`ServiceParticipant`: offers services of ROS 2 on a domain, in the form of `rmw_fastrtps`.

A service is two topics: requests, and replies. A reply names its request by the related sample identity, which RTPS
carries in the inline QoS. Cyclone DDS can neither write nor read it, so this participant speaks RTPS itself.
"""

from __future__ import annotations

import contextlib
import queue
import secrets
import selectors
import socket
import struct
import threading
import time
from typing import NamedTuple

from linden_ros2 import rtps_wire as wire
from linden_ros2.dds_types import dds_name
from linden_ros2.rtps_endpoints import Outgoing, ReliableReader, ReliableWriter
from linden_ros2.rtps_wire import Guid, Sample

FIRST_PORT, DOMAIN_GAIN, PARTICIPANT_GAIN, UNICAST_OFFSET = 7400, 250, 2, 10
"""Well-known ports of DDSI-RTPS 2.3, section 9.6.1.1."""
PARTICIPANTS = 61
"""Participants of this machine that are called: as many as `dds_domain.ONLY_HERE` has."""
GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
ANNOUNCED_EACH_S, LEASE_S, RESENT_EACH_S = 1.0, 10.0, 0.2
LARGEST_DATAGRAM = 65507
GUID_BYTES = 16
WAITING_REQUESTS = 1000
"""Requests that wait for the server; more are dropped."""
KEPT_REPLIES = 50

PARTICIPANT = b"\x00\x00\x01\xc1"
SPDP_WRITER, SPDP_READER = b"\x00\x01\x00\xc2", b"\x00\x01\x00\xc7"
WRITERS_WRITER, WRITERS_READER = b"\x00\x00\x03\xc2", b"\x00\x00\x03\xc7"
READERS_WRITER, READERS_READER = b"\x00\x00\x04\xc2", b"\x00\x00\x04\xc7"
"""Built-in endpoints by which participants tell of their writers and readers (9.3.1.4)."""
READER_KIND, WRITER_KIND = 0x04, 0x03
BUILT_IN = 0x3F
"""That a participant has these six endpoints (9.3.2.12)."""

PID_LEASE, PID_TOPIC, PID_TYPE, PID_VERSION, PID_VENDOR = 0x02, 0x05, 0x07, 0x15, 0x16
PID_RELIABILITY, PID_DURABILITY, PID_USER_DATA = 0x1A, 0x1D, 0x2C
PID_PARTICIPANT, PID_BUILT_IN, PID_ENDPOINT = 0x50, 0x58, 0x5A
CYCLONE = b"\x01\x10"
"""The vendor of Cyclone DDS. Its rmw has a header in the payload of requests instead."""


class Service(NamedTuple):
    """A service: its name with a slash, and its type such as ``carla_msgs/srv/SpawnObject``."""

    name: str
    type: str


class Request(NamedTuple):
    """A request that waits for its reply."""

    service: Service
    client: Guid
    number: int
    payload: bytes
    """CDR with its header."""


class _Peer:
    """Another participant: where it listens, and when it was heard last."""

    def __init__(self, meta: tuple[str, int], default: tuple[str, int], lease_s: float) -> None:
        self.meta, self.default, self.lease_s = meta, default, lease_s
        self.heard_s = 0.0


class ServiceParticipant:
    """A participant of a domain that has the readers and writers of services, and a thread that serves them.

    Attributes:
        requests: what has come and has no reply yet.
    """

    def __init__(self, services: tuple[Service, ...], domain: int, *, is_local: bool) -> None:
        """Join the domain; ``is_local`` keeps to the loopback interface.

        Raises:
            OSError: this machine has no socket left.
        """
        self.requests: queue.Queue[Request] = queue.Queue(WAITING_REQUESTS)
        self._prefix = wire.VENDOR + b"\0\0" + secrets.token_bytes(8)
        self._guid = Guid(self._prefix, PARTICIPANT)
        self._is_local = is_local
        self._base_port = FIRST_PORT + DOMAIN_GAIN * domain
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((LOOPBACK if is_local else "", 0))
        self._socket.setblocking(False)
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._told_reader, self._told_writer = socket.socketpair()
        self._told_writer.setblocking(False)
        self._lock = threading.Lock()
        self._peers: dict[bytes, _Peer] = {}
        self._writers_writer = ReliableWriter(WRITERS_WRITER, 2 * len(services))
        self._readers_writer = ReliableWriter(READERS_WRITER, 2 * len(services))
        self._replies: dict[Service, ReliableWriter] = {}
        self._inputs: dict[bytes, tuple[Service | None, ReliableReader]] = {
            WRITERS_READER: (None, ReliableReader(WRITERS_READER)),
            READERS_READER: (None, ReliableReader(READERS_READER)),
        }
        for number, service in enumerate(services, start=1):
            self._offer(number, service)
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="services of ROS 2", daemon=True)
        self._thread.start()

    def fileno(self) -> int:
        """Return a file that can be read when requests have come; `arrived` returns them."""
        return self._told_reader.fileno()

    def arrived(self) -> list[Request]:
        """Return the requests that have come since the last call, the oldest first."""
        self._told_reader.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while self._told_reader.recv(4096):
                pass
        found = []
        with contextlib.suppress(queue.Empty):
            while True:
                found.append(self.requests.get_nowait())
        return found

    def reply(self, request: Request, payload: bytes) -> None:
        """Answer a request with CDR that has its header."""
        identity = wire.sample_identity(request.client, request.number)
        inline_qos = wire.parameters((wire.RELATED_SAMPLE_OF_FAST_DDS, identity), (wire.RELATED_SAMPLE, identity))
        with self._lock:
            self._send(self._replies[request.service].write(payload, inline_qos))

    def endpoints(self) -> tuple[list[bytes], list[bytes]]:
        """Return the identifiers of the readers and writers of all services."""
        readers = [Guid(self._prefix, entity).bytes for entity, (service, _) in self._inputs.items() if service]
        return readers, [Guid(self._prefix, writer.entity).bytes for writer in self._replies.values()]

    def close(self) -> None:
        """Tell the peers that this participant leaves, and end its thread."""
        self._closing = True
        self._wake_writer.send(b"\0")
        self._thread.join()
        for each in (self._socket, self._wake_reader, self._wake_writer, self._told_reader, self._told_writer):
            each.close()

    # -- what is offered -----------------------------------------------------------------------------------------

    def _offer(self, number: int, service: Service) -> None:
        """Make the reader and the writer of a service, and tell of them."""
        reader, writer = (struct.pack(">I", number << 8 | kind) for kind in (READER_KIND, WRITER_KIND))
        self._inputs[reader] = (service, ReliableReader(reader))
        self._replies[service] = ReliableWriter(writer, KEPT_REPLIES)
        self._readers_writer.write(self._described(reader, f"rq{service.name}Request", f"{service.type}_Request"))
        self._writers_writer.write(self._described(writer, f"rr{service.name}Reply", f"{service.type}_Response"))

    def _described(self, entity: bytes, topic: str, kind: str) -> bytes:
        """An endpoint as discovery tells of it: reliable, volatile."""
        return wire.PL_CDR_LE + wire.parameters(
            (PID_ENDPOINT, Guid(self._prefix, entity).bytes),
            (wire.KEY_HASH, Guid(self._prefix, entity).bytes),
            (PID_PARTICIPANT, self._guid.bytes),
            (PID_TOPIC, wire.text(topic)),
            (PID_TYPE, wire.text(dds_name(kind).replace(".", "::"))),
            (PID_RELIABILITY, struct.pack("<IiI", 2, 0, 429496730)),
            (PID_DURABILITY, struct.pack("<I", 0)),
        )

    def _announcement(self) -> bytes:
        """This participant as discovery tells of it."""
        port = self._socket.getsockname()[1]
        places = [wire.locator((address, port)) for address in self._addresses()]
        return wire.PL_CDR_LE + wire.parameters(
            (PID_VERSION, wire.MAGIC[4:6]),
            (PID_VENDOR, wire.VENDOR),
            (PID_PARTICIPANT, self._guid.bytes),
            *((number, place) for number in (wire.META_LOCATOR, wire.DEFAULT_LOCATOR) for place in places),
            (PID_LEASE, struct.pack("<iI", int(LEASE_S), 0)),
            (PID_BUILT_IN, struct.pack("<I", BUILT_IN)),
            (PID_USER_DATA, wire.text("enclave=/;")),
        )

    def _addresses(self) -> list[str]:
        """The addresses at which peers find this participant."""
        if self._is_local:
            return [LOOPBACK]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other, contextlib.suppress(OSError):
            other.connect((GROUP, self._base_port))  # sends nothing; the kernel chooses the interface
            return [other.getsockname()[0]]
        return [LOOPBACK]

    # -- the thread ----------------------------------------------------------------------------------------------

    def _run(self) -> None:
        """Announce, receive and answer until `close`."""
        announced_s = resent_s = 0.0
        with selectors.DefaultSelector() as selector:
            selector.register(self._socket, selectors.EVENT_READ)
            selector.register(self._wake_reader, selectors.EVENT_READ)
            while not self._closing:
                selector.select(RESENT_EACH_S)
                now_s = time.monotonic()
                with self._lock:
                    self._receive(now_s)
                    if now_s >= announced_s:
                        announced_s = now_s + ANNOUNCED_EACH_S
                        self._announce(self._announcement())
                        self._drop_silent(now_s)
                    if now_s >= resent_s:
                        resent_s = now_s + RESENT_EACH_S
                        for writer in (self._writers_writer, self._readers_writer, *self._replies.values()):
                            self._send(writer.overdue())
        left = wire.parameters((wire.KEY_HASH, self._guid.bytes), (wire.STATUS_INFO, b"\0\0\0\3"))
        self._announce(b"", left)

    def _announce(self, payload: bytes, inline_qos: bytes = b"") -> None:
        """Send a word about this participant to all that may be there, and to all that are known."""
        datagram = wire.message(
            self._prefix, bytes(12), wire.sample(SPDP_READER, SPDP_WRITER, 1 + bool(inline_qos), payload, inline_qos)
        )
        ports = range(self._base_port + UNICAST_OFFSET, 1 << 16, PARTICIPANT_GAIN)[:PARTICIPANTS]
        places = {(LOOPBACK, port) for port in ports} | {peer.meta for peer in self._peers.values()}
        if not self._is_local:
            places.add((GROUP, self._base_port))
        for place in sorted(places):
            self._transmit(datagram, place)

    def _drop_silent(self, now_s: float) -> None:
        """Forget the participants with an expired lease."""
        for prefix, peer in list(self._peers.items()):
            if now_s - peer.heard_s > peer.lease_s:
                self._forget(prefix)

    def _forget(self, prefix: bytes) -> None:
        self._peers.pop(prefix, None)
        for writer in (self._writers_writer, self._readers_writer, *self._replies.values()):
            writer.forget(prefix)
        for _, reader in self._inputs.values():
            reader.forget(prefix)

    def _receive(self, now_s: float) -> None:
        """Take all datagrams that have come. One that is no RTPS is dropped, as the standard says (8.3.4.1)."""
        with contextlib.suppress(BlockingIOError):
            while True:
                data = self._socket.recv(LARGEST_DATAGRAM)
                with contextlib.suppress(wire.WireError):
                    for each in wire.parsed(data, self._prefix):
                        self._take(each, now_s)

    def _take(self, each: wire.Submessage, now_s: float) -> None:
        """Take a submessage."""
        if isinstance(each, wire.Acknowledgement):
            for writer in (self._writers_writer, self._readers_writer, *self._replies.values()):
                if writer.entity == each.writer:
                    self._send(writer.acknowledged(each.reader, each.base, each.missing))
        elif isinstance(each, Sample) and each.writer.entity == SPDP_WRITER:
            self._participant(each, now_s)
        elif each.writer.prefix in self._peers:
            self._peers[each.writer.prefix].heard_s = now_s
            for entity, (service, reader) in self._inputs.items():
                if self._is_for(each, entity, service):
                    if isinstance(each, wire.Heartbeat):
                        self._send(reader.heard(each))
                    elif reader.is_new(each):
                        self._sample(each, service)

    def _is_for(self, each: Sample | wire.Heartbeat, entity: bytes, service: Service | None) -> bool:
        """Whether a reader of ours is meant. Built-in writers may name no reader."""
        if each.reader != wire.ANY_READER:
            return each.reader == entity
        counterpart = {WRITERS_READER: WRITERS_WRITER, READERS_READER: READERS_WRITER}
        return service is None and counterpart[entity] == each.writer.entity

    def _sample(self, sample: Sample, service: Service | None) -> None:
        """Take a new sample: a request, or a word about an endpoint."""
        if service is not None:
            if sample.payload:
                with contextlib.suppress(queue.Full, BlockingIOError):
                    self.requests.put_nowait(Request(service, sample.writer, sample.number, sample.payload))
                    self._told_writer.send(b"\0")
        elif sample.writer.entity == READERS_WRITER:
            self._reader_of_peer(sample)

    def _participant(self, sample: Sample, now_s: float) -> None:
        """Take a word about a participant: it is there, it is still there, or it has left."""
        prefix = sample.writer.prefix
        if prefix == self._prefix:
            return
        if any(sample.inline_qos.get(wire.STATUS_INFO, b"")):
            self._forget(prefix)
            return
        found, order = wire.list_of_payload(sample.payload)
        is_new = prefix not in self._peers
        if is_new:
            meta = wire.address_of(found.get(wire.META_LOCATOR, b""), order)
            default = wire.address_of(found.get(wire.DEFAULT_LOCATOR, b""), order)
            lease = found.get(PID_LEASE, b"")
            if meta is None or default is None or found.get(PID_VENDOR, b"")[:2] == CYCLONE:
                return
            lease_s = float(struct.unpack(f"{order}i", lease[:4])[0]) if len(lease) >= 4 else LEASE_S
            self._peers[prefix] = _Peer(self._reached(meta), self._reached(default), lease_s)
        self._peers[prefix].heard_s = now_s
        if is_new:
            self._send(self._writers_writer.match(Guid(prefix, WRITERS_READER)))
            self._send(self._readers_writer.match(Guid(prefix, READERS_READER)))
            for entity, writer in ((WRITERS_READER, WRITERS_WRITER), (READERS_READER, READERS_WRITER)):
                at = Guid(prefix, writer)
                self._send([(at, self._inputs[entity][1].question(at))])

    def _reached(self, address: tuple[str, int]) -> tuple[str, int]:
        """Where a peer is sent to; on this machine, nodes listen on all its addresses."""
        return (LOOPBACK, address[1]) if self._is_local else address

    def _reader_of_peer(self, sample: Sample) -> None:
        """Match a reader of replies, or forget it."""
        if any(sample.inline_qos.get(wire.STATUS_INFO, b"")):
            key = sample.inline_qos.get(wire.KEY_HASH, b"")
            for writer in self._replies.values():
                writer.unmatch(Guid(key[:12], key[12:]))
            return
        found, order = wire.list_of_payload(sample.payload)
        key, topic = found.get(PID_ENDPOINT, b""), wire.text_of(found.get(PID_TOPIC, b""), order)
        for service, writer in self._replies.items():
            if topic == f"rr{service.name}Reply" and key[:12] == sample.writer.prefix and len(key) == GUID_BYTES:
                self._send(writer.match(Guid(key[:12], key[12:])))

    def _send(self, outgoing: Outgoing) -> None:
        """Send submessages to the participants that they are for."""
        for to, submessage in outgoing:
            peer = self._peers.get(to.prefix)
            if peer is not None:
                is_built_in = to.entity[3] & 0xC0 == 0xC0
                datagram = wire.message(self._prefix, to.prefix, submessage)
                self._transmit(datagram, peer.meta if is_built_in else peer.default)

    def _transmit(self, datagram: bytes, place: tuple[str, int]) -> None:
        with contextlib.suppress(OSError):  # no socket listens there, or a buffer is full: it is sent again
            self._socket.sendto(datagram, place)
