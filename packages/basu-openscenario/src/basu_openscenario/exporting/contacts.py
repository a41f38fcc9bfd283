"""`passed_through`: which actors of a rehearsal meet others, where a storyboard lets bodies pass through each other."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.criteria.surrogate_measures import gap_m
from basu.scenarios.stage import EGO
from basu.testing.offline_stage import half_sizes_m

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.testing import Rehearsal

NEAR_M = 0.3
"""Boxes so near count as touching, since a server's boxes may be some centimetres larger than a rehearsal's."""


def passed_through(played: Rehearsal, blueprints: Mapping[str, str]) -> frozenset[str]:
    """Return the actors that others must pass through, so that all of them keep to their trajectories.

    Where the boxes of two vehicles, pedestrians or things touch in the rehearsal, this is the ego or the first one.

    Args:
        played: the rehearsal.
        blueprints: the id of each actor's blueprint, by its name.
    """
    found = set()
    names = sorted(blueprints, key=lambda name: name != EGO)
    for one, other in itertools.combinations(names, 2):
        if one not in found and float(_gaps_m(played, (one, other), blueprints).min(initial=np.inf)) <= NEAR_M:
            found.add(one)
    return frozenset(found)


def _gaps_m(played: Rehearsal, pair: tuple[str, str], blueprints: Mapping[str, str]) -> NDArray[np.float64]:
    """Return the distances (N,) in m of two actors' boxes in the frames in which both are there."""
    trails = [played.trails[name] for name in pair]
    both = ~np.isnan(trails[0][:, 0]) & ~np.isnan(trails[1][:, 0])
    boxes = [
        np.column_stack([trail[both, :3], np.tile(half_sizes_m(blueprints[name]), (np.count_nonzero(both), 1))])
        for trail, name in zip(trails, pair, strict=True)
    ]
    return gap_m(boxes[0], boxes[1])
