"""What is told of every case, whether its scenario asks for it or not: how near anybody came, in metres and seconds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.criteria.margins.least_distance import LeastDistance
from basu.scenarios.criteria.margins.least_ttc import LeastTtc
from basu.scenarios.criteria.margins.pet import Pet

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.criteria.criterion import Criterion, Judgement
    from basu.scenarios.criteria.margins.margin import Margin

MARGINS: dict[str, type[Margin]] = {"distance_m": LeastDistance, "ttc_s": LeastTtc, "pet_s": Pet}


def told_always(criteria: Sequence[Criterion] = ()) -> tuple[Criterion, ...]:
    """The three margins to everybody, not deciding, without those that ``criteria`` have already."""
    names = {criterion.name for criterion in criteria}
    return tuple(margin() for margin in MARGINS.values() if margin.called not in names)


def margins_of(judgements: Sequence[Judgement]) -> dict[str, float | None]:
    """How narrowly: the least figure told of each margin, by the keys of ``MARGINS``; None where nobody was near."""
    return {
        key: min(
            (
                judgement.measured
                for judgement in judgements
                if judgement.measured is not None and _is_of(margin, judgement.criterion)
            ),
            default=None,
        )
        for key, margin in MARGINS.items()
    }


def _is_of(margin: type[Margin], name: str) -> bool:
    """Whether a criterion's name is this margin's, to everybody or to somebody."""
    return name == margin.called or name.startswith(f"{margin.called} to ")
