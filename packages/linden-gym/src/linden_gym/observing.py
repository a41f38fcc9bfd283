"""Observations of many vehicles by the functions of `basu.gym_view`, compiled, on all processors.

`basu` needs no compiler, so its functions call each other as Python does. Here each is compiled with all that it calls.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from basu import gym_view
from basu.gym_spaces import empty_views
from basu.gym_view import OTHERS, EgoRows, Others, Places
from linden.compiled import fingerprint, unlocked
from linden.sensors.casting.thread_pool import in_stretches
from linden_gym.following import parts_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.gym_view import RouteColumns

FEWEST = 128
"""Vehicles that a thread takes at least; they take some 0.05 ms."""

CALLED_FIRST = ("bounded", "turned", "piece_at", "between", "put_ego", "put_others", "put_view")
"""Functions of `basu.gym_view`; each calls only those before it."""


put_view = parts_of(gym_view, *CALLED_FIRST)


def _build(sources: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel of the processor; ``sources`` is part of the name of its file."""

    def put_views(
        start: int, stop: int, route: RouteColumns, ego: EgoRows, places: Places, others: Others, found: gym_view.Views
    ) -> None:  # pragma: no cover - compiled
        """Write the observations of vehicles from ``start`` to ``stop``."""
        away_m = np.empty(OTHERS)
        for k in range(start, stop if sources >= 0 else start):
            put_view(k, route, ego, places, others, away_m, found)

    return unlocked(put_views)


_put_views = _build(fingerprint(Path(gym_view.__file__)))


def observed(
    route: RouteColumns, ego: EgoRows, places: Places, others: Others, threads: int
) -> dict[str, NDArray[np.float32]]:
    """Return the observations of E vehicles; at most ``threads`` work, 0 being all processors."""
    found = empty_views(len(ego.x_m))
    ego = EgoRows(*map(np.ascontiguousarray, ego))
    places = Places._make(np.ascontiguousarray(column) for column in places)
    others = Others._make(np.ascontiguousarray(column) for column in others)

    def work(start: int, stop: int) -> None:
        _put_views(start, stop, route, ego, places, others, found)

    in_stretches(len(ego.x_m), work, multiple=1, fewest=FEWEST, threads=threads)
    return found._asdict()
