"""Writes the folder of a run: config, result, record, picture and report; prints the table."""

from __future__ import annotations

import importlib
import threading
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from basu.conditions import STEP_S
from basu.files import places, write_bytes
from basu.metrics.result import judge
from basu.options.run import RunOptions
from basu.output.report.console import table
from basu.output.report.documents import CONFIG_FILE, PICTURE_FILE, RESULT_FILE, TEXT_FILE, RunRecord, write_json
from basu.output.report.streets import around, write_streets
from basu.records.history.files import write_history
from basu.records.recording_files import LOG_FILE
from basu.settings.document import RUN, config_document

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from datetime import datetime
    from pathlib import Path

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.metrics.registry import Metric
    from basu.metrics.result import Result
    from basu.metrics.scoring import Scoring
    from basu.options.drive import DriveOptions
    from basu.routing.lane_graph import LaneGraph
    from basu.routing.route_file import RouteDescription
    from basu.running.drive import Driven

ROUTE_WEATHER = "of the route file"
PICTURES = ("basu.output.report.path_picture", "basu.output.report.html.page")
"""Modules that take a third of all the imports, and that a run needs only at its end."""


def run_config(
    options: RunOptions,
    scoring: Scoring,
    loaded: FoundAgent,
    wishes: AgentConfig,
    description: RouteDescription,
    *,
    typed: str,
    own_simulator: bool,
    started: datetime,
    seed: int,
    traffic: Mapping[str, int],
    log: str | None,
    access: Mapping[str, Any],
    ignored: str = "",
    shuttle: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return ``config.json``: the options that repeat this one run, and what they came to.

    ``typed`` is the agent as the user named it.

    ``ignored`` is a sentence about wishes of the agent that the benchmark ignored.

    ``shuttle`` says which vehicle of a run with several this is.
    """
    again = options_again(options, description, seed)
    facts = drive_facts(
        options,
        loaded,
        typed,
        wishes,
        description,
        weather=weather_name(options, wishes, description),
        own_simulator=own_simulator,
        started=started,
        seed=seed,
        traffic=traffic,
        log=log,
        access=access,
        ignored=ignored,
    )
    document = config_document(RUN, again, scoring, _files(again, loaded, wishes, description))
    return {**document, **facts, **({} if shuttle is None else {"shuttle": dict(shuttle)})}


def drive_facts(
    options: DriveOptions,
    loaded: FoundAgent,
    typed: str,
    wishes: AgentConfig,
    description: RouteDescription,
    *,
    weather: str,
    own_simulator: bool,
    started: datetime,
    seed: int,
    traffic: Mapping[str, int],
    log: str | None,
    access: Mapping[str, Any] | None,
    ignored: str = "",
) -> dict[str, Any]:
    """Return the facts of a drive that stand in ``config.json``; ``result.json`` has most of them as its ``meta``.

    Args:
        options: what was asked for.
        loaded: the agent.
        typed: the agent as the user named it.
        wishes: of the agent, as far as they count.
        description: the route.
        weather: its name.
        own_simulator: whether no other program uses the simulator.
        started: when the drive was prepared.
        seed: of this one drive.
        traffic: the numbers of vehicles and walkers.
        log: CARLA's log, as the simulator gave its path; None where none was written.
        access: of the agent to the simulator; None where nothing was driven.
        ignored: a sentence about wishes that do not count.
    """
    return {
        "started": started.isoformat(timespec="seconds"),
        "agent": {
            "name": loaded.name,
            "class": loaded.class_name,
            "file": typed,
            "confinement": loaded.confinement,
        },
        "agent_config": asdict(wishes),
        "route": description.id,
        "own_route": description.is_own,
        "town": description.town,
        "seed": seed,
        "weather": weather,
        "traffic": {**traffic, "density_per_km": options.traffic.density_per_km},
        "recording": _recording(options, log, own_simulator=own_simulator),
        "step_s": STEP_S,
        **({} if access is None else {"access": dict(access)}),
        "own_simulator": own_simulator,
        "notes": [*_notes(options, loaded), *([ignored] if ignored else [])],
    }


def options_again(options: RunOptions, description: RouteDescription, seed: int) -> RunOptions:
    """Return the options that repeat one run of a series with ``options``.

    Keys that a person pressed and that were recorded become the keys to play.
    """
    keys = options.keys if options.record_keys is None else str(options.record_keys)
    return replace(
        options,
        route_id=description.official_id,
        routes_subset=None,
        repetitions=1,
        seed=seed,
        keys=keys,
    )


def _files(
    options: RunOptions, loaded: FoundAgent, wishes: AgentConfig, description: RouteDescription
) -> Iterator[Path]:
    """Yield the files that decide over the run's outcome."""
    if loaded.file is not None and loaded.file.is_file():
        yield loaded.file
    names = (
        description.source,
        wishes.sensors,
        options.agent_config,
        options.keys,
        *options.scenario_files,
        *options.metric_files,
    )
    for name in names:
        found = (
            next((place / name for place in places(loaded.file) if (place / name).is_file()), None) if name else None
        )
        if found is not None:
            yield found


def _notes(options: DriveOptions, loaded: FoundAgent) -> list[str]:
    """Return what keeps a run from being repeated, in sentences."""
    if loaded.file is not None and not loaded.file.is_file():
        return [f"{loaded.name} is a class of a notebook or program; a run is repeatable with the agent in a file"]
    by_hand = options.watch or loaded.is_human
    if by_hand and options.keys is None and options.record_keys is None:
        return ["a person could drive, and the keys were not recorded; --record-keys FILE makes such a run repeatable"]
    return []


def weather_name(options: RunOptions, wishes: AgentConfig, description: RouteDescription) -> str:
    """Return the name of a run's weather: a preset, or that the route file gives it."""
    return ROUTE_WEATHER if options.weather is None and description.weather else wishes.weather


def _recording(options: DriveOptions, log: str | None, *, own_simulator: bool) -> dict[str, str] | None:
    """Return the place of CARLA's log: the run's folder, or the disk of a simulator that is not ours."""
    if log is None:
        return None
    if own_simulator:
        return {"file": LOG_FILE, "where": "run folder"}
    return {"file": log, "where": f"disk of the simulator at {options.host}:{options.port}"}


def write_run_folder(
    folder: Path,
    driven: Driven,
    scoring: Scoring,
    lanes: LaneGraph | None,
    config: dict[str, Any],
    scenarios: Sequence[dict[str, Any]] = (),
    own: Sequence[Metric] = (),
    *,
    pictures: bool = True,
) -> Result:
    """Write the folder of a run and return its result.

    ``scenarios`` are those on the route, ``own`` are users' metrics. Without ``pictures`` the folder gets neither
    picture nor report; `basu report` makes them from the folder later. ``lanes`` may be None where nothing was driven.
    """
    history = driven.history
    result = judge(driven.outcome, history, scoring, meta_of(driven, config), scenarios=scenarios, own=own)
    document = result.document()
    text = table(result)
    write_json(folder / CONFIG_FILE, config)
    write_json(folder / RESULT_FILE, document)
    write_bytes(folder / TEXT_FILE, f"{_heading(config)}\n\n{text}\n".encode())
    streets = around([] if lanes is None else lanes.streets(), history)
    if history is not None:
        write_history(folder, history)
        title = f"{_heading(config)}: {document['status']}"
        if pictures:
            from basu.output.report import path_picture  # noqa: PLC0415 - see PICTURES

            path_picture.draw(folder / PICTURE_FILE, history, streets.lines, title, scoring)
    write_streets(folder, streets)
    if pictures:
        from basu.output.report.html.page import write_report  # noqa: PLC0415 - see PICTURES

        run = RunRecord(name=folder.name, config=config, result=result, history=history, streets=streets)
        write_report(folder, run)
    return result


def meta_of(driven: Driven, config: Mapping[str, Any]) -> dict[str, Any]:
    """Return what was driven, as the ``meta`` of a result; ``config`` is ``config.json`` of the drive."""
    ticks = 0 if driven.history is None else len(driven.history.frames)
    return {
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
        "own_route": config["own_route"],
        "town": config["town"],
        "versions": config["versions"],
        **({"access": config["access"]} if "access" in config else {}),
    }


def import_pictures() -> None:
    """Import what pictures and reports need, in a thread: a drive mostly waits for its simulator and its agent."""
    threading.Thread(target=lambda: [*map(importlib.import_module, PICTURES)], name="imports", daemon=True).start()


def _heading(config: dict[str, Any]) -> str:
    """Return agent, route and town in a line."""
    own = " (the agent's own)" if config["own_route"] else ""
    return f"{config['agent']['name']} on route {config['route']}{own} of {config['town']}"
