"""``result.json`` of a case: verdict, evidence, phases and tree as plain values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.options import STEP_S
from basu.outcome import Outcome, Status
from basu.scenarios.drawing import tree_of
from basu.scenarios.verdict import judge

if TYPE_CHECKING:
    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import AgentInProcess
    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.cases import Playable
    from basu.scenarios.verdict import Judged

SCHEMA_VERSION = 1


def document_of(
    playable: Playable,
    loaded: LoadedAgent | AgentInProcess,
    playing: Playing | None,
    judged: Judged,
    options: ScenarioOptions,
    *,
    history: History | None,
    wall_s: float,
) -> dict[str, Any]:
    """The document; ``playing`` and ``history`` are None where nothing was driven."""
    case, scenario = playable.case, playable.scenario
    return {
        "schema_version": SCHEMA_VERSION,
        **about(playable),
        "agent": loaded.name,
        "vehicle": options.vehicle or case.ego.model,
        "seed": options.seed,
        "town": case.town,
        "verdict": judged.verdict.value,
        "fault": judged.fault.name.lower(),
        "status": judged.outcome.status.value,
        "message": judged.message,
        "ended": judged.outcome.message,  # how the run ended, for judging it again
        "phases_s": {} if playing is None else {k: round(t * STEP_S, 3) for k, t in playing.phase_ticks.items()},
        "judgements": [judgement._asdict() for judgement in judged.judgements],
        "margins": judged.margins,
        "tree": None if playing is None else tree_of(playing.composed, judged.judgements),
        "actors": [] if playing is None else playing.actors(),
        "things": [] if playing is None else [thing._asdict() for thing in playing.things],
        "scenarios_file": case.source,
        "command": command(playable, options, loaded.name if loaded.file is None else str(loaded.file)),
        "simulated_s": 0.0 if history is None else round(len(history.frames) * STEP_S, 3),
        "wall_s": round(wall_s, 3),
        "timeout_s": scenario.timeout_s,
    }


def lost(
    playable: Playable, loaded: LoadedAgent | AgentInProcess, sentence: str, options: ScenarioOptions
) -> dict[str, Any]:
    """The document of a case whose process died: nothing is known of it."""
    judged = judge((), None, Outcome(Status.BENCHMARK_FAILED, sentence), triggered=False)
    return document_of(playable, loaded, None, judged, options, history=None, wall_s=0.0)


def about(playable: Playable) -> dict[str, Any]:
    """Which case of which scenario, where, and its parameters."""
    return {**playable.about(), "place": playable.case.place, "on_route": playable.case.on_route}


def command(playable: Playable, options: ScenarioOptions, agent: str) -> list[str]:
    """The command that plays this case alone again."""
    words = ["basu", "scenario", "run", playable.case.name, "--agent", agent]
    for file in options.all_files:
        words += ["--scenarios", str(file)]
    for option, value, usual in (
        ("--vehicle", options.vehicle, None),
        ("--seed", options.seed, 0),
        ("--step-limit", options.step_limit_s, 10.0),
    ):
        if value != usual:
            words += [option, str(value)]
    return words
