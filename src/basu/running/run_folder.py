"""What a run leaves behind: its config, result, record and picture in its folder, and the table on the console."""

from __future__ import annotations

import platform
from dataclasses import asdict
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

import basu
from basu.metrics.score import Scoring
from basu.metrics.scoring_json import scoring_to_json
from basu.options import STEP_S
from basu.output.report import picture
from basu.output.report.console import table
from basu.output.report.folder import CONFIG_FILE, PICTURE_FILE, RESULT_FILE, TEXT_FILE, write_json
from basu.output.report.html.page import write_report
from basu.output.report.reading import RunRecord
from basu.output.report.result import result
from basu.output.report.streets import around, write_streets
from basu.records.carla_log.sources import LOG_FILE
from basu.records.history.files import write_history
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from datetime import datetime
    from pathlib import Path

    from basu.agents.config import AgentConfig
    from basu.agents.loader import LoadedAgent
    from basu.agents.process.remote_agent import AgentInProcess
    from basu.options import RunOptions
    from basu.routing.lane_graph import LaneGraph
    from basu.routing.route_file import RouteDescription
    from basu.running.drive import Driven

OWN_ROUTE = "-own"  # behind the id of a route that the agent has planned itself
ROUTE_WEATHER = "of the route file"


def run_config(
    options: RunOptions,
    scoring: Scoring,
    loaded: LoadedAgent | AgentInProcess,
    wishes: AgentConfig,
    description: RouteDescription,
    *,
    own_simulator: bool,
    started: datetime,
    seed: int,
    traffic: Mapping[str, int],
    log: str | None,
) -> dict[str, Any]:
    """What is needed to run it again."""
    return {
        "started": started.isoformat(timespec="seconds"),
        "command": command(options, scoring, description, seed),
        "agent": {"name": loaded.name, "class": loaded.class_name, "file": options.agent},
        "agent_config": asdict(wishes),
        "route": description.id,
        "town": description.town,
        "seed": seed,
        "weather": weather_name(options, wishes, description),
        "traffic": {**traffic, "density_per_km": options.traffic.density_per_km},
        "recording": _recording(options, log, own_simulator=own_simulator),
        "step_s": STEP_S,
        "step_limit_s": options.step_limit_s,
        "own_simulator": own_simulator,
        "scoring": scoring_to_json(scoring),
        "versions": {
            "basu": basu.__version__,
            "carla": version("carla"),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }


def command(options: RunOptions, scoring: Scoring, description: RouteDescription, seed: int) -> list[str]:
    """The command that does this run again."""
    usual, traffic = Scoring(), options.traffic
    changed = [
        f"{kind.value}={factor}" for kind, factor in scoring.penalties.items() if factor != usual.penalties[kind]
    ]
    values: list[tuple[str, object]] = [
        ("--agent-config", options.agent_config),
        ("--routes", options.routes),
        ("--route-id", description.id.removesuffix(OWN_ROUTE)),
        ("--seed", seed),
        ("--weather", options.weather),
        ("--vehicle", options.vehicle),
        ("--keys", options.keys),
        ("--vehicles", traffic.vehicles or None),
        ("--walkers", traffic.walkers or None),
        ("--traffic-density", traffic.density_per_km),
        *(("--penalty", text) for text in changed),
    ]
    for option, number, usually in (
        ("--infraction-weight", scoring.infraction_weight, usual.infraction_weight),
        ("--speeding-tolerance", scoring.speeding_tolerance_mps, usual.speeding_tolerance_mps),
        ("--route-deviation", scoring.route_deviation_m, usual.route_deviation_m),
    ):
        if number != usually:
            values.append((option, number))
    words = [word for option, value in values if value is not None for word in (option, str(value))]
    words += [word for file in options.scenario_files for word in ("--scenarios", str(file))]
    words += [] if options.with_scenarios else ["--no-scenarios"]
    return ["basu", "run", options.agent, *words, *(["--record"] if options.record else [])]


def weather_name(options: RunOptions, wishes: AgentConfig, description: RouteDescription) -> str:
    """What the weather of a run is called: a preset, or that the route file gives it."""
    return ROUTE_WEATHER if options.weather is None and description.weather else wishes.weather


def _recording(options: RunOptions, log: str | None, *, own_simulator: bool) -> dict[str, str] | None:
    """Where CARLA's log lies: in the run's folder, or where somebody else's simulator keeps it."""
    if log is None:
        return None
    if own_simulator:
        return {"file": LOG_FILE, "where": "run folder"}
    return {"file": log, "where": f"disk of the simulator at {options.host}:{options.port}"}


def leave(
    folder: Path,
    driven: Driven,
    scoring: Scoring,
    lanes: LaneGraph,
    config: dict[str, Any],
    scenarios: Sequence[dict[str, Any]] = (),
) -> dict[str, Any]:
    """Write the folder of a run and show its table; the result. ``scenarios`` are those on the way."""
    history = driven.history
    ticks = 0 if history is None else len(history.frames)
    meta = {
        "simulated_s": ticks * STEP_S,
        "wall_s": round(driven.wall_s, 3),
        "ticks": ticks,
        "step_s": STEP_S,
        "first_server_frame": driven.first_frame,
        "started": config["started"],
        "seed": config["seed"],
        "agent": config["agent"],
        "vehicle": config["agent_config"]["vehicle"],
        "weather": config["weather"],
        "traffic": config["traffic"],
        "route": config["route"],
        "town": config["town"],
        "versions": config["versions"],
    }
    document = result(driven.outcome, history, scoring, meta)
    if scenarios:
        document["scenarios"] = list(scenarios)
    text, lanes_m = table(document), lanes.streets()
    print(text)
    write_json(folder / CONFIG_FILE, config)
    write_json(folder / RESULT_FILE, document)
    write_bytes(folder / TEXT_FILE, f"{_heading(config)}\n\n{text}\n".encode())
    if history is not None:
        write_history(folder, history)
        title = f"{_heading(config)}: {document['status']}"
        picture.draw(folder / PICTURE_FILE, history, lanes_m, title, scoring)
    streets = [] if history is None else around(lanes_m, history)
    write_streets(folder, streets)
    write_report(folder, RunRecord(name=folder.name, config=config, result=document, history=history, streets=streets))
    if config["recording"] is not None:
        print(f"recording         {config['recording']['file']} ({config['recording']['where']})")
    return document


def _heading(config: dict[str, Any]) -> str:
    """What a run was, in a line."""
    return f"{config['agent']['name']} on route {config['route']} of {config['town']}"
