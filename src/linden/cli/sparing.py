"""A filter that keeps the log short: long lines lose their middle, and of many lines of one kind a few are shown.

It sees every line of the server, so that no place that logs has to think of floods. Lines that differ in their figures
alone are of one kind. What a peer sends is shortened where it is quoted (``wire.decode.got``); here is the last net.
"""

import logging
import time
from collections.abc import Callable

from linden.handlers.complaints import kind_of, plain, shortened

OF_A_KIND = 10
"""Lines of one kind that are shown in a period."""
CHARACTERS = 100_000
"""Of all kinds together in a period: 6 MB in an hour at most."""
PERIOD_S = 60.0


class Sparing(logging.Filter):
    """Lets a line pass or leaves it out; whoever wants everything takes the level debug."""

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
        if shown >= OF_A_KIND or self._characters >= CHARACTERS:
            self._left_out += 1
            return False
        self._shown[kind] = shown + 1
        self._characters += len(record.msg)
        if self._left_out:
            record.msg += f" (before this line {self._left_out} were left out, of kinds that came often)"
            self._left_out = 0
        return True
