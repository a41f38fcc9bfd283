"""Builds a `CampaignPlan` from the settings: loads agents, routes, cases and searches, or raises `UserError`."""

from __future__ import annotations

import hashlib
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from basu.agents.process.gate import closed_ports
from basu.agents.process.remote_agent import find_agent
from basu.campaigns.plan import (
    ID_DIGITS,
    ROUTE,
    CampaignPlan,
    Part,
    PlannedAgent,
    Subject,
    case_subject,
    digest_of,
)
from basu.campaigns.search_part import SearchPart, search_plugin
from basu.campaigns.search_space import space_of
from basu.campaigns.settings import AS_GIVEN, Campaign, OtherTraffic
from basu.episode.world import weather_called
from basu.errors import UserError
from basu.files import find, places
from basu.jobs.job import versions
from basu.managers.agents_manager import AgentsManager
from basu.metrics.scoring import Scoring, scoring_layer, scoring_to_json
from basu.output.report.documents import plain
from basu.routing.route_file import read_routes
from basu.scenarios.cases import cases_of, file_in, files_among, files_named, varied
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.variation import Variation
from basu.settings.resolve import resolve

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.campaigns.settings import Drives
    from basu.scenarios.sampling import Design


def plan_of(campaign: Campaign, source: Path) -> CampaignPlan:
    """Find all that a campaign names; relative names are looked for here, beside ``source``, and among BASU's own.

    Raises:
        UserError: an agent, a route, a case, a parameter, a weather or a file is not there, or nothing is to be driven.
    """
    scoring = resolve(Scoring, [scoring_layer(campaign.scoring, f"{source}: scoring")])
    agents = tuple(_agent(typed, campaign, source) for typed in campaign.agents)
    names = [agent.name for agent in agents]
    for name in names:
        if names.count(name) > 1:
            raise UserError(f"{source}: two agents are called '{name}'; name each once, or rename a file")
    named = [find(name, "scenario file", source).resolve() for name in campaign.scenario_files]
    every_drives = [_with_paths(drives, source) for drives in campaign.drives]
    among = [path.resolve() for drives in every_drives for path in files_named(files_among(drives.cases))]
    scenario_files = tuple(dict.fromkeys([*named, *among]))  # workers open them too
    metric_files = tuple(find(name, "metric file", source).resolve() for name in campaign.metric_files)
    parts = tuple(_part(drives, campaign, source, scenario_files) for drives in every_drives)
    mode = ["open"] if campaign.open else []
    shared = digest_of([campaign.vehicle, scoring_to_json(scoring), versions(), *mode])
    return CampaignPlan(campaign, agents, parts, scoring, scenario_files, metric_files, shared)


def _with_paths(drives: Drives, source: Path) -> Drives:
    """Drives with full paths where their cases name files (FILE.xml or FILE.py:Class).

    Raises:
        UserError: there is no such file.
    """
    words = []
    for word in drives.cases:
        path, class_name = file_in(word)
        found = word if path is None else str(find(str(path), "scenario file", source).resolve())
        words.append(f"{found}:{class_name}" if class_name else found)
    return drives.model_copy(update={"cases": tuple(words)})


