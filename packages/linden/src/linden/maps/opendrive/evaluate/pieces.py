"""Piecewise cubics of many owners (roads, lanes) in one set of arrays."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.model import Cubic

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


class Pieces(NamedTuple):
    """Records sorted by owner, then by start. The key is the owner's base plus the start: one search finds a record."""

    base_m: F64  # (owners,), far enough apart that no key of one owner reaches into the next
    first: I64  # (owners,), index of the owner's first record
    key_m: F64  # (records,)
    start_m: F64  # (records,)
    coefficients: F64  # (records, 4): a, b, c, d

    def find(self, owner: I64, s_m: F64) -> I64:
        """Return the index of the record that holds for each owner at each s (the first one before its start)."""
        return np.maximum(np.searchsorted(self.key_m, self.base_m[owner] + s_m, side="right") - 1, self.first[owner])

    def value(self, owner: I64, s_m: F64, probe_m: F64 | None = None) -> F64:
        """Return the cubics at s. ``probe_m`` chooses the record instead of s, for values just before a jump."""
        record = self.find(owner, s_m if probe_m is None else probe_m)
        a, b, c, d = self.coefficients[record].T
        along = s_m - self.start_m[record]
        value: F64 = a + along * (b + along * (c + along * d))
        return value

    def slope(self, owner: I64, s_m: F64) -> F64:
        """Return the derivative of the cubics at s."""
        record = self.find(owner, s_m)
        _, b, c, d = self.coefficients[record].T
        along = s_m - self.start_m[record]
        slope: F64 = b + along * (2.0 * c + along * 3.0 * d)
        return slope


def bases_of(lengths_m: Sequence[float]) -> F64:
    """Return a base for each owner so that [base, base + length] ranges lie apart, by 1 m at least."""
    return np.concatenate([[0.0], np.cumsum(np.asarray(lengths_m, dtype=np.float64) + 1.0)[:-1]])


def pieces_of(owners: Iterable[tuple[float, Sequence[Cubic]]], lengths_m: Sequence[float]) -> Pieces:
    """Flatten (start of the owner's own records, records) pairs; an owner without records gets a zero.

    The start is added to every record's: lane records count from their section.
    """
    numbers: list[float] = []  # five a record, one after the other: numpy reads a flat list far faster than tuples
    origins_m: list[float] = []
    counts: list[int] = []
    for origin_m, records in owners:
        ordered = records if len(records) < 2 else sorted(records, key=lambda record: record.start_m)
        for record in ordered or (_ZERO,):
            numbers += record
        origins_m.append(origin_m)
        counts.append(max(len(records), 1))
    table = np.array(numbers).reshape(-1, 5)
    base_m = bases_of(lengths_m) if counts else np.empty(0)
    start_m = np.repeat(np.array(origins_m), counts) + table[:, 0]
    first = np.cumsum([0, *counts[:-1]], dtype=np.int64)[: len(counts)]
    return Pieces(base_m, first, np.repeat(base_m, counts) + start_m, start_m, table[:, 1:])


_ZERO = Cubic(0.0, 0.0)
