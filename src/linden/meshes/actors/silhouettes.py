"""The shapes of vehicles' bodies as shares of their boxes: the facts in data/silhouettes.json."""

import json
from functools import lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Span = tuple[float, float]


class Silhouette(NamedTuple):
    """A body from the side and from above, as data/silhouettes.json explains; lines are (N, 2) of x and share."""

    top: F64
    waist: F64
    bottom: F64
    plan: F64
    tumblehome: float  # how much narrower the roof is than the waist, as a share of the half width
    side_glass: tuple[Span, ...]
    glass_doors: tuple[Span, ...]
    rear_window: Span
    windscreen: Span
    grille: Span
    wide_lamps: bool


@lru_cache(maxsize=1)
def silhouettes() -> dict[str, Silhouette]:
    """Return the silhouette of each blueprint that has one, by its id."""
    facts = json.loads(resources.files("linden").joinpath("data/silhouettes.json").read_text("utf-8"))
    styles = {name: _silhouette(own) for name, own in facts["styles"].items()}
    return {blueprint_id: styles[style] for blueprint_id, style in facts["bodies"].items()}


def _silhouette(facts: dict[str, Any]) -> Silhouette:
    top, waist, bottom, plan = (np.array(facts[line], np.float64) for line in ("top", "waist", "bottom", "plan"))
    return Silhouette(
        top=top,
        waist=waist,
        bottom=bottom,
        plan=plan,
        tumblehome=facts["tumblehome"],
        side_glass=tuple((low, high) for low, high in facts["side_glass"]),
        glass_doors=tuple((low, high) for low, high in facts.get("glass_doors", ())),
        rear_window=(facts["rear_window"][0], facts["rear_window"][1]),
        windscreen=(facts["windscreen"][0], facts["windscreen"][1]),
        grille=(facts["grille"][0], facts["grille"][1]),
        wide_lamps=facts["wide_lamps"],
    )
