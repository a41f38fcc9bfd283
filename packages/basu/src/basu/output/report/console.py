"""`table`: a run's result as text for the console, with answers, scores, infractions, scenarios and metrics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.metrics.display import NAME_WIDTH
from basu.metrics.registry import built_in
from basu.metrics.success import NOT_COMPLETED, not_exercised
from basu.output.report.in_words import answers
from basu.output.report.scenarios.tally import LOOKS
from basu.output.report.tracks import NO_GATE, ON_OWN_ROUTE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.infraction import Evidence
    from basu.metrics.result import Result


SCORES = {"driving": "driving score", "infraction": "  infractions", "path_following": "  path following"}
NOT_COMPARABLE = "NOT COMPARABLE"


def table(result: Result, *, details: bool = True) -> str:
    """Return a result as text: answers, score and infractions, and with ``details`` the figures of all metrics."""
    ended = f"{result.outcome.status.value}: {result.outcome.message}"
    if result.scores is None:
        return f"{ended}\nnothing was driven, so there is no score"
    return "\n".join(
        [
            *(f"{answer.question:<{NAME_WIDTH}}{answer.sentence}" for answer in answers(result)),
            f"{'ended':<{NAME_WIDTH}}{ended}",
            *success_lines(result),
            *score_lines(result),
            *infraction_lines(result),
            *scenario_lines([dict(row) for row in result.scenarios]),
            *(line for own in result.own.values() for line in own.lines(result)),
            *_simulated(result.meta),
            *(metric_lines(result) if details else []),
        ]
    )


def success_lines(result: Result) -> list[str]:
    """Passed or failed, and a line for each further reason."""
    word, reasons = result.success.word, result.success.reasons
    first = f"{word}: {reasons[0]}" if reasons else word
    return [f"{'result':<{NAME_WIDTH}}{first}", *(f"{'':<{NAME_WIDTH}}{reason}" for reason in reasons[1:])]


def score_cell(result: Result) -> str:
    """The driving score as a table shows it: a run that a failure ended has none, and the thesis's figure behind it."""
    if result.scores is None:
        return f"{NOT_COMPLETED} (nothing was driven)"
    figure = f"{result.scores.driving:.3f}"
    by_hand = "".join(f", {remark}" for remark in result.remarks())
    if result.is_comparable:
        return f"{figure}{by_hand}"
    if not result.is_broken_off:
        return f"{figure}{by_hand} {NOT_COMPARABLE}"
    return f"{NOT_COMPLETED} (the thesis's figure: {figure}{by_hand}; {NOT_COMPARABLE})"


def score_lines(result: Result) -> list[str]:
    """The thesis's scores; a run that a failure ended says so in the place of its score, the figure behind it."""
    assert result.scores is not None, "the caller asks"
    scores, mark = result.scores._asdict(), "".join(f"  {remark}" for remark in result.remarks())
    lines = [
        f"{name:<{NAME_WIDTH}}{scores[key]:8.3f}{mark if key == 'driving' else ''}" for key, name in SCORES.items()
    ]
    if result.is_broken_off:
        figure = f"the thesis's figure {scores['driving']:.3f}{mark}"
        lines[0] = f"{SCORES['driving']:<{NAME_WIDTH}}{NOT_COMPLETED}; {figure}"
    if not result.is_comparable:
        lines[0] += f"  {NOT_COMPARABLE}: {why_not_comparable(result)}"
    return [*lines, *_access(result)]


def why_not_comparable(result: Result) -> str:
    """Return why a score cannot be compared with others; empty if it can."""
    ended = f"the run ended as {result.outcome.status.value}" if result.is_broken_off else ""
    reasons = (NO_GATE if result.is_open else "", ON_OWN_ROUTE if result.has_own_route else "", ended)
    return " and ".join(reason for reason in reasons if reason)


def _access(result: Result) -> list[str]:
    """Return the track, and how many calls the gate refused; nothing for a record that was scored again."""
    if result.track is None:
        return []
    refused: Mapping[str, int] = result.meta["access"]["refused"]
    lines = [f"{'track':<{NAME_WIDTH}}{result.track:>8}"]
    if refused:
        names = ", ".join(f"{name} {count}" for name, count in refused.items())
        lines.append(f"{'refused calls':<{NAME_WIDTH}}{sum(refused.values()):8d}  {names}")
    return lines


def infraction_lines(result: Result) -> list[str]:
    """Return the number of infractions, and a line or two for each."""
    count = f"{'infractions':<{NAME_WIDTH}}{len(result.infractions):>8}"
    return [count, *(line for found in result.infractions for line in _infraction(found))]


def judgement(result: Result) -> list[str]:
    """Return infractions, users' metrics and the metrics of BASU."""
    own = (line for each in result.own.values() for line in each.lines(result))
    return [*infraction_lines(result), *own, *metric_lines(result)]


def metric_lines(result: Result) -> list[str]:
    """Return the lines of the metrics of BASU; a metric of nothing that happened takes no line."""
    return [line for metric in built_in() for line in metric.lines(result)]


def _infraction(found: Evidence) -> list[str]:
    """Return an infraction, and for a collision the responsibility below it."""
    lines = [f"  {found.t_s:8.1f} s  {found.kind.value:<21} {found.detail}"]
    return lines if found.responsibility is None else [*lines, f"{'':36}{found.responsibility.sentence}"]


def _simulated(meta: Mapping[str, Any]) -> list[str]:
    """Return how long the run took; nothing for a record that was scored again."""
    if "wall_s" not in meta:
        return []
    pace = f", {meta['simulated_s'] / meta['wall_s']:.2f}x real time" if meta["wall_s"] > 0.0 else ""
    return [f"{'simulated':<{NAME_WIDTH}}{meta['simulated_s']:.1f} s in {meta['wall_s']:.1f} s of wall time{pace}"]


NOT_REACHED = "not reached"


def scenario_lines(scenarios: Sequence[dict[str, Any]]) -> list[str]:
    """Return a line of counts for a route's scenarios, and a line for each: time, name, verdict, reason."""
    if not scenarios:
        return []
    reached = [row for row in scenarios if row["reached"]]
    passed = sum(row["verdict"] == "SUCCESS" for row in scenarios)
    judged = sum(row["verdict"] is not None and LOOKS[row["verdict"]].is_judged for row in scenarios)
    absent = not_exercised(scenarios)
    counted = f"{passed} of {judged} passed, {absent} not exercised; {len(reached)} of {len(scenarios)} reached"
    lines = [f"scenarios         {counted}"]
    return [*lines, *(_line(row) for row in scenarios)]


def verdict_word(row: dict[str, Any]) -> str:
    """Return the verdict of a scenario in a word or two."""
    return NOT_REACHED if row["verdict"] is None else LOOKS[row["verdict"]].word


def _line(row: dict[str, Any]) -> str:
    """Return the line of one scenario: time, verdict, name and reason."""
    when = f"{row['began_s']:8.1f} s" if row["began_s"] is not None else " " * 10
    return f"  {when}  {verdict_word(row):<21} {row['id']} ({row['scenario']}): {row['message']}"
