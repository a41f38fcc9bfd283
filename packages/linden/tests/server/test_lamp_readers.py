"""Claims about the clients that a snapshot has told to read the lamps."""

import pytest

from linden.cli.process import GRACE_S
from linden.server.lamp_readers import READING_S, LampReaders


def test_nothing_is_waited_for_before_a_snapshot_tells_of_lamps() -> None:
    assert LampReaders().wait_s(5.0) == 0.0


def test_each_client_that_was_told_is_waited_for_until_it_has_read() -> None:
    readers = LampReaders()
    readers.told(2, 5.0)
    readers.has_read()
    assert readers.wait_s(5.1) == pytest.approx(READING_S - 0.1)
    readers.has_read()
    assert readers.wait_s(5.1) == 0.0


def test_each_snapshot_that_tells_of_lamps_makes_its_client_read_again() -> None:
    readers = LampReaders()
    readers.told(1, 5.0)
    readers.told(1, 5.2)
    readers.has_read()
    assert readers.wait_s(5.2) == pytest.approx(READING_S)


def test_a_call_that_no_snapshot_caused_leaves_the_next_client_expected() -> None:
    readers = LampReaders()
    readers.has_read()
    readers.told(1, 5.0)
    assert readers.wait_s(5.0) > 0.0


def test_clients_that_have_not_read_in_time_are_forgotten() -> None:
    readers = LampReaders()
    readers.told(3, 5.0)
    assert readers.wait_s(5.0 + READING_S) == 0.0
    readers.told(1, 9.0)
    readers.has_read()
    assert readers.wait_s(9.0) == 0.0


def test_the_wait_is_over_before_the_process_is_ended_by_force() -> None:
    assert READING_S < GRACE_S
