"""What a run leaves behind: its config, result, record and picture in its folder, and the table on the console."""

from __future__ import annotations

import platform
from dataclasses import asdict
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

import basu
from basu.history.files import write_history
from basu.options import STEP_S
from basu.report import picture
from basu.report.console import table
from basu.report.folder import CONFIG_FILE, PICTURE_FILE, RESULT_FILE, point_latest, write_json
from basu.report.result import result

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

    from basu.drive import Driven
    from basu.managers.agent_config import AgentConfig
    from basu.managers.agent_loader import LoadedAgent
    from basu.metrics.score import Scoring
    from basu.options import RunOptions
    from basu.routing.lane_graph import LaneGraph
    from basu.routing.route_file import RouteDescription


def run_config(
    options: RunOptions,
    scoring: Scoring,
    loaded: LoadedAgent,
    wishes: AgentConfig,
    description: RouteDescription,
    own_simulator: bool,  # noqa: FBT001 - passed on as it is written
    started: datetime,
) -> dict[str, Any]:
    """What is needed to run it again."""
    again = ["basu", "run", options.agent, "--route-id", description.id, "--seed", str(options.seed)]
    return {
        "started": started.isoformat(timespec="seconds"),
        "command": again if options.routes is None else [*again, "--routes", options.routes],
        "agent": {"name": loaded.name, "class": loaded.agent_class.__name__, "file": options.agent},
        "agent_config": asdict(wishes),
        "route": description.id,
        "town": description.town,
        "seed": options.seed,
        "step_s": STEP_S,
        "step_limit_s": options.step_limit_s,
        "own_simulator": own_simulator,
        "scoring": {
            "penalties": {kind.value: penalty for kind, penalty in scoring.penalties.items()},
            "infraction_weight": scoring.infraction_weight,
            "path_following_weight": scoring.path_following_weight,
        },
        "versions": {
            "basu": basu.__version__,
            "carla": version("carla"),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }


def leave(folder: Path, driven: Driven, scoring: Scoring, lanes: LaneGraph, config: dict[str, Any]) -> None:
    """Write the folder of a run and show its table."""
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
        "weather": config["agent_config"]["weather"],
        "route": config["route"],
        "town": config["town"],
        "versions": config["versions"],
    }
    document = result(driven.outcome, history, scoring, meta)
    print(table(document))
    write_json(folder / CONFIG_FILE, config)
    write_json(folder / RESULT_FILE, document)
    if history is not None:
        write_history(folder, history)
        title = f"{config['agent']['name']} on route {config['route']} of {config['town']}: {document['status']}"
        picture.draw(folder / PICTURE_FILE, history, lanes.streets(), title)
    point_latest(folder)
    print(f"result folder     {folder}")
