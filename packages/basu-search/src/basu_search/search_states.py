"""`SearchFiles`: all searches of a campaign; each has a file of its rounds, so that a resumed campaign repeats them.

A strand is one search: a case with a weather and a seed, for one agent. A file for each strand below ``search`` holds
its rounds. A resumed campaign reads them, so it drives what it would have driven.
"""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.campaigns.search_part import SEARCH, SearchPlace
from basu.campaigns.search_space import values_at
from basu.errors import UserError
from basu.files import read_json
from basu.output.report.documents import write_json
from basu_search.boundary_search import BoundarySearch
from basu_search.rare_event import CrossEntropy
from basu_search.rounds import Known, Round

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from basu.campaigns.plan import CampaignPlan
    from basu.campaigns.search_part import SearchKey, SearchPart
    from basu_search.rounds import Proposer

OWN_FAULTS = frozenset({"simulator", "setup", "benchmark"})  # say nothing of the agent


class Verdict(NamedTuple):
    """What a search reads of a row."""

    failed: float  # 1 failed, 0 passed, NaN not judged
    severity: float
    broken: bool


def verdict_of(row: Mapping[str, Any]) -> Verdict:
    """The verdict in a row of the table."""
    failed = math.nan if not row["judged"] else 0.0 if row["success"] else 1.0
    return Verdict(failed, float(row["severity"]), row["fault"] in OWN_FAULTS)


class SearchState:
    """One search."""

    def __init__(
        self, part: SearchPart, strand: int, path: Path, head: dict[str, Any], number_of: Callable[[int], int]
    ) -> None:
        """Take up its file, where there is one; ``number_of`` gives the number of the job at a place.

        Raises:
            UserError: the file cannot be read, or has other rounds than the settings say.
        """
        self.path, self._head, self._number_of = path, head, number_of
        self._space = part.space(strand)
        self._proposer = proposer_of(part, strand)
        self.rounds: list[Round] = []
        self.verdicts: dict[int, Verdict] = {}  # by place in the strand
        if path.exists():
            self.rounds = rounds_in(read_json(path, "the state of a search"))
            if [len(each.points) for each in self.rounds] != list(self._proposer.sizes[: len(self.rounds)]):
                raise UserError(f"{path} has other rounds than the campaign; name another place with --output")

    def point(self, place: int) -> dict[str, float] | None:
        """The values of a drive by name; None while a round before it is not complete.

        Raises:
            UserError: the disk is full.
        """
        while True:
            begin = 0
            for made in self.rounds:
                if place < begin + len(made.points):
                    return values_at(self._space, made.points[place - begin])
                begin += len(made.points)
            if any(before not in self.verdicts for before in range(begin)):
                return None
            self.rounds.append(self._proposer.propose(len(self.rounds), self.rounds, self._known(begin)))
            self._write()

    def _known(self, drives: int) -> Known:
        """The first so many drives, in the order of their places."""
        found = [self.verdicts[place] for place in range(drives)]
        points = [made.points for made in self.rounds]
        return Known(
            np.concatenate(points) if points else np.empty((0, len(self._space))),
            np.array([each.failed for each in found], dtype=np.float64),
            np.array([each.severity for each in found], dtype=np.float64),
            np.array([each.broken for each in found], dtype=np.bool_),
        )

    def _write(self) -> None:
        rounds, begin = [], 0
        for made in self.rounds:
            numbers = [self._number_of(begin + index) for index in range(len(made.points))]
            rounds.append({**made.about, "numbers": numbers, "points": made.points.tolist()})
            begin += len(made.points)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_json(self.path, {**self._head, "rounds": rounds})


class SearchFiles:
    """All searches of a campaign."""

    def __init__(self, plan: CampaignPlan, folder: Path) -> None:
        """Describe them; a strand's file is read when it is reached."""
        self._plan, self._folder = plan, folder / SEARCH
        self._states: dict[tuple[int, SearchKey], SearchState] = {}

    def values(self, number: int) -> dict[str, float] | None:
        """What a job's search has chosen; None while it has not, and for a job of no search an empty dictionary.

        Raises:
            UserError: a file of a search cannot be read or written.
        """
        place = self._plan.search_place(number)
        return {} if place is None else self._state(place.part, place.key).point(place.place)

    def count(self, row: Mapping[str, Any]) -> None:
        """Take in a row of the table.

        Raises:
            UserError: see ``values``.
        """
        place = self._plan.search_place(row["number"])
        if place is not None:
            self._state(place.part, place.key).verdicts[place.place] = verdict_of(row)

    def _state(self, index: int, key: SearchKey) -> SearchState:
        if (index, key) not in self._states:
            part, agent = self._plan.parts[index], self._plan.agents[key.agent].name
            assert part.search is not None, "only a search has strands"
            head = {"part": index, "strand": key.strand, "agent": agent, **part.search.about(key.strand)}
            path = self._folder / f"{index}-{key.strand}-{agent}.json"
            self._states[index, key] = SearchState(
                part.search,
                key.strand,
                path,
                head,
                lambda place: self._plan.search_number(SearchPlace(index, key, place)),
            )
        return self._states[index, key]


def proposer_of(part: SearchPart, strand: int) -> Proposer:
    """The way in which a strand proposes drives; agents begin with the same ones."""
    text = f"{part.about(strand)} {part.settings.seed}"
    seed = int(hashlib.sha256(text.encode()).hexdigest()[:8], 16)
    dimensions = len(part.space(strand))
    if part.estimate is not None:
        return CrossEntropy(part.estimate, dimensions, seed)
    assert part.search is not None, "it is one of the two"
    return BoundarySearch(part.search, dimensions, seed)


def rounds_in(document: dict[str, Any]) -> list[Round]:
    """The rounds in a strand's file."""
    return [
        Round(
            np.array(each["points"], dtype=np.float64),
            {key: value for key, value in each.items() if key not in {"points", "numbers"}},
        )
        for each in document["rounds"]
    ]
