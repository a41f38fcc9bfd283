"""Messages of RTPS 2.3 as bytes: the submessages and parameter lists that services need.

Source: OMG DDSI-RTPS 2.3, sections 8.3.7, 9.4 and 9.6; the related sample identity is of OMG DDS-RPC 1.0,
section 7.8.2.
"""

from __future__ import annotations

import socket
import struct
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

MAGIC = b"RTPS\x02\x03"
VENDOR = b"\x00\x00"
"""No vendor (9.3.1.3): a peer assumes nothing that the standard does not say."""
LITTLE = 1
"""Flag of every submessage: little endian."""
ACKNACK, HEARTBEAT, GAP, INFO_TS, INFO_SRC, INFO_DST, DATA = 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x15
HAS_INLINE_QOS, HAS_DATA, IS_FINAL = 2, 4, 2
TO_INLINE_QOS = 16
"""Bytes between the field octetsToInlineQos and the inline QoS."""
PL_CDR_LE = b"\x00\x03\x00\x00"
SENTINEL = 1
ANY_READER = b"\0\0\0\0"
"""The entity of no reader: all readers of the writer."""
LARGEST_SET = 256
"""Numbers that one set of sequence numbers can hold (9.4.2.6)."""
KEY_HASH, STATUS_INFO = 0x70, 0x71
DEFAULT_LOCATOR, META_LOCATOR = 0x31, 0x32
LOCATORS = (DEFAULT_LOCATOR, META_LOCATOR)
RELATED_SAMPLE, RELATED_SAMPLE_OF_FAST_DDS = 0x83, 0x800F
"""Fast DDS had a number of its own before the standard had one; older nodes know that one only."""
UDP_V4 = 1


class WireError(Exception):
    """Bytes that are no RTPS, or not whole."""


class Guid(NamedTuple):
    """The identifier of a reader, a writer or a participant."""

    prefix: bytes
    """12 bytes, the participant's."""
    entity: bytes
    """4 bytes."""

    @property
    def bytes(self) -> bytes:
        """The 16 bytes of both."""
        return self.prefix + self.entity


class Sample(NamedTuple):
    """DATA: one sample of a writer."""

    reader: bytes
    writer: Guid
    number: int
    inline_qos: Mapping[int, bytes]
    payload: bytes
    """CDR with its header of 4 bytes; empty where the sample says that something has left."""


class Heartbeat(NamedTuple):
    """HEARTBEAT: the samples that a writer has."""

    reader: bytes
    writer: Guid
    first: int
    last: int
    is_final: bool


class Acknowledgement(NamedTuple):
    """ACKNACK: a reader has all samples below ``base``, and asks for missing samples."""

    reader: Guid
    writer: bytes
    base: int
    missing: tuple[int, ...]


Submessage = Sample | Heartbeat | Acknowledgement


def parsed(data: bytes, own_prefix: bytes) -> Iterator[Submessage]:
    """Yield the submessages for us in a datagram; kinds that services do not need are skipped.

    Raises:
        WireError: the bytes are no RTPS.
    """
    if len(data) < 20 or data[:4] != MAGIC[:4]:
        raise WireError(f"{len(data)} bytes that do not begin with RTPS")
    source, is_ours, at = data[8:20], True, 20
    try:
        while at + 4 <= len(data):
            kind, flags = data[at], data[at + 1]
            order = "<" if flags & LITTLE else ">"
            (size,) = struct.unpack_from(f"{order}H", data, at + 2)
            size = size or len(data) - at - 4  # of the last submessage (8.3.3.2.3)
            body = data[at + 4 : at + 4 + size]
            at += 4 + size
            if kind == INFO_DST:
                is_ours = body[:12] in (own_prefix, bytes(12))
            elif kind == INFO_SRC:
                source = body[8:20]
            elif is_ours and kind == DATA:
                yield _sample(body, order, flags, source)
            elif is_ours and kind == HEARTBEAT:
                first, last = _number(body, order, 8), _number(body, order, 16)
                yield Heartbeat(body[:4], Guid(source, body[4:8]), first, last, bool(flags & IS_FINAL))
            elif is_ours and kind == ACKNACK:
                yield Acknowledgement(Guid(source, body[:4]), body[4:8], *_number_set(body, order, 8))
    except struct.error as error:
        raise WireError(f"a submessage ends too early: {error}") from error


def _sample(body: bytes, order: str, flags: int, source: bytes) -> Sample:
    (skip,) = struct.unpack_from(f"{order}H", body, 2)
    at = 4 + int(skip)
    inline_qos: dict[int, bytes] = {}
    if flags & HAS_INLINE_QOS:
        inline_qos, at = _parameters(body, order, at)
    payload = body[at:] if flags & HAS_DATA else b""
    return Sample(body[4:8], Guid(source, body[8:12]), _number(body, order, 12), inline_qos, payload)


def _number(body: bytes, order: str, at: int) -> int:
    """A sequence number."""
    high, low = struct.unpack_from(f"{order}iI", body, at)
    return int(high << 32 | low)


