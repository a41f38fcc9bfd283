"""The log stays short, whatever is logged."""

import logging
from collections.abc import Iterator

import pytest

from linden.server.rpc.warning_log import CHARACTERS, LINES_OF_A_KIND, LONGEST, PERIOD_S, LogFilter

log = logging.getLogger("linden")


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Iterator[Clock]:
    clock = Clock()
    sparing = LogFilter(clock)
    before, log.filters[:] = log.filters[:], [sparing]  # a command that ran in this process leaves its own
    yield clock
    log.filters[:] = before


def test_of_many_lines_of_a_kind_a_few_are_shown_a_minute(clock: Clock, caplog: pytest.LogCaptureFixture) -> None:
    for number in range(1000):
        log.warning("client %d at 127.0.0.1:%d is closed", number, 50_000 + number)
    log.warning("something else")
    assert len(caplog.messages) == LINES_OF_A_KIND + 1
    assert caplog.messages[-1].startswith("something else (before this line 990 were left out")
    clock.now_s = PERIOD_S
    log.warning("client %d at 127.0.0.1:%d is closed", 7, 7)
    assert caplog.messages[-1] == "client 7 at 127.0.0.1:7 is closed"


def test_lines_of_any_number_of_kinds_are_not_many(clock: Clock, caplog: pytest.LogCaptureFixture) -> None:
    assert clock.now_s == 0.0
    for number in range(20_000):
        log.warning("%s", "x" * (number % 50) + chr(0x4E00 + number % 20_000) * 30)
    assert sum(map(len, caplog.messages)) < CHARACTERS + LONGEST + 200


def test_long_lines_lose_their_middle_and_none_steers_a_terminal(
    clock: Clock, caplog: pytest.LogCaptureFixture
) -> None:
    assert clock.now_s == 0.0
    log.warning("%s", "\x1b[2J" + "x" * 1_000_000)
    assert len(caplog.messages[0]) < LONGEST + 100
    assert caplog.messages[0].startswith("\\x1b[2Jxxx")
