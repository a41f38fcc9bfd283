"""The documents of scenario runs: a case's result and config, and ``matrix.json`` of all cases and agents."""

from __future__ import annotations

import platform
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basu
from basu.conditions import STEP_S
from basu.outcome import Outcome, Status
from basu.output.report.document_parts import MATRIX_SCHEMA_VERSION, CellPart
from basu.output.report.drive_row import part_of, row_of
from basu.running.scenario_runs.chosen_cases import design_of, files_of
from basu.running.scenario_runs.options import CaseOptions, ScenarioOptions
from basu.scenarios.characteristics import measured
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.share_documents import not_played, results_from, shares_to_json
from basu.scenarios.shares import crash_shares
from basu.scenarios.tree_text import tree_of
from basu.scenarios.verdict import judge
from basu.settings.document import SCENARIO_RUN, command_of, config_document
from basu.settings.option import fields_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from datetime import datetime

    from basu.agents.process.remote_agent import FoundAgent
    from basu.managers.scenario_manager import Playing
    from basu.metrics.scoring import Scoring
    from basu.records.history import History
    from basu.running.drive import DriveDone
    from basu.scenarios.playable import Playable
    from basu.scenarios.shares import CountedCase
    from basu.scenarios.verdict import Judged


def case_part(
    playable: Playable,
    loaded: FoundAgent,
    playing: Playing | None,
    judged: Judged,
    options: ScenarioOptions,
    *,
    history: History | None,
    wall_s: float,
) -> dict[str, Any]:
    """Return the part of a result that says what became of the case; nothing was driven without ``playing``.

    ``options.seed`` is the seed of this one drive.
    """
    case, scenario = playable.case, playable.scenario
    return {
        **about(playable),
        "agent": loaded.name,
        "vehicle": options.vehicle or case.ego.model,
        "seed": options.seed,
        "town": case.town,
        "verdict": judged.verdict.value,
        "fault": judged.fault.name.lower(),
        "status": judged.outcome.status.value,
        "message": judged.message,
        "assessment": None if judged.assessment is None else judged.assessment.document(),
        "collisions": [collision._asdict() for collision in judged.collisions],
        "ended": judged.outcome.message,  # how the run ended, for judging it again
        "measured": None if history is None or playing is None else _measured(playing, history),
        "phases_s": {} if playing is None else {k: round(t * STEP_S, 3) for k, t in playing.phase_ticks.items()},
        "judgements": [judgement._asdict() for judgement in judged.judgements],
        "margins": judged.margins,
        "tree": None if playing is None else tree_of(playing.composed, judged.judgements),
        "actors": [] if playing is None else playing.actors(),
        "things": [] if playing is None else [thing._asdict() for thing in playing.things],
        "scenarios_file": case.source,
        "command": command_of(SCENARIO_RUN, options_again(playable, options, typed_name(options, loaded))),
        "simulated_s": 0.0 if history is None else round(len(history.frames) * STEP_S, 3),
        "wall_s": round(wall_s, 3),
        "timeout_s": scenario.timeout_s,
    }


def _measured(playing: Playing, history: History) -> dict[str, Any] | None:
    """Figures of the route and the drive where the conflict began; None where it never did."""
    tick = playing.phase_ticks.get("conflict")
    return None if tick is None or tick >= len(history.frames) else measured(history, tick)


def lost(playable: Playable, loaded: FoundAgent, sentence: str, options: ScenarioOptions) -> dict[str, Any]:
    """Return the part of a case after the death of its process: nothing is known of it."""
    judged = judge((), None, Outcome(Status.BENCHMARK_FAILED, sentence), triggered=False)
    return case_part(playable, loaded, None, judged, options, history=None, wall_s=0.0)


def about(playable: Playable) -> dict[str, Any]:
    """Which case of which scenario, where, and its parameters."""
    return {**playable.about(), "place": playable.case.place, "on_route": playable.case.on_route}


