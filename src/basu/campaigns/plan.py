"""The jobs of a campaign: agents, routes or cases, weather, traffic and seeds as a product that needs no list."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.agents.process.remote_agent import find_agent
from basu.campaigns.search.part import SearchPart, SearchPlace, StrandKey
from basu.campaigns.settings import AS_GIVEN, Campaign, OtherTraffic, Seeds
from basu.campaigns.shuffle import Shuffle
from basu.episode.world import weather_called
from basu.errors import UserError
from basu.files import find, places
from basu.jobs.job import versions
from basu.metrics.scoring import Scoring, scoring_layer, scoring_to_json
from basu.output.report.documents import plain
from basu.routing.route_file import read_routes
from basu.scenarios.cases import cases_of, file_in, files_among, files_named, varied
from basu.scenarios.parameters import Number
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.variation import Variation
from basu.settings.resolve import resolve

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.campaigns.settings import Drives
    from basu.scenarios.playable import Playable
    from basu.scenarios.sampling import Design

ROUTE, CASE = "route", "case"
ID_DIGITS = 16  # of a job's id, hexadecimal: two of 10^6 jobs collide with a probability of 3e-8


class Subject(NamedTuple):
    """What is driven: a route of a file, or a case."""

    kind: str  # ROUTE or CASE
    name: str  # the route's file and id, or the case's id without its variation
    identity: str  # the case's id with its variation; the route's id
    file: str  # the route file; "" for a case
    town: str
    parameters: dict[str, float | str]
    digest: str  # of what the name stands for


class PlannedAgent(NamedTuple):
    """An agent of a campaign."""

    typed: str  # as the worker finds it: a name, or a file with its whole path
    name: str  # for folders and tables
    digest: str  # of its file; "" for BASU's own


@dataclass(frozen=True, slots=True)
class Part:
    """One [[drives]]: every subject by every weather, traffic and seed."""

    subjects: tuple[Subject, ...]
    weather: tuple[str, ...]
    traffic: tuple[OtherTraffic, ...]
    seeds: Seeds
    has_scenarios: bool
    search: SearchPart | None = None  # then the subjects are its cases

    @property
    def size(self) -> int:
        """The number of conditions."""
        if self.search is not None:
            return self.search.size
        return math.prod((len(self.subjects), len(self.weather), len(self.traffic), self.seeds.number))

    def digest(self) -> str:
        """SHA-256 of what decides over the conditions; paths of files do not."""
        subjects = [(each.kind, each.identity, each.digest) for each in self.subjects]
        others = [model.model_dump() for model in (*self.traffic, self.seeds)]
        found = [subjects, self.weather, others, self.has_scenarios]
        return digest_of(found if self.search is None else [*found, self.search.decides()])

    def condition(self, number: int, values: Mapping[str, float]) -> dict[str, Any]:
        """The condition of a number; subjects change fastest and seeds slowest, so a beginning has all subjects.

        ``values`` are what a search has chosen; empty without one.
        """
        if self.search is not None:
            strand, _ = self.search.place(number)
            _, weather, seed = self.search.chosen(strand)
            return self._condition(_case(self.search.playable(strand, values)), weather, self.traffic[0], seed)
        rest, subject = divmod(number, len(self.subjects))
        rest, at_weather = divmod(rest, len(self.weather))
        at_seed, traffic = divmod(rest, len(self.traffic))
        return self._condition(
            self.subjects[subject], self.weather[at_weather], self.traffic[traffic], self.seeds.first + at_seed
        )

    def _condition(self, chosen: Subject, weather: str, others: OtherTraffic, seed: int) -> dict[str, Any]:
        """A condition as plain values."""
        return {
            "kind": chosen.kind,
            "subject": chosen.name,
            "identity": chosen.identity,
            "file": chosen.file,
            "town": chosen.town,
            "parameters": chosen.parameters,
            "scenarios": self.has_scenarios,
            "weather": weather,
            "vehicles": others.vehicles,
            "walkers": others.walkers,
            "density_per_km": others.density_per_km,
            "seed": seed,
            "digest": chosen.digest,
        }


@dataclass(frozen=True, slots=True)
class CampaignPlan:
    """All jobs of a campaign. Agents change fastest, so a beginning has all agents on the same conditions."""

    campaign: Campaign
    agents: tuple[PlannedAgent, ...]
    parts: tuple[Part, ...]
    scoring: Scoring
    scenario_files: tuple[Path, ...]
    metric_files: tuple[Path, ...]
    shared: str  # digest of what decides over every drive: vehicle, scoring, versions

    @property
    def conditions(self) -> int:
        """The number of conditions."""
        return sum(part.size for part in self.parts)

    @property
    def size(self) -> int:
        """The number of jobs."""
        return self.conditions * len(self.agents)

    def job(self, number: int, values: Mapping[str, float] | None = None) -> dict[str, Any]:
        """The job of a number as plain data, with its id; ``values`` are what its search has chosen."""
        place, agent = divmod(number, len(self.agents))
        if self.campaign.order == "shuffled":
            place = Shuffle(self.conditions, self.campaign.shuffle_seed)(place)
        index, place = self._part(place)
        condition, chosen = self.parts[index].condition(place, values or {}), self.agents[agent]
        fixed = {
            **{key: value for key, value in condition.items() if key not in {"file", "parameters"}},
            "agent": [chosen.name, chosen.digest],
            "shared": self.shared,
        }
        condition.pop("digest")
        return {"id": digest_of(fixed)[:ID_DIGITS], "agent": chosen.typed, "agent_name": chosen.name, **condition}

    def search_place(self, number: int) -> SearchPlace | None:
        """The place of a job in its search; None where it is in none."""
        place, agent = divmod(number, len(self.agents))
        index, place = self._part(place)
        search = self.parts[index].search
        if search is None:
            return None
        strand, within = search.place(place)
        return SearchPlace(index, StrandKey(strand, agent), within)

    def search_number(self, place: SearchPlace) -> int:
        """The number of the job at a place of a search."""
        search = self.parts[place.part].search
        assert search is not None, "the place is one of a search"
        before = sum(part.size for part in self.parts[: place.part])
        return (before + search.number(place.key.strand, place.place)) * len(self.agents) + place.key.agent

    def _part(self, place: int) -> tuple[int, int]:
        """The part of a condition, and its place there."""
        for index, part in enumerate(self.parts):
            if place < part.size:
                return index, place
            place -= part.size
        raise AssertionError("the number is one of the campaign")

    def parameters(self) -> dict[str, type]:
        """The names of all parameters with their types, in alphabetical order."""
        found: dict[str, type] = {}
        for part in self.parts:
            for subject in part.subjects:
                for name, value in subject.parameters.items():
                    kind = str if isinstance(value, str) else float
                    found[name] = kind if found.get(name, kind) is kind else str
        return dict(sorted(found.items()))

    def identity(self) -> dict[str, Any]:
        """All that the results depend on, by name, for a comparison before a campaign goes on."""
        return {
            "the agents": [f"{agent.name} {agent.digest}".rstrip() for agent in self.agents],
            "the drives": digest_of([part.digest() for part in self.parts])[:ID_DIGITS],
            "the number of drives": self.size,
            "the order": [self.campaign.order, self.campaign.shuffle_seed],
            "the block": self.campaign.block,
            "the stopping rule": None if self.campaign.until is None else self.campaign.until.model_dump(),
            "the confidence": self.campaign.confidence,
            "the vehicle": self.campaign.vehicle,
            "the step limit": self.campaign.step_limit_s,
            "the scoring": scoring_to_json(self.scoring),
            "the metrics": [digest_of(path.read_text(encoding="utf-8"))[:ID_DIGITS] for path in self.metric_files],
            **{f"the version of {name}": text for name, text in versions().items()},
        }  # fmt: skip


def digest_of(value: Any) -> str:  # noqa: ANN401 - plain values
    """SHA-256 of a value as canonical JSON."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()


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
    shared = digest_of([campaign.vehicle, scoring_to_json(scoring), versions()])
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
        found = find_agent(typed, memory_gb=campaign.agent_memory_gb)
    except UserError as error:
        raise UserError(f"{source}: {error}") from None
    if found.is_human:
        raise UserError(f"{source}: a person drives the agent '{typed}', which a campaign cannot wait for; remove it")
    return PlannedAgent(typed, plain(found.name), digest)


