"""``matrix.json``: all cases with all agents, and the crashes that the passed ones stand for."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import basu
from basu.running.scenario_runs.document import about
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.shares import crash_shares, results_from, shares_to_json

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from datetime import datetime

    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.cases import Playable

SCHEMA_VERSION = 2
SUMMARY = (  # entries of a result
    "verdict",
    "fault",
    "status",
    "message",
    "assessment",
    "collisions",
    "margins",
    "simulated_s",
    "wall_s",
)


def matrix_of(
    options: ScenarioOptions,
    agents: Sequence[str],
    playables: Sequence[Playable],
    documents: Mapping[int, tuple[dict[str, Any], str]],
    began: datetime,
    wall_s: float,
) -> dict[str, Any]:
    """The document; ``documents`` are results and folders by number of the job, cases before agents."""
    rows: list[dict[str, Any]] = []
    by_agent: dict[str, list[dict[str, Any]]] = {agent: [] for agent in agents}
    for nth, playable in enumerate(playables):
        results = {}
        for column, agent in enumerate(agents):
            done = documents.get(nth * len(agents) + column)
            if done is not None:
                document, folder = done
                by_agent[agent].append(document)
                results[agent] = {**{key: document[key] for key in SUMMARY}, "folder": folder}
        rows.append({**about(playable), "results": results})
    return {
        "schema_version": SCHEMA_VERSION,
        "started": began.astimezone().isoformat(timespec="seconds"),
        "what": " ".join(options.what),
        "agents": list(agents),
        "vehicle": options.vehicle,
        "seed": options.drive_seed,
        "sweep": _design(options),
        "wall_s": round(wall_s, 1),
        "workers": options.workers,
        "cases": rows,
        "shares": {agent: shares_to_json(crash_shares(results_from(by_agent[agent]))) for agent in agents},
        "versions": {"basu": basu.__version__, "carla": version("carla"), "python": platform.python_version()},
    }


def _design(options: ScenarioOptions) -> dict[str, Any] | None:
    """How parameters were sampled."""
    design = options.design
    if design is None:
        return None
    vary = {"vary": list(options.vary)}
    if isinstance(design, Sweep):
        return {"n": design.samples, "seed": design.seed, **vary}
    assert isinstance(design, Grid), "there are two designs"
    return {"grid": design.steps, **vary}