def options_again(playable: Playable, options: ScenarioOptions, agent: str) -> ScenarioOptions:
    """Return the options that play one case of a run alone; its id holds sample and parameters.

    ``options.seed`` is the seed of this one drive.
    """
    chosen = {field.name: field.default for field in fields_of(CaseOptions)}
    found = {"what": (playable.case.name,), "files": files_of(options), "agents": (agent,), "repetitions": 1}
    return replace(options, **{**chosen, **found})


def case_config(playable: Playable, options: ScenarioOptions, scoring: Scoring, loaded: FoundAgent) -> dict[str, Any]:
    """Return ``config.json`` of a case, which plays it alone again."""
    return run_config(options_again(playable, options, typed_name(options, loaded)), scoring, [loaded])


def run_config(options: ScenarioOptions, scoring: Scoring, agents: Sequence[FoundAgent]) -> dict[str, Any]:
    """Return ``config.json`` of a run of scenarios."""
    pairs = [(file, file.with_suffix(".xml" if file.suffix == ".py" else ".py")) for file in files_of(options)]
    files = [*(agent.file for agent in agents if agent.file is not None), *(file for pair in pairs for file in pair)]
    files += [*options.metric_files, *([Path(options.keys)] if options.keys else [])]
    there = [file for file in files if file.is_file()]
    return config_document(SCENARIO_RUN, options, scoring, there)


def typed_name(options: ScenarioOptions, loaded: FoundAgent) -> str:
    """Return an agent's name as it was typed, with the class where its file has several."""
    file = loaded.file
    if file is None or loaded.name in options.agents:
        return loaded.name
    return next((each for each in options.agents if Path(f"{each.partition('.py')[0]}.py") == file), str(file))


def matrix_of(
    options: ScenarioOptions,
    agents: Sequence[str],
    drives: Sequence[tuple[Playable, int]],
    found: Mapping[int, DriveDone],
    folder: Path,
    began: datetime,
    wall_s: float,
) -> dict[str, Any]:
    """Return the document.

    ``drives`` are cases with the number of their repetition. ``found`` are the finished ones by
    number of the job, drives before agents; ``folder`` is that of the matrix.
    """
    rows: list[dict[str, Any]] = []
    by_agent: dict[str, list[CountedCase]] = {agent: [] for agent in agents}
    for nth, (playable, repetition) in enumerate(drives):
        results = {}
        for column, agent in enumerate(agents):
            done = found.get(nth * len(agents) + column)
            if done is None:
                by_agent[agent].append(not_played(about(playable)))
            else:
                assert done.result.case is not None, "it is the drive of a case"
                by_agent[agent] += results_from([done.result.case])
                where = "" if done.folder is None else done.folder.relative_to(folder).as_posix()
                results[agent] = part_of({**row_of(done.result), "folder": where}, CellPart)
        repeated = {"repetition": repetition} if options.repetitions > 1 else {}
        rows.append({**about(playable), **repeated, "results": results})
    return {
        "schema_version": MATRIX_SCHEMA_VERSION,
        "started": began.astimezone().isoformat(timespec="seconds"),
        "what": " ".join(options.what),
        "agents": list(agents),
        "vehicle": options.vehicle,
        "seed": options.drive_seed,
        "sweep": _design(options),
        "wall_s": round(wall_s, 1),
        "workers": options.workers,
        "cases": rows,
        "shares": {agent: shares_to_json(crash_shares(by_agent[agent])) for agent in agents},
        "versions": {"basu": basu.__version__, "carla": version("carla"), "python": platform.python_version()},
    }


def _design(options: ScenarioOptions) -> dict[str, Any] | None:
    """Return how the parameters were sampled."""
    design = design_of(options)
    if design is None:
        return None
    vary = {"vary": list(options.vary)}
    if isinstance(design, Sweep):
        return {"n": design.samples, "seed": design.seed, **vary}
    assert isinstance(design, Grid), "there are two designs"
    return {"grid": design.steps, **vary}
