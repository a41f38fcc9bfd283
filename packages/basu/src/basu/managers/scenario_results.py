"""The results of a route's scenarios as plain values for ``result.json``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.outcome import Outcome, Status
from basu.scenarios.criteria.case_record import part_of
from basu.scenarios.tree_text import tree_of
from basu.scenarios.verdict import judge

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.scenarios.verdict import Judged


def results_of(scenarios: Sequence[Playing], history: History | None, outcome: Outcome) -> list[dict[str, Any]]:
    """Each scenario with its verdict and the evidence; ``outcome`` is the run's, ``history`` its whole record."""
    return [_told(playing, history, outcome) for playing in scenarios]


def _told(playing: Playing, history: History | None, outcome: Outcome) -> dict[str, Any]:
    """One of them; its verdict is None where the ego never came to its trigger point."""
    trigger_s_m = playing.scenario.place.trigger_s_m
    document: dict[str, Any] = {
        **playing.planned.about(),
        "unread": list(playing.planned.unread),
        "trigger_s_m": round(trigger_s_m, 3),
        "reached": playing.armed_tick is not None,
        "verdict": None,
        "fault": "none",
        "message": f"it waits at {trigger_s_m:.0f} m of the route, and the run ended before: {outcome.message}",
    }
    if history is None or (playing.armed_tick is None and playing.error is None):
        return {**document, **_evidence(playing, None, 0.0)}
    judged = judged_on_the_way(playing, history, outcome)
    document.update(verdict=judged.verdict.value, fault=judged.fault.name.lower(), message=judged.message)
    return {**document, **_evidence(playing, judged, history.facts.step_s)}


def judged_on_the_way(playing: Playing, history: History, outcome: Outcome) -> Judged:
    """The verdict, by the part of the run's record in which the scenario was played."""
    if playing.error is not None:
        return judge((), None, Outcome(Status.SETUP_FAILED, str(playing.error)), triggered=playing.triggered)
    first = playing.armed_tick or 0
    end = len(history.frames) if playing.over_tick is None else playing.over_tick + 1
    part = part_of(history, first, end, playing.stage.route.length_m)
    return playing.judged(part, playing.outcome or outcome)


def _evidence(playing: Playing, judged: Judged | None, step_s: float) -> dict[str, Any]:
    """When it was played, its actors, and the judgements of its criteria."""
    judgements = () if judged is None else judged.judgements
    return {
        "began_s": None if playing.armed_tick is None else round(playing.armed_tick * step_s, 3),
        "ended_s": None if playing.over_tick is None else round(playing.over_tick * step_s, 3),
        "phases_s": {phase: round(tick * step_s, 3) for phase, tick in playing.phase_ticks.items()},
        "judgements": [judgement._asdict() for judgement in judgements],
        "margins": {} if judged is None else judged.margins,
        "assessment": None if judged is None or judged.assessment is None else judged.assessment.document(),
        "collisions": [] if judged is None else [collision._asdict() for collision in judged.collisions],
        "tree": dict(tree_of(playing.composed, judgements)),
        "actors": playing.actors(),
        "things": [thing._asdict() for thing in playing.things],
        "timeout_s": playing.scenario.timeout_s,
        "timed_out": playing.outcome is not None and playing.outcome.status is Status.SCENARIO_TIMEOUT,
        "scenarios_file": playing.planned.case.source,
    }
