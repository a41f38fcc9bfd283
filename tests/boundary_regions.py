"""Failing regions of the unit cube, for claims about the search for a boundary; they stand in for a simulator.

``TUNING`` may be looked at while a search is being improved. ``HELD_OUT`` has other shapes, and each seed places them
elsewhere; figures that are reported come from there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from basu.campaigns.settings import Search
from basu_search.boundary_search import BoundarySearch
from basu_search.rounds import Known, Round

Points = NDArray[np.float64]
Gap = Callable[[Points], Points]  # (N, D) to (N,): the distance to a region, negative inside
Placed = Callable[[np.random.Generator], Gap]


class Region(NamedTuple):
    """A kind of region, placed by chance."""

    dimensions: int
    placed: Placed

    def gap(self, seed: int) -> Gap:
        """Return the region of a seed."""
        return self.placed(np.random.default_rng([7, seed]))


def known_of(points: Points, gap: Gap, *, leads: bool) -> Known:
    """Return what drives would have shown; severity grows towards failures where it leads, and is flat otherwise."""
    away = gap(points)
    failed = away < 0.0
    severity = np.where(failed, 1.0, 0.9 / (1.0 + np.maximum(away, 0.0)) if leads else 0.5)
    return Known(points, failed.astype(np.float64), severity, np.zeros(len(points), dtype=np.bool_))


def searched(settings: Search, dimensions: int, gap: Gap, seed: int, *, leads: bool) -> Points:
    """Return the drives (N, D) of a whole search."""
    search, rounds = BoundarySearch(settings, dimensions, seed), list[Round]()
    for number in range(len(search.sizes)):
        points = np.concatenate([np.empty((0, dimensions)), *[made.points for made in rounds]])
        rounds.append(search.propose(number, rounds, known_of(points, gap, leads=leads)))
    return np.concatenate([made.points for made in rounds])


def balls(radius: float, *centres: tuple[float, ...]) -> Gap:
    """Return balls at the given places."""
    places = np.array(centres)
    return lambda points: np.linalg.norm(points[:, None, :] - places, axis=2).min(axis=1) - radius


def beyond(depth: float, *direction: float) -> Gap:
    """Return all points whose product with the direction's unit vector is more than ``depth``."""
    unit = np.array(direction) / np.linalg.norm(direction)
    return lambda points: depth - points @ unit


def near(width: float, through: tuple[float, ...], *direction: float) -> Gap:
    """Return the strip of a half width around the plane through a point, across a direction."""
    unit = np.array(direction) / np.linalg.norm(direction)
    return lambda points: np.abs((points - np.array(through)) @ unit) - width


def corner(size: float, dimensions: int) -> Placed:
    """Return the cube of a size in a corner that chance chooses."""

    def placed(dice: np.random.Generator) -> Gap:
        ends = dice.integers(0, 2, dimensions)
        return lambda points: np.abs(points - ends).max(axis=1) - size

    return placed


def ball_anywhere(radius: float, dimensions: int, number: int = 1) -> Placed:
    """Return whole balls inside the cube that do not touch."""

    def placed(dice: np.random.Generator) -> Gap:
        while True:
            centres = dice.uniform(radius, 1.0 - radius, (number, dimensions))
            apart = np.linalg.norm(centres[:, None] - centres[None], axis=2) + 9.0 * np.eye(number)
            if apart.min() > 3.0 * radius:
                return balls(radius, *map(tuple, centres.tolist()))

    return placed


def _half(dice: np.random.Generator) -> Gap:
    """Return a third of the square or so, in any direction."""
    angle = dice.uniform(0.0, 2.0 * np.pi)
    unit = np.array([np.cos(angle), np.sin(angle)])
    return beyond(float(unit @ [0.5, 0.5] + dice.uniform(0.1, 0.25)), *unit)


TUNING = {
    "disc 4.5 %": Region(2, lambda _: balls(0.12, (0.7, 0.3))),
    "two discs": Region(2, lambda _: balls(0.1, (0.25, 0.25), (0.75, 0.7))),
    "disc 28 %": Region(2, lambda _: balls(0.3, (0.4, 0.55))),
    "ball 5 %, 3 parameters": Region(3, lambda _: balls(0.23, (0.35, 0.6, 0.5))),
}
HELD_OUT = {
    "disc 4.5 %": Region(2, ball_anywhere(0.12, 2)),
    "two discs, 5.7 %": Region(2, ball_anywhere(0.095, 2, 2)),
    "corner 4.8 %": Region(2, corner(0.22, 2)),
    "band 12 %": Region(2, lambda dice: near(0.06, (dice.uniform(0.2, 0.8), 0.5), 1.0, 0.0)),
    "half plane": Region(2, _half),
    "thin diagonal 8 %": Region(2, lambda dice: near(0.03, (0.5, dice.uniform(0.35, 0.65)), 1.0, dice.choice([-1, 1]))),
    "ball 4.5 %, 3 parameters": Region(3, ball_anywhere(0.22, 3)),
    "corner 6.4 %, 3 parameters": Region(3, corner(0.4, 3)),
}
