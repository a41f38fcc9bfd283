"""A [[drives]] with a search: which job of it belongs to which search, and the case that a point makes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from basu import plugins
from basu.scenarios.cases import varied
from basu.scenarios.variation import Variation

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import pyarrow as pa
    from markupsafe import Markup

    from basu.campaigns.plan import CampaignPlan
    from basu.campaigns.search_space import Space
    from basu.campaigns.settings import EstimateSettings, Search, Seeds
    from basu.scenarios.playable import Playable

SEARCH = "search"  # the folder of the searches' states


class SearchKey(NamedTuple):
    """A search of a part: a case with a weather and a seed, and an agent."""

    strand: int
    agent: int


class DriveWeight(NamedTuple):
    """What a drive counts in a rate: its importance weight, and the share of plain drives in its mixture."""

    weight: float = 1.0
    plain: float = 1.0


class SearchPlace(NamedTuple):
    """The place of a job in its search."""

    part: int
    key: SearchKey
    place: int  # from 0


@dataclass(frozen=True, slots=True)
class SearchPart:
    """The searches of one [[drives]]; cases change fastest, then weather, then seeds."""

    cases: tuple[Playable, ...]
    spaces: tuple[Space, ...]  # one a case
    fixed: tuple[tuple[str, str], ...]
    weather: tuple[str, ...]
    seeds: Seeds
    search: Search | None
    estimate: EstimateSettings | None
    sizes: tuple[int, ...]  # of the rounds of each search

    @property
    def settings(self) -> Search | EstimateSettings:
        """The search's or the estimate's."""
        found = self.estimate if self.search is None else self.search
        assert found is not None, "the settings have one of them"
        return found

    @property
    def strands(self) -> int:
        """The number of searches of each agent."""
        return len(self.cases) * len(self.weather) * self.seeds.number

    @property
    def size(self) -> int:
        """The number of conditions."""
        return self.strands * sum(self.sizes)

    def place(self, number: int) -> tuple[int, int]:
        """Search and place of a condition; a round of all strands comes before the next round."""
        first = 0
        for size in self.sizes:
            if number < self.strands * size:
                strand, place = divmod(number, size)
                return strand, first + place
            number -= self.strands * size
            first += size
        raise AssertionError("the number is one of the part")

    def number(self, strand: int, place: int) -> int:
        """The number of a condition: the inverse of ``place``."""
        first = 0
        for size in self.sizes:
            if place < first + size:
                return self.strands * first + strand * size + place - first
            first += size
        raise AssertionError("the place is one of the strand")

    def decides(self) -> list[Any]:
        """All that decides over the drives, as plain values."""
        spaces = [[each._asdict() for each in space] for space in self.spaces]
        return [spaces, self.fixed, self.sizes, self.settings.model_dump(mode="json")]

    def chosen(self, strand: int) -> tuple[Playable, str, int]:
        """The case, the weather and the seed of a strand."""
        rest, case = divmod(strand, len(self.cases))
        seed, weather = divmod(rest, len(self.weather))
        return self.cases[case], self.weather[weather], self.seeds.first + seed

    def space(self, strand: int) -> Space:
        """The space of a strand."""
        return self.spaces[strand % len(self.cases)]

    def playable(self, strand: int, values: Mapping[str, float]) -> Playable:
        """The case of a point."""
        case, _, _ = self.chosen(strand)
        fixed = (*self.fixed, *((name, repr(value)) for name, value in values.items()))
        (found,) = varied((case,), Variation(fixed=fixed))
        return found

    def about(self, strand: int) -> dict[str, Any]:
        """What a strand is, as plain values."""
        case, weather, seed = self.chosen(strand)
        return {
            "kind": "estimate" if self.search is None else "search",
            "subject": case.case.name,
            "weather": weather,
            "seed": seed,
            "space": [each._asdict() for each in self.space(strand)],
            "settings": self.settings.model_dump(mode="json"),
        }


class SearchStates(Protocol):
    """The state of every search of a campaign."""

    def values(self, number: int) -> dict[str, float] | None:
        """Return what a job's search has chosen; None while it has not, an empty dictionary for a job of no search."""

    def count(self, row: Mapping[str, Any]) -> None:
        """Take in a row of the table of drives."""


class SearchPlugin(Protocol):
    """What proposes the drives of searches and estimates: the entry point ``search`` of a plugin."""

    def sizes(self, part: SearchPart) -> tuple[int, ...]:
        """Return the number of drives in each round of a part's searches."""

    def states(self, plan: CampaignPlan, folder: Path) -> SearchStates:
        """Return the states of all searches of a campaign, which lie in its folder."""

    def weights(self, folder: Path, table: pa.Table) -> Mapping[int, DriveWeight | None]:
        """Return the weight of each drive of searches and estimates, by its number; None if it is no sample."""

    def section(self, folder: Path, table: pa.Table, confidence: float) -> Markup:
        """Return the section of a campaign's report on its searches and estimates."""


def search_plugin() -> SearchPlugin:
    """Return the plugin that proposes drives.

    Raises:
        UserError: it is not installed.
    """
    plugin: SearchPlugin = plugins.load(plugins.PARTS, "search", "a campaign with a search or an estimate")
    return plugin
