"""Answers in words at the head of a result: was the drive safe, was it comfortable, was it on time?

They restate the judgement in words. The rule of success answers the first question, and metrics answer the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.metrics.display import NO, NOT_JUDGED, YES, Answer
from basu.metrics.success import NOT_COMPLETED
from basu.outcome import Status

if TYPE_CHECKING:
    from basu.metrics.result import Result


def answers(result: Result) -> tuple[Answer, ...]:
    """Return whether a drive was safe, and the answers of its metrics; nothing where nothing was driven."""
    if result.scores is None:
        return ()
    return _safe(result), *(answer for each in result.shown() for answer in each.answers(result))


def _safe(result: Result) -> Answer:
    """Answer by the rule of success, leaving out whether the drive was completed."""
    if result.case is not None:
        word = {True: YES, False: NO, None: NOT_JUDGED}[result.success.passed]
        return Answer("safe", word, str(result.case["message"]))
    wrong = [reason for reason in result.success.reasons if not reason.startswith(NOT_COMPLETED)]
    if wrong:
        more = f"; and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        return Answer("safe", NO, f"{wrong[0]}{more}")
    if result.success.passed is None:
        return Answer("safe", NOT_JUDGED, result.outcome.message)
    as_far = "" if result.outcome.status is Status.COMPLETED else ", as far as it drove"
    return Answer("safe", YES, f"no collision at fault, no broken traffic rule, always on its route{as_far}")
