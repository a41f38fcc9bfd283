"""Readers and writers of RTPS with reliable delivery, without sockets: what has come, what is to be sent.

Source: OMG DDSI-RTPS 2.3, sections 8.4.7 to 8.4.12. A writer keeps its last samples for readers that come late.
"""

from __future__ import annotations

from collections import OrderedDict

from linden_ros2 import rtps_wire as wire
from linden_ros2.rtps_wire import Guid

Outgoing = list[tuple[Guid, bytes]]
"""Submessages, each with the reader or writer that it is for."""
LARGEST_GAP = 1024
"""Samples that a reader still asks for; older ones count as lost."""


class ReliableWriter:
    """A writer that keeps its last samples, and sends them again to readers that miss them."""

    def __init__(self, entity: bytes, depth: int) -> None:
        self.entity, self._depth = entity, depth
        self._samples: OrderedDict[int, tuple[bytes, bytes]] = OrderedDict()
        self._last = 0
        self._acknowledged: dict[Guid, int] = {}
        self._count = 0

    def match(self, reader: Guid) -> Outgoing:
        """Add a reader; return the samples that it is sent."""
        if reader in self._acknowledged:
            return []
        self._acknowledged[reader] = 0
        return [(reader, self._data(reader, number)) for number in self._samples] + self._heartbeat(reader)

    def unmatch(self, reader: Guid) -> None:
        """Forget a reader."""
        self._acknowledged.pop(reader, None)

    def forget(self, prefix: bytes) -> None:
        """Forget the readers of a participant."""
        for reader in [each for each in self._acknowledged if each.prefix == prefix]:
            del self._acknowledged[reader]

    def write(self, payload: bytes, inline_qos: bytes = b"") -> Outgoing:
        """Keep a sample; return it for each reader."""
        self._last += 1
        self._samples[self._last] = (payload, inline_qos)
        while len(self._samples) > self._depth:
            self._samples.popitem(last=False)
        out: Outgoing = []
        for reader in self._acknowledged:
            out += [(reader, self._data(reader, self._last)), *self._heartbeat(reader)]
        return out

    def acknowledged(self, reader: Guid, base: int, missing: tuple[int, ...]) -> Outgoing:
        """Take what a reader has; return the samples that it misses."""
        if reader not in self._acknowledged:
            return []
        self._acknowledged[reader] = base - 1
        again = [number for number in missing if number in self._samples]
        return [(reader, self._data(reader, number)) for number in again] + (self._heartbeat(reader) if again else [])

    def overdue(self) -> Outgoing:
        """Return a heartbeat for each reader that has not all samples."""
        out: Outgoing = []
        for reader, number in self._acknowledged.items():
            if number < self._last:
                out += self._heartbeat(reader)
        return out

    def _data(self, reader: Guid, number: int) -> bytes:
        return wire.sample(reader.entity, self.entity, number, *self._samples[number])

    def _heartbeat(self, reader: Guid) -> Outgoing:
        self._count += 1
        first = next(iter(self._samples), self._last + 1)
        return [(reader, wire.heartbeat(reader.entity, self.entity, first, self._last, self._count))]


class ReliableReader:
    """A reader that takes each sample once, and asks for missing samples."""

    def __init__(self, entity: bytes) -> None:
        self.entity = entity
        self._next: dict[Guid, int] = {}
        self._beyond: dict[Guid, set[int]] = {}
        self._count = 0

    def is_new(self, sample: wire.Sample) -> bool:
        """Note a sample; return whether it had not come before."""
        expected, beyond = self._next.setdefault(sample.writer, 1), self._beyond.setdefault(sample.writer, set())
        if sample.number < expected or sample.number in beyond:
            return False
        beyond.add(sample.number)
        self._advance(sample.writer, min(beyond) if len(beyond) > LARGEST_GAP else expected)
        return True

    def heard(self, beat: wire.Heartbeat) -> Outgoing:
        """Take which samples a writer has; return the question for the missing samples."""
        writer = beat.writer
        expected, beyond = self._next.setdefault(writer, 1), self._beyond.setdefault(writer, set())
        self._advance(writer, max(expected, beat.first, beat.last - LARGEST_GAP))
        expected = self._next[writer]
        upper = min(beat.last, expected + wire.LARGEST_SET - 1)
        missing = tuple(number for number in range(expected, upper + 1) if number not in beyond)
        if beat.is_final and not missing:
            return []
        return [(writer, self.question(writer, missing))]

    def question(self, writer: Guid, missing: tuple[int, ...] = ()) -> bytes:
        """Return which samples of a writer are here, and which ones the reader misses."""
        self._count += 1
        return wire.acknowledgement(self.entity, writer.entity, self._next.get(writer, 1), missing, self._count)

    def forget(self, prefix: bytes) -> None:
        """Forget the writers of a participant."""
        for writer in [each for each in self._next if each.prefix == prefix]:
            del self._next[writer], self._beyond[writer]

    def _advance(self, writer: Guid, expected: int) -> None:
        """Move on to the first number that has not come."""
        beyond = self._beyond[writer]
        while expected in beyond:
            expected += 1
        self._next[writer] = expected
        self._beyond[writer] = {each for each in beyond if each > expected}