def _agent(typed: str, campaign: Campaign, source: Path) -> PlannedAgent:
    """An agent, loaded once, so that a wrong one is refused before anything is driven."""
    given = campaign.tracks.get(typed)
    file, colon, class_name = typed.partition(".py:")
    path = f"{file}.py" if colon else typed
    if path.endswith(".py"):
        there = next((place / path for place in places(source)[:2] if (place / path).is_file()), None)
        if there is None:
            raise UserError(f"{source}: there is no agent's file {path}, neither here nor beside the campaign")
        digest = hashlib.sha256(there.read_bytes()).hexdigest()[:ID_DIGITS]
        typed = f"{there.resolve()}:{class_name}" if colon else str(there.resolve())
    else:
        digest = ""
    try:
        found = find_agent(
            typed,
            memory_gb=campaign.agent_memory_gb,
            writes=campaign.agent_writes,
            closed_ports=closed_ports(None, 0, is_open=campaign.open),
        )
    except UserError as error:
        raise UserError(f"{source}: {error}") from None
    if found.is_human:
        raise UserError(f"{source}: a person drives the agent '{typed}', which a campaign cannot wait for; remove it")
    manager = AgentsManager(found, step_limit_s=campaign.step_limit_s, routes=None, track=given, has_conditions=False)
    try:
        track = manager.config.track
        if manager.ignored:
            print(f"basu: warning: {manager.ignored}", file=sys.stderr)
    finally:
        manager.close()
    return PlannedAgent(typed, plain(found.name), digest, track, given is not None, campaign.open)


def _part(drives: Drives, campaign: Campaign, source: Path, scenario_files: Sequence[Path]) -> Part:
    """Return the part of the plan that one [[drives]] table describes.

    Raises:
        UserError: something is not there.
    """
    weather = drives.weather or campaign.weather
    for name in weather:
        if name != AS_GIVEN:
            weather_called(name)
    traffic = drives.traffic or campaign.traffic
    if drives.is_adaptive:
        return _search(drives, campaign, weather, scenario_files)
    if drives.cases:
        subjects, traffic = _cases(drives, scenario_files), (OtherTraffic(),)
    else:
        subjects = _routes(drives, source)
    return Part(subjects, weather, traffic, drives.seeds or campaign.seeds, drives.scenarios)


def _search(drives: Drives, campaign: Campaign, weather: tuple[str, ...], scenario_files: Sequence[Path]) -> Part:
    """A [[drives]] with a search or an estimate.

    Raises:
        UserError: a parameter cannot be searched over, or the plugin is not installed.
    """
    plugin = search_plugin()
    fixed = tuple((name, str(value)) for name, value in drives.fixed.items())
    cases = varied(cases_of(drives.cases, scenario_files), Variation(fixed=fixed))
    normal = {} if drives.estimate is None else drives.estimate.normal
    spaces = tuple(space_of(case, drives.vary, drives.fixed, normal) for case in cases)
    seeds = drives.seeds or campaign.seeds
    part = SearchPart(cases, spaces, fixed, weather, seeds, drives.search, drives.estimate, ())
    part = replace(part, sizes=plugin.sizes(part))
    subjects = tuple(case_subject(case) for case in cases)
    return Part(subjects, weather, (OtherTraffic(),), seeds, drives.scenarios, part)


def _routes(drives: Drives, source: Path) -> tuple[Subject, ...]:
    """The routes of a file."""
    assert drives.routes is not None, "the settings have checked it"
    path = find(drives.routes, "route file", source).resolve()
    routes = read_routes(path)
    known = {route.id: route for route in routes}
    for wanted in drives.route_ids:
        if wanted not in known:
            raise UserError(f"{source}: {path} has no route '{wanted}'; it has {', '.join(known)}")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:ID_DIGITS]
    return tuple(
        Subject(ROUTE, f"{path.stem} {route.id}", route.id, str(path), route.town, {}, digest)
        for route in routes
        if not drives.route_ids or route.id in drives.route_ids
    )


def _cases(drives: Drives, scenario_files: Sequence[Path]) -> tuple[Subject, ...]:
    """Cases with all that a variation makes of them."""
    design: Design | None = None
    if drives.sweep is not None:
        design = Sweep(drives.sweep, drives.sweep_seed)
    elif drives.grid is not None:
        design = Grid(drives.grid)
    fixed = tuple((name, str(value)) for name, value in drives.fixed.items())
    chosen = varied(cases_of(drives.cases, scenario_files), Variation(fixed=fixed, design=design, vary=drives.vary))
    return tuple(case_subject(playable) for playable in chosen)
