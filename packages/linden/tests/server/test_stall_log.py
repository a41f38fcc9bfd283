"""Claims about what the log says of waiting; the clock is a number."""

import pytest

from linden.server.stall_log import HELD_UP_S, NO_TICK_S, Stall, StallLog


class FakePeer:
    """What the log needs of a connection."""

    def __init__(self, name: str, unread_bytes: int = 0, *, is_open: bool = True) -> None:
        self.name = name
        self.is_open = is_open
        self.outgoing = self
        self.waiting_bytes = unread_bytes

    def __str__(self) -> str:
        return self.name


DEAF = FakePeer("subscriber 7 at 127.0.0.1:5 of stream 3", 3 * 2**20)
DRIVER, OTHER = FakePeer("client 1 at 127.0.0.1:6"), FakePeer("client 2 at 127.0.0.1:8")


def test_a_stall_is_logged_once_when_it_has_lasted() -> None:
    stretch = Stall(5.0)
    assert [stretch.goes_on(now_s) for now_s in (100.0, 104.9, 105.0, 106.0)] == [False, False, True, False]
    assert stretch.ends(107.5) == 7.5
    assert stretch.ends(108.0) is None
    assert not stretch.goes_on(200.0)
    assert stretch.untold_s(201.0) == 4.0


def test_a_short_stretch_is_not_told_of_at_all() -> None:
    stretch = Stall(5.0)
    assert not stretch.goes_on(100.0)
    assert stretch.ends(104.0) is None


def test_a_tick_that_waits_names_the_client_and_its_end(caplog: pytest.LogCaptureFixture) -> None:
    waiting = StallLog()
    for now_s in (10.0, 10.0 + HELD_UP_S, 10.5 + HELD_UP_S):
        waiting.for_subscribers(now_s, [DEAF])
    waiting.for_subscribers(12.0, ())
    waiting.for_subscribers(13.0, ())
    assert caplog.messages == [
        "a tick waits for subscriber 7 at 127.0.0.1:5 of stream 3, with 3.0 MiB unread",
        "ticks go on after 2.0 s of waiting for subscribers",
    ]


def test_a_crowd_is_not_named_one_by_one(caplog: pytest.LogCaptureFixture) -> None:
    waiting = StallLog()
    for now_s in (0.0, HELD_UP_S):
        waiting.for_subscribers(now_s, [FakePeer(f"s{i}") for i in range(100)])
    assert caplog.messages == ["a tick waits for s0, s1, s2, s3, s4 and 95 more, with 0.0 MiB unread"]


def test_a_missing_tick_names_its_client_and_its_arrival(caplog: pytest.LogCaptureFixture) -> None:
    waiting = StallLog()
    for now_s, frame in ((0.0, 4), (3.0, 5), (3.0 + NO_TICK_S, 5), (20.0, 5), (33.0, 6), (34.0, 7)):
        waiting.for_a_tick(now_s, frame, [DRIVER, OTHER], DRIVER)
    assert caplog.messages == [
        "synchronous mode: no tick for 10 s after frame 5; waiting for client 1 at 127.0.0.1:6, which made that one",
        "the wait for a tick is over after 30.0 s",
    ]


@pytest.mark.parametrize(
    ("last", "whose"),
    [
        pytest.param(None, "no client has ticked yet; connected: client 2 at 127.0.0.1:8", id="before the first tick"),
        pytest.param(
            FakePeer("client 1 at 127.0.0.1:6", is_open=False),
            "client 1 at 127.0.0.1:6 made that one and has left; another may tick, or end synchronous mode: "
            "client 2 at 127.0.0.1:8",
            id="one who has left",
        ),
    ],
)
def test_clients_that_could_tick_instead_are_named(
    last: FakePeer | None, whose: str, caplog: pytest.LogCaptureFixture
) -> None:
    waiting = StallLog()
    for now_s in (0.0, NO_TICK_S):
        waiting.for_a_tick(now_s, 5, [OTHER], last)
    assert caplog.messages == [f"synchronous mode: no tick for 10 s after frame 5; {whose}"]


def test_nothing_is_said_of_an_empty_server_or_of_one_that_makes_frames_by_itself(
    caplog: pytest.LogCaptureFixture,
) -> None:
    waiting = StallLog()
    for now_s in range(100):
        waiting.for_a_tick(float(now_s), 5, (), None)
    assert waiting.untold_s(100.0) is None
    assert not caplog.messages
