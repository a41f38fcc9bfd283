"""Claims about how long a frame waits for those who are about to listen."""

import pytest

from linden.server.subscribers import MOST_IN_VAIN, SUBSCRIPTION_WAIT_S, Expected

CLIENT, OTHER = 1, 2


def test_a_client_without_a_request_is_not_waited_for() -> None:
    assert Expected().wait_s(5.0) is None


def test_a_frame_waits_until_all_expected_subscribers_have_come() -> None:
    expected = Expected()
    expected.asked(3, CLIENT, 10.0)
    expected.asked(4, CLIENT, 10.01)
    expected.came(3)
    assert expected.wait_s(10.02) == pytest.approx(SUBSCRIPTION_WAIT_S - 0.01)
    expected.came(4)
    assert expected.wait_s(10.02) is None


def test_an_expected_subscriber_that_does_not_come_is_given_up() -> None:
    expected = Expected()
    expected.asked(3, CLIENT, 10.0)
    assert expected.wait_s(10.0 + SUBSCRIPTION_WAIT_S) is None


def test_a_repeated_request_makes_no_frame_wait_longer() -> None:
    expected = Expected()
    expected.asked(3, CLIENT, 10.0)
    expected.asked(3, CLIENT, 10.4)
    assert expected.wait_s(10.4) == pytest.approx(SUBSCRIPTION_WAIT_S - 0.4)


def test_a_subscription_of_one_client_does_not_end_the_wait_for_another_on_the_same_stream() -> None:
    expected = Expected()
    expected.asked(3, CLIENT, 10.0)
    expected.asked(3, OTHER, 10.1)
    expected.came(3)
    assert expected.wait_s(10.1) == SUBSCRIPTION_WAIT_S
    expected.came(3)
    assert expected.wait_s(10.1) is None


def test_a_client_that_failed_to_come_a_few_times_is_not_waited_for_until_it_comes_once() -> None:
    expected, now_s = Expected(), 0.0
    for stream_id in range(MOST_IN_VAIN):
        expected.asked(stream_id, CLIENT, now_s)
        now_s += SUBSCRIPTION_WAIT_S
        assert expected.wait_s(now_s) is None
    expected.asked(77, CLIENT, now_s)
    assert expected.wait_s(now_s) is None
    expected.asked(78, OTHER, now_s)
    assert expected.wait_s(now_s) == SUBSCRIPTION_WAIT_S


def test_a_client_that_comes_once_is_waited_for_again() -> None:
    expected = Expected()
    for stream_id in range(MOST_IN_VAIN - 1):
        expected.asked(stream_id, CLIENT, 0.0)
    assert expected.wait_s(SUBSCRIPTION_WAIT_S) is None
    expected.asked(7, CLIENT, SUBSCRIPTION_WAIT_S)
    expected.came(7)
    for stream_id in range(MOST_IN_VAIN - 1):
        expected.asked(stream_id, CLIENT, 1.0)
    assert expected.wait_s(1.0 + SUBSCRIPTION_WAIT_S) is None
    expected.asked(8, CLIENT, 2.0)
    assert expected.wait_s(2.0) == SUBSCRIPTION_WAIT_S


def test_a_client_that_has_gone_is_not_waited_for() -> None:
    expected = Expected()
    expected.asked(3, CLIENT, 10.0)
    expected.forget(CLIENT)
    assert expected.wait_s(10.0) is None