def _part(drives: Drives, campaign: Campaign, source: Path, scenario_files: Sequence[Path]) -> Part:
    """One [[drives]] with all that it names.

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
        UserError: a parameter cannot be searched over, or the extra is not installed.
    """
    from basu.campaigns.search.space import space_of  # noqa: PLC0415 - numpy, which other campaigns need later
    from basu.campaigns.search.strands import proposer_of  # noqa: PLC0415 - scipy and scikit-learn, an extra

    fixed = tuple((name, str(value)) for name, value in drives.fixed.items())
    cases = varied(cases_of(drives.cases, scenario_files), Variation(fixed=fixed))
    normal = {} if drives.estimate is None else drives.estimate.normal
    spaces = tuple(space_of(case, drives.vary, drives.fixed, normal) for case in cases)
    seeds = drives.seeds or campaign.seeds
    part = SearchPart(cases, spaces, fixed, weather, seeds, drives.search, drives.estimate, ())
    part = replace(part, sizes=proposer_of(part, 0).sizes)
    subjects = tuple(_case(case) for case in cases)
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
    return tuple(_case(playable) for playable in chosen)


def _case(playable: Playable) -> Subject:
    case = playable.case
    values: Mapping[str, float | str] = playable.values
    numbers = {each.name for each in playable.parameters if isinstance(each, Number)}
    parameters = {name: float(value) if name in numbers else str(value) for name, value in values.items()}
    digest = digest_of([repr(replace(case, source="")), parameters])[:ID_DIGITS]  # the same on every machine
    return Subject(CASE, case.name.partition(":")[0], case.name, "", case.town, parameters, digest)
