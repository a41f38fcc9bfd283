"""`Round` (proposed drives), `Known` (finished drives) and `Proposer`, the protocol of both kinds of search."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from scipy.stats import qmc

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Known(NamedTuple):
    """The drives of complete rounds, N of them in D dimensions."""

    points: NDArray[np.float64]  # (N, D) of the unit cube
    failed: NDArray[np.float64]  # (N,) 1 failed, 0 passed, NaN not judged
    severity: NDArray[np.float64]  # (N,) 0 good to 1 failed
    broken: NDArray[np.bool_]  # (N,) ended by a fault that is not the agent's


class Round(NamedTuple):
    """The proposals of a round."""

    points: NDArray[np.float64]  # (n, D) of the unit cube
    about: dict[str, Any]  # plain values with which they were drawn


class Proposer(Protocol):
    """A way to propose drives."""

    @property
    def sizes(self) -> tuple[int, ...]:
        """The number of drives in each round."""

    def propose(self, number: int, rounds: list[Round], known: Known) -> Round:
        """The round of a number from all rounds before it; the same for the same input."""


def space_filling(count: int, dimensions: int, seed: int) -> NDArray[np.float64]:
    """(count, D) points of a scrambled Sobol sequence: Sobol 1967; Owen 1998 for the scrambling."""
    bits = max(0, int(count - 1).bit_length())
    points: NDArray[np.float64] = qmc.Sobol(dimensions, rng=np.random.default_rng(seed)).random_base2(bits)[:count]
    return points


def round_sizes(first: int, drives: int, batch: int) -> tuple[int, ...]:
    """The sizes of rounds: the first, then batches until there are enough drives."""
    rest = drives - first
    return tuple(size for size in (first, *([batch] * (rest // batch)), rest % batch) if size)