def _number_set(body: bytes, order: str, at: int) -> tuple[int, tuple[int, ...]]:
    """The base of a set of sequence numbers, and the numbers in it."""
    base = _number(body, order, at)
    (count,) = struct.unpack_from(f"{order}I", body, at + 8)
    words = struct.unpack_from(f"{order}{(min(count, LARGEST_SET) + 31) // 32}I", body, at + 12)
    return base, tuple(base + i for i in range(min(count, LARGEST_SET)) if words[i // 32] >> 31 - i % 32 & 1)


def _parameters(body: bytes, order: str, at: int) -> tuple[dict[int, bytes], int]:
    """A parameter list by number, and the byte after it. Of several locators the first one of UDP counts."""
    found: dict[int, bytes] = {}
    while True:
        number, size = struct.unpack_from(f"{order}HH", body, at)
        at += 4
        if number == SENTINEL:
            return found, at
        value = body[at : at + size]
        if number not in LOCATORS or address_of(value, order) is not None:
            found.setdefault(number, value)
        at += size


def list_of_payload(payload: bytes) -> tuple[dict[int, bytes], str]:
    """Return the parameters of a payload of discovery, and the byte order of their values.

    Raises:
        WireError: the payload is no parameter list.
    """
    if payload[:2] not in (b"\x00\x03", b"\x00\x02"):
        raise WireError(f"a payload of discovery begins with {payload[:2].hex()}, which is no parameter list")
    order = "<" if payload[1] == PL_CDR_LE[1] else ">"
    try:
        return _parameters(payload, order, 4)[0], order
    except struct.error as error:
        raise WireError(f"a parameter list ends too early: {error}") from error


def message(prefix: bytes, destination: bytes, *submessages: bytes) -> bytes:
    """Return a datagram for one participant, or for all where ``destination`` is 12 zeros."""
    return b"".join((MAGIC, VENDOR, prefix, _submessage(INFO_DST, 0, destination), *submessages))


def sample(reader: bytes, writer: bytes, number: int, payload: bytes, inline_qos: bytes = b"") -> bytes:
    """Return DATA; ``inline_qos`` is a parameter list of `parameters`."""
    flags = (HAS_INLINE_QOS if inline_qos else 0) | (HAS_DATA if payload else 0)
    head = struct.pack("<HH", 0, TO_INLINE_QOS) + reader + writer + _packed(number)
    return _submessage(DATA, flags, head + inline_qos + payload)


def heartbeat(reader: bytes, writer: bytes, first: int, last: int, count: int) -> bytes:
    """Return HEARTBEAT, which asks the reader for an answer."""
    body = reader + writer + _packed(first) + _packed(last) + struct.pack("<I", count)
    return _submessage(HEARTBEAT, 0, body)


def acknowledgement(reader: bytes, writer: bytes, base: int, missing: tuple[int, ...], count: int) -> bytes:
    """Return ACKNACK; at most `LARGEST_SET` numbers from ``base`` on are in it."""
    asked = [each - base for each in missing if each - base < LARGEST_SET]
    words = [0] * ((max(asked, default=-1) + 32) // 32)
    for each in asked:
        words[each // 32] |= 1 << 31 - each % 32
    size = max(asked, default=-1) + 1
    body = reader + writer + _packed(base) + struct.pack(f"<I{len(words)}II", size, *words, count)
    return _submessage(ACKNACK, 0 if asked else IS_FINAL, body)


def _submessage(kind: int, flags: int, body: bytes) -> bytes:
    body += bytes(-len(body) % 4)
    return struct.pack("<BBH", kind, flags | LITTLE, len(body)) + body


def _packed(number: int) -> bytes:
    return struct.pack("<iI", number >> 32, number & 0xFFFFFFFF)


def sample_identity(writer: Guid, number: int) -> bytes:
    """Return the identity of a sample: its writer and its number."""
    return writer.bytes + _packed(number)


def parameters(*pairs: tuple[int, bytes]) -> bytes:
    """Return a parameter list."""
    padded = ((number, value + bytes(-len(value) % 4)) for number, value in pairs)
    rows = [struct.pack("<HH", number, len(value)) + value for number, value in padded]
    return b"".join(rows) + struct.pack("<HH", SENTINEL, 0)


def text(value: str) -> bytes:
    """Return a text as a parameter."""
    data = value.encode() + b"\0"
    return struct.pack("<I", len(data)) + data


def text_of(value: bytes, order: str) -> str:
    """Return the text in a parameter.

    Raises:
        WireError: it is longer than the parameter.
    """
    try:
        (size,) = struct.unpack_from(f"{order}I", value)
    except struct.error as error:
        raise WireError("a text without a length") from error
    return value[4 : 3 + size].decode(errors="replace")


def locator(address: tuple[str, int]) -> bytes:
    """Return a locator of UDP over IPv4."""
    return struct.pack("<iI12x4s", UDP_V4, address[1], socket.inet_aton(address[0]))


def address_of(value: bytes, order: str) -> tuple[str, int] | None:
    """Return the address and port of a locator; None for another kind than UDP over IPv4."""
    if len(value) != 24:
        return None
    kind, port, address = struct.unpack(f"{order}iI12x4s", value)
    return (socket.inet_ntoa(address), port) if kind == UDP_V4 and 0 < port < 1 << 16 else None
