"""What the log is told of calls that went wrong: each sentence once, and never so much that nobody can read it.

An asynchronous call that is refused has only the log to say so, and a script may send ten thousand of them, each about
another actor. So sentences that differ in their figures alone count as one kind, of which the first few are shown.
"""

import logging
import re
from collections import Counter

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
    """Return what a sentence has in common with those that differ from it in their figures alone."""
    return _FIGURES.sub("#", sentence[:_KIND_CHARACTERS])


class Complaints:
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
