"""The packaged cases of BASU placed on Linden's map, for scripts that export them, and the reasons of refusals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import carla

import linden
from basu.episode.spec import description_of
from basu.managers.placed_scenario import place_scenario
from basu.routing import lane_graph, plan
from basu.scenarios.cases import cases_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Scenario


class PlacedCase(NamedTuple):
    """A case, its scenario on its route, and the text of the map."""

    playable: Playable
    scenario: Scenario
    opendrive: str


def placed_cases(words: Sequence[str]) -> Iterator[PlacedCase]:
    """Yield the cases that words of the command line name, each with its scenario on its route."""
    opendrive = (Path(linden.__file__).parent / "data" / "Linden.xodr").read_text(encoding="utf-8")
    town = carla.Map("Linden", opendrive)
    lanes = lane_graph.build(town)
    for playable in cases_of(words):
        route = plan(town, description_of(playable, town), lanes)
        yield PlacedCase(playable, place_scenario(playable, route, town, own=True).scenario, opendrive)


def reasons(refusals: Iterable[str]) -> str:
    """Return the different reasons in the sentences of refused exports, as one cell of a table."""
    why = sorted({sentence.partition("cannot be exported: ")[2] for sentence in refusals if sentence})
    return "; ".join(one.removesuffix(" has no counterpart in OpenSCENARIO") for one in why)
