"""Work in the background ends where it is not wanted any more."""

from threading import Event

import pytest

from linden.background import NotWantedError, checkpoint, in_background


def test_what_was_made_or_raised_is_had_from_the_future() -> None:
    assert in_background(lambda: 7).result(10) == 7
    with pytest.raises(ZeroDivisionError):
        in_background(lambda: 1 // 0).result(10)


def test_work_that_is_not_wanted_ends_at_its_next_checkpoint() -> None:
    unwanted = Event()

    def work_for_ever() -> None:
        while True:
            checkpoint()

    made = in_background(work_for_ever, unwanted)
    other = in_background(checkpoint, Event())
    unwanted.set()
    with pytest.raises(NotWantedError):
        made.result(10)
    assert other.result(10) is None
    checkpoint()  # here nothing is given up
