"""RTPS without sockets: bytes there and back, samples that are lost, repeated, or came before the reader."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden_ros2 import rtps_wire as wire
from linden_ros2.rtps_endpoints import LARGEST_GAP, Outgoing, ReliableReader, ReliableWriter
from linden_ros2.rtps_wire import Acknowledgement, Guid, Heartbeat, Sample, WireError

SERVER, CLIENT = b"S" * 12, b"C" * 12
WRITER, READER = b"\0\0\1\3", b"\0\0\1\4"
TO = Guid(CLIENT, READER)


def received(outgoing: Outgoing, source: bytes = SERVER, destination: bytes = CLIENT) -> list[wire.Submessage]:
    """What the other side reads."""
    return [
        each
        for _, submessage in outgoing
        for each in wire.parsed(wire.message(source, destination, submessage), destination)
    ]


class Link:
    """A writer, a reader, and a network that loses what a test says."""

    def __init__(self, depth: int = 50) -> None:
        self.writer, self.reader = ReliableWriter(WRITER, depth), ReliableReader(READER)
        self.payloads: list[bytes] = []

    def carry(self, outgoing: Outgoing, lost: tuple[int, ...] = ()) -> None:
        """Carry submessages to the reader, and its questions back, until nothing more is said."""
        for each in received(outgoing):
            if isinstance(each, Sample):
                if each.number in lost:
                    continue
                if self.reader.is_new(each):
                    self.payloads.append(each.payload)
            elif isinstance(each, Heartbeat):
                for answer in received(self.reader.heard(each), CLIENT, SERVER):
                    assert isinstance(answer, Acknowledgement)
                    self.carry(self.writer.acknowledged(answer.reader, answer.base, answer.missing))


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    with contextlib.suppress(WireError):
        list(wire.parsed(wire.MAGIC + bytes(14) + data, CLIENT))
    with pytest.raises(WireError):
        list(wire.parsed(data, CLIENT))


@given(st.binary(max_size=60), st.sampled_from([b"\0\3\0\0", b"\0\2\0\0"]))
def test_any_parameters_are_read_or_refused(data: bytes, header: bytes) -> None:
    with contextlib.suppress(WireError):
        found, order = wire.list_of_payload(header + data)
        assert isinstance(wire.text_of(found[5], order) if 5 in found else "", str)


def test_a_sample_arrives_with_the_request_that_it_answers() -> None:
    identity = wire.sample_identity(TO, 2**32 + 7)
    inline_qos = wire.parameters((wire.RELATED_SAMPLE, identity))
    [found] = received([(TO, wire.sample(READER, WRITER, 2**32 + 1, b"payload!", inline_qos))])
    assert found == Sample(READER, Guid(SERVER, WRITER), 2**32 + 1, {wire.RELATED_SAMPLE: identity}, b"payload!")
    assert identity[:16] == TO.bytes


def test_submessages_for_another_participant_are_skipped() -> None:
    data = wire.message(SERVER, b"X" * 12, wire.heartbeat(READER, WRITER, 1, 1, 1))
    assert not list(wire.parsed(data, CLIENT))
    assert list(wire.parsed(wire.message(SERVER, bytes(12), wire.heartbeat(READER, WRITER, 1, 1, 1)), CLIENT))


def test_a_peer_with_big_endian_submessages_is_read() -> None:
    body = READER + WRITER + b"\0\0\0\0\0\0\0\1" + b"\0\0\0\0\0\0\0\5" + b"\0\0\0\1"
    [found] = wire.parsed(wire.MAGIC + wire.VENDOR + SERVER + b"\x07\0\0\x1c" + body, CLIENT)
    assert found == Heartbeat(READER, Guid(SERVER, WRITER), 1, 5, is_final=False)


@given(st.sets(st.integers(1, 255)))
def test_a_question_names_each_missing_number(missing: set[int]) -> None:
    asked = tuple(sorted(missing))
    data = wire.message(CLIENT, SERVER, wire.acknowledgement(READER, WRITER, 1, asked, 1))
    assert list(wire.parsed(data, SERVER)) == [Acknowledgement(TO, WRITER, 1, asked)]


def test_a_locator_that_is_not_udp_is_passed_over() -> None:
    shared = b"\x10\0\0\0" + bytes(20)
    listed = wire.parameters((wire.META_LOCATOR, shared), (wire.META_LOCATOR, wire.locator(("127.0.0.1", 7412))))
    found, order = wire.list_of_payload(wire.PL_CDR_LE + listed)
    assert wire.address_of(found[wire.META_LOCATOR], order) == ("127.0.0.1", 7412)


@given(st.sets(st.integers(1, 20)))
def test_lost_samples_are_sent_again(lost: set[int]) -> None:
    link = Link()
    link.carry(link.writer.match(TO))
    for number in range(1, 21):
        link.carry(link.writer.write(b"%4d" % number), tuple(lost))
    assert sorted(link.payloads) == [b"%4d" % number for number in range(1, 21)]
    assert not link.writer.overdue()


def test_a_late_reader_gets_what_the_writer_still_has() -> None:
    link = Link(depth=3)
    for number in range(1, 8):
        link.writer.write(b"%4d" % number)
    link.carry(link.writer.match(TO))
    assert link.payloads == [b"   5", b"   6", b"   7"]
    assert not link.writer.match(TO)


def test_a_writer_repeats_its_heartbeat_until_a_silent_reader_has_left() -> None:
    link = Link()
    link.writer.match(TO)
    link.writer.write(b"1234")
    assert [type(each) for each in received(link.writer.overdue())] == [Heartbeat]
    link.writer.forget(CLIENT)
    assert not link.writer.overdue()
    assert not link.writer.acknowledged(TO, 1, (1,))


def test_a_sample_that_comes_twice_counts_once() -> None:
    reader = ReliableReader(READER)
    sample = Sample(READER, Guid(SERVER, WRITER), 1, {}, b"")
    assert [reader.is_new(sample), reader.is_new(sample)] == [True, False]
    reader.forget(SERVER)
    assert reader.is_new(sample)


@pytest.mark.parametrize("number", [LARGEST_GAP * 4, 2**62])
def test_numbers_far_ahead_take_no_memory(number: int) -> None:
    reader = ReliableReader(READER)
    for each in range(number, number + 2 * LARGEST_GAP, 2):
        assert reader.is_new(Sample(READER, Guid(SERVER, WRITER), each, {}, b""))
    [(_, question)] = reader.heard(Heartbeat(READER, Guid(SERVER, WRITER), 1, number + 2**40, is_final=False))
    assert len(question) < 100
