"""Claims about how long a frame waits for those who are about to listen."""

import pytest

from linden.server.expected import PATIENCE_S, Expected


def test_nobody_is_waited_for_who_has_not_asked() -> None:
    assert Expected().wait_s(5.0) is None


def test_a_frame_waits_until_all_who_asked_have_come() -> None:
    expected = Expected()
    expected.asked(3, 10.0)
    expected.asked(4, 10.01)
    expected.came(3)
    assert expected.wait_s(10.02) == pytest.approx(PATIENCE_S - 0.01)
    expected.came(4)
    assert expected.wait_s(10.02) is None


def test_whoever_asks_and_does_not_come_is_given_up() -> None:
    expected = Expected()
    expected.asked(3, 10.0)
    assert expected.wait_s(10.0 + PATIENCE_S) is None
