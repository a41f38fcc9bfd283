"""Limits for the log: warnings about failed calls once each, long lines shortened, repeated lines counted.

An asynchronous call that is refused has only the log to say so, and a script may send ten thousand of them, each about
another actor. So sentences that differ in their figures alone count as one kind, of which the first few are shown.

A filter that keeps the log short: long lines lose their middle, and of many lines of one kind a few are shown.

It sees every line of the server, so that no place that logs has to think of floods. Lines that differ in their figures
alone are of one kind. What a peer sends is shortened where it is quoted (``wire.decode.got``); here is the last net.
"""

import logging
import re
import time
from collections import Counter
from collections.abc import Callable

log = logging.getLogger("linden")

OF_A_KIND = 10
"""Sentences of one kind that are shown: enough to see what they have in common."""
KINDS = 200
"""Kinds of one run; more can only be noise, and are not shown."""
LONGEST = 8000
"""Characters of one sentence, traceback included; the names that clients send can be megabytes long."""

_FIGURES = re.compile(r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_CONTROL = {code: f"\\x{code:02x}" for code in (*range(32), *range(127, 160)) if chr(code) not in "\n\t"}
_KIND_CHARACTERS = 300  # what tells one kind from another


def shortened(sentence: str) -> str:
    """Return a sentence without its middle where it is very long."""
    if len(sentence) <= LONGEST:
        return sentence
    half = LONGEST // 2
    return f"{sentence[:half]} … ({len(sentence) - LONGEST} characters) … {sentence[-half:]}"


def plain(sentence: str) -> str:
    """Return a sentence without what steers a terminal."""
    return sentence.translate(_CONTROL)


def kind_of(sentence: str) -> str:
    """Return what a sentence has in common with sentences that differ from it in figures alone."""
    return _FIGURES.sub("#", sentence[:_KIND_CHARACTERS])


class WarningLog:
    """What one server has said."""

    def __init__(self) -> None:
        self._said: set[str] = set()
        self._of_kind: Counter[str] = Counter()

    def say(self, sentence: str) -> None:
        """Log a sentence, unless it or enough of its kind has been logged before."""
        sentence = shortened(sentence)
        if sentence in self._said:
            return
        kind = kind_of(sentence)
        if kind not in self._of_kind and len(self._of_kind) >= KINDS:
            return
        count = self._of_kind[kind] = min(self._of_kind[kind] + 1, OF_A_KIND + 1)
        if count > OF_A_KIND:
            return
        self._said.add(sentence)
        log.warning("%s", plain(sentence))
        if count == OF_A_KIND:
            log.warning("more of this kind are not shown")
        if len(self._of_kind) == KINDS and count == 1:
            log.warning("%d kinds of warnings: no further kinds are shown", KINDS)


LINES_OF_A_KIND = 10
"""Lines of one kind that are shown in a period."""
CHARACTERS = 100_000
"""Of all kinds together in a period: 6 MB in an hour at most."""
PERIOD_S = 60.0


class LogFilter(logging.Filter):
    """Lets a line pass or drops it. The level debug lets every line pass."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._began_s = -PERIOD_S
        self._shown: dict[str, int] = {}
        self._left_out = 0
        self._characters = 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a line is shown; shortens it, and has it say what was left out before it."""
        record.msg, record.args = plain(shortened(record.getMessage())), None
        if logging.getLogger("linden").isEnabledFor(logging.DEBUG):
            return True
        now_s = self._clock()
        if now_s - self._began_s >= PERIOD_S:
            self._began_s = now_s
            self._characters = 0
            self._shown.clear()
        kind = kind_of(record.msg)
        shown = self._shown.get(kind, 0)
        if shown >= LINES_OF_A_KIND or self._characters >= CHARACTERS:
            self._left_out += 1
            return False
        self._shown[kind] = shown + 1
        self._characters += len(record.msg)
        if self._left_out:
            record.msg += f" (before this line {self._left_out} were left out, of kinds that came often)"
            self._left_out = 0
        return True
