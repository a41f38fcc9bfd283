"""`CampaignPlan`: computes job number N from agents, routes or cases, weather, traffic and seeds."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.campaigns.search_part import SearchKey, SearchPart, SearchPlace
from basu.campaigns.settings import Campaign, OtherTraffic, Seeds
from basu.campaigns.shuffle import Shuffle
from basu.conditions import WORLD
from basu.jobs.job import versions
from basu.metrics.scoring import Scoring, scoring_to_json
from basu.output.report.tracks import track_of
from basu.scenarios.parameters import Number

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.scenarios.playable import Playable

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
    track: str = WORLD  # what it learns of others
    is_track_given: bool = False  # by the campaign's file, and not by config()
    is_open: bool = False  # driven without the gate

    @property
    def group(self) -> str:
        """The name of the tables of its drives: the track, with a mark if no gate stood before the agent."""
        return track_of({"track": self.track, "open": self.is_open})


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
            return self._condition(case_subject(self.search.playable(strand, values)), weather, self.traffic[0], seed)
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
            "agent": [chosen.name, chosen.digest, *([chosen.track] if chosen.is_track_given else [])],
            "shared": self.shared,
        }
        condition.pop("digest")
        identity = digest_of(fixed)[:ID_DIGITS]
        return {
            "id": identity,
            "agent": chosen.typed,
            "agent_name": chosen.name,
            "track": chosen.track,
            **condition,
        }

    def search_place(self, number: int) -> SearchPlace | None:
        """The place of a job in its search; None where it is in none."""
        place, agent = divmod(number, len(self.agents))
        index, place = self._part(place)
        search = self.parts[index].search
        if search is None:
            return None
        strand, within = search.place(place)
        return SearchPlace(index, SearchKey(strand, agent), within)

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
            "the tracks": {agent.name: agent.group for agent in self.agents},
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


def case_subject(playable: Playable) -> Subject:
    """Return a case with its variation as a subject."""
    case = playable.case
    values: Mapping[str, float | str] = playable.values
    numbers = {each.name for each in playable.parameters if isinstance(each, Number)}
    parameters = {name: float(value) if name in numbers else str(value) for name, value in values.items()}
    digest = digest_of([repr(replace(case, source="")), parameters])[:ID_DIGITS]  # the same on every machine
    return Subject(CASE, case.name.partition(":")[0], case.name, "", case.town, parameters, digest)
