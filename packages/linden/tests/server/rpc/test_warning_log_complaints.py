"""Claims about what the log is told: every kind of sentence, and never a flood."""

import pytest

from linden.server.rpc.warning_log import KINDS, LONGEST, OF_A_KIND, WarningLog, shortened


def test_the_same_sentence_is_shown_once(caplog: pytest.LogCaptureFixture) -> None:
    complaints = WarningLog()
    for _ in range(3):
        complaints.say("the door is stuck")
    assert caplog.messages == ["the door is stuck"]


def test_sentences_that_differ_in_their_figures_alone_are_shown_until_they_are_enough(
    caplog: pytest.LogCaptureFixture,
) -> None:
    complaints = WarningLog()
    for number in range(10_000):
        complaints.say(f"actor {number} stands at {number / 7}")
    complaints.say("a walker has no wheels")
    assert len(caplog.messages) == OF_A_KIND + 2
    assert caplog.messages[-2:] == ["more of this kind are not shown", "a walker has no wheels"]


def test_noise_of_a_thousand_kinds_ends_too(caplog: pytest.LogCaptureFixture) -> None:
    complaints = WarningLog()
    for number in range(1000):
        complaints.say("x" * number)
    assert len(caplog.messages) == KINDS + 1
    assert caplog.messages[-1] == f"{KINDS} kinds of warnings: no further kinds are shown"


def test_a_sentence_of_megabytes_loses_its_middle(caplog: pytest.LogCaptureFixture) -> None:
    WarningLog().say("begin" + "x" * 10_000_000 + "end")
    (said,) = caplog.messages
    assert len(said) < LONGEST + 100
    assert said.startswith("begin")
    assert said.endswith("end")
    assert shortened("short") == "short"


def test_what_clients_send_cannot_steer_a_terminal(caplog: pytest.LogCaptureFixture) -> None:
    WarningLog().say("map '\x1b[2J\r' not found\n")
    assert caplog.messages == ["map '\\x1b[2J\\x0d' not found\n"]
