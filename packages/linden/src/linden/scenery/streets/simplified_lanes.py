"""Simplified lanes for drawing: edges along the roads at as few places as straight lines between them allow.

Wheels feel the road in every place where it was sampled. Most of these lie on straight lines between their neighbours:
they are left out here, all lanes of a section in the same places, so that no cracks open between them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.maps.opendrive.evaluate.strips import Samples, Strips, edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Flags = NDArray[np.bool_]

ASIDE_M, ABOVE_M = 0.01, 0.003
"""How far a straight piece may leave the sampled edge; upwards less, for paint lies 6 mm above its lane."""
LONGEST_M = 40.0  # long slanting pieces have large bounds, and rays meet bounds first
_MOST_TURNS = 24


class SimplifiedLanes(NamedTuple):
    """Lane after lane, the places of each in ascending s; all (P,) but ``tables`` and ``samples``."""

    tables: Tables
    samples: Samples  # that were kept
    lane: I64  # row of ``tables.lanes``
    s_m: F64
    probe_m: F64
    continues: Flags  # whether the next row lies further along the same lane
    inner: F64  # (P, 3), CARLA's frame, m, lifted by the lane's heights
    outer: F64


def simplified_lanes(opendrive: OpenDrive) -> SimplifiedLanes:
    """Return all lanes of a map."""
    tables = tables_of(opendrive)
    strips = strips_of(tables)
    inner, outer = (points_from_opendrive(edge) for edge in edges_of(tables, strips))
    kept = _kept(strips, inner, outer)
    rows = np.flatnonzero(kept[strips.place])
    every = strips.samples
    samples = Samples(every.road[kept], every.section[kept], every.s_m[kept], every.probe_m[kept])
    lane = strips.lane[rows]
    goes_on = np.append(lane[1:] == lane[:-1], [False])[: len(lane)]
    return SimplifiedLanes(
        tables, samples, lane, strips.s_m[rows], strips.probe_m[rows], goes_on, inner[rows], outer[rows]
    )


def _kept(strips: Strips, inner: F64, outer: F64) -> Flags:
    """Return which of the samples stay: every other one is dropped, turn after turn, where all edges allow."""
    section = strips.samples.section
    number = np.arange(len(section))
    begins = np.append([True], section[1:] != section[:-1])[: len(section)]
    is_end = begins | np.append(begins[1:], [True])[: len(section)]
    begin_of = np.maximum.accumulate(np.where(begins, number, 0)) if len(section) else number
    edges = _Edges(strips, inner, outer)
    kept = np.ones(len(section), bool)
    for turn in range(_MOST_TURNS):
        rank = np.cumsum(kept)
        tried = kept & ~is_end & ((rank - rank[begin_of] + turn) % 2 == 1)
        left = kept & ~tried
        before = np.maximum.accumulate(np.where(left, number, -1))
        after = np.minimum.accumulate(np.where(left, number, len(number))[::-1])[::-1]
        dropped = tried & edges.straight(~left, before, after)[before]
        if turn % 2 and not dropped.any():
            break
        kept &= ~dropped
    return kept


class _Edges:
    """Both edges of all lanes, to be asked how straight they are."""

    def __init__(self, strips: Strips, inner: F64, outer: F64) -> None:
        self._points = np.concatenate([inner, outer])
        self._place = np.concatenate([strips.place, strips.place])
        # the rows of a lane follow each other as its samples do, so a row is its sample's number and something more
        self._offset = np.arange(2 * len(strips.place)) - self._place

    def straight(self, between: Flags, before: I64, after: I64) -> Flags:
        """Return for each sample that begins a piece whether all edges are straight from there to the piece's end.

        ``between`` (S,) are the samples inside pieces, ``before`` and ``after`` (S,) the ends of each one's piece.
        """
        rows = np.flatnonzero(between[self._place])
        place, offset = self._place[rows], self._offset[rows]
        begin, end = self._points[offset + before[place]], self._points[offset + after[place]]
        ahead, away = end - begin, self._points[rows] - begin
        squared = np.einsum("ij,ij->i", ahead[:, :2], ahead[:, :2])
        share = np.einsum("ij,ij->i", away[:, :2], ahead[:, :2]) / np.maximum(squared, 1e-12)
        away -= np.clip(share, 0.0, 1.0)[:, None] * ahead
        bent = np.hypot(away[:, 0], away[:, 1]) > ASIDE_M
        bent |= (np.abs(away[:, 2]) > ABOVE_M) | (squared > LONGEST_M**2)
        straight = np.ones(len(between), bool)
        straight[before[place[bent]]] = False
        return straight
