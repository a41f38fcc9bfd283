"""Three answers in words at the head of a result: was the drive safe, was it comfortable, was it on time?

They restate the judgement in words: the rule of success, the comfort of standing passengers, and the timetable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.passengers.service import EARLY_S, LATE_S
from basu.metrics.success import NOT_COMPLETED
from basu.outcome import Status

if TYPE_CHECKING:
    from basu.metrics.result import Result

YES, NO, NOT_JUDGED = "yes", "no", "not judged"
CALM = frozenset({"not uncomfortable", "a little uncomfortable"})  # the mildest reactions of ISO 2631-1, annex C.2.3


class Answer(NamedTuple):
    """The answer to one question, with the reason."""

    question: str
    word: str
    reason: str

    @property
    def sentence(self) -> str:
        """Return the answer with its reason."""
        return f"{self.word}: {self.reason}"


def answers(result: Result) -> tuple[Answer, ...]:
    """Say whether a drive was safe, comfortable and on time; nothing where nothing was driven."""
    if result.scores is None:
        return ()
    passengers = result.metrics["passengers"]
    return _safe(result), _comfortable(passengers), _on_time(passengers)


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


def _comfortable(passengers: dict[str, Any] | None) -> Answer:
    """Answer by the harsh stops and the vibration that standing passengers feel."""
    if passengers is None or passengers["comfort_score"] is None:
        return Answer("comfortable", NOT_JUDGED, "the drive was too short or stood still")
    stops, reactions = passengers["harsh_stops"], passengers["vibration"]["reactions"]
    score = f"comfort score {passengers['comfort_score']:.2f} of 1"
    if stops:
        worst = max(stops, key=lambda stop: float(stop["strongest_mps2"]))
        often = "once" if len(stops) == 1 else f"{len(stops)} times"
        felt = f"felt up to {worst['strongest_mps2']:.1f} m/s² at {worst['t_s']:.1f} s"
        return Answer("comfortable", NO, f"braked harshly {often}, {felt}; {score}")
    if CALM.isdisjoint(reactions):
        return Answer("comfortable", NO, f"vibration is {' or '.join(reactions)}; {score}")
    return Answer("comfortable", YES, f"no harsh stop; {score}")


def _on_time(passengers: dict[str, Any] | None) -> Answer:
    """Answer by the timetable of the route."""
    visits = [] if passengers is None else passengers["service"]
    planned = [visit for visit in visits if visit["on_time"] is not None]
    if not planned:
        return Answer("on time", NOT_JUDGED, "the route has no timetable")
    kept = sum(visit["on_time"] for visit in planned)
    delays_s = [float(visit["delay_s"]) for visit in planned if visit["delay_s"] is not None]
    spread = [f"up to {-min(delays_s):.0f} s early"] if delays_s and min(delays_s) < -EARLY_S else []
    spread += [f"up to {max(delays_s):.0f} s late"] if delays_s and max(delays_s) > LATE_S else []
    spread += [f"{len(planned) - len(delays_s)} not reached"] if len(delays_s) < len(planned) else []
    reason = ", ".join([f"{kept} of {len(planned)} stops", *spread])
    return Answer("on time", YES if kept == len(planned) else NO, reason)
