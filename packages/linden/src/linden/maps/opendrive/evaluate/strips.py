"""Lanes as strips: sample places along every lane section, and the edges of the lanes at these places.

The places are so dense that straight lines between them follow the road closely. Mesh, look-ups and drawings use the
strips.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.pieces import F64, I64, Pieces
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.limits import MOST_PLACES, refuse_beyond

STRAIGHT_STEP_M = 10.0  # where the reference line is straight and all profiles are linear
CURVED_STEP_M = 2.0
SHORTEST_STEP_M = 0.25  # reached at a radius of 0.4 m, which no vehicle drives
# A chord leaves its curve by no more than this: step = sqrt(8 · error · radius), for small angles.
CHORD_ERROR_M = 0.02
_SMALLEST_PIECE_M = 1e-6


class Samples(NamedTuple):
    """Places in ascending order within each lane section, its two ends among them; all (N,)."""

    road: I64  # index of the road
    section: I64  # index of the section, over the whole map
    s_m: F64
    probe_m: F64  # inside the piece the place belongs to: chooses the records there


class Sections(NamedTuple):
    """All lane sections of a map in order; all (sections,)."""

    road: I64
    start_m: F64
    end_m: F64


def sections_of(tables: Tables) -> Sections:
    """Return every lane section of the map."""
    rows = [
        (road_index, section.s_m, section.end_m)
        for road_index, road in enumerate(tables.roads)
        for section in road.sections
    ]
    table = np.asarray(rows, dtype=np.float64).reshape(-1, 3)
    return Sections(table[:, 0].astype(np.int64), table[:, 1], table[:, 2])


def sections_before(tables: Tables) -> I64:
    """Return (roads + 1,) how many sections the roads before each one have; the last tells how many there are."""
    return np.cumsum([0, *(len(road.sections) for road in tables.roads)], dtype=np.int64)


def sample(tables: Tables, sections: Sections) -> Samples:
    """Cut every section where any record begins, and each piece into equal steps fit for its shape."""
    base_m = tables.curves.base_m
    low, high = base_m[sections.road] + sections.start_m, base_m[sections.road] + sections.end_m
    cuts = np.unique(np.concatenate([low, high, *_starts(tables)]))
    cuts = cuts[np.concatenate([[True], np.diff(cuts) > _SMALLEST_PIECE_M])] if len(cuts) else cuts
    section = np.searchsorted(low, (cuts[:-1] + cuts[1:]) / 2.0, side="right") - 1
    middle = (cuts[:-1] + cuts[1:]) / 2.0
    inside = (section >= 0) & (middle < high[np.maximum(section, 0)])
    section, start, end, middle = section[inside], cuts[:-1][inside], cuts[1:][inside], middle[inside]
    road = sections.road[section]
    start_m, end_m, middle_m = start - base_m[road], end - base_m[road], middle - base_m[road]
    steps = np.maximum(np.ceil((end_m - start_m) / _step_m(tables, road, section, middle_m)), 1.0).astype(np.int64)
    last = np.append(section[1:] != section[:-1], [True])[: len(section)]  # its end closes the section
    counts = steps + last
    piece = np.repeat(np.arange(len(steps)), counts)
    nth = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
    s_m = start_m[piece] + (end_m - start_m)[piece] * (nth / steps[piece])
    s_m = np.clip(s_m, sections.start_m[section[piece]], sections.end_m[section[piece]])
    return Samples(road[piece], section[piece], s_m, middle_m[piece])


def _starts(tables: Tables) -> list[F64]:
    """Return the places, in keys of roads, where any record begins."""
    road_of_lane = tables.lanes["road"]
    base_m = tables.curves.base_m
    starts = [tables.curves.key_m, tables.elevation.key_m, tables.lane_offset.key_m]
    for pieces in (tables.widths, tables.heights_inner, tables.heights_outer, tables.speeds):
        owner = _owners(pieces)
        starts.append(base_m[road_of_lane[owner]] + pieces.start_m)
    return starts


def _owners(pieces: Pieces) -> I64:
    counts = np.diff(np.append(pieces.first, len(pieces.start_m)))
    return np.repeat(np.arange(len(pieces.first)), counts)


def _step_m(tables: Tables, road: I64, section: I64, middle_m: F64) -> F64:
    """Return the longest step that each piece allows."""
    sharpest = tables.curves.sharpest_per_m()[tables.curves.find(road, middle_m)]
    bent = _bends(tables.elevation, road, middle_m) | _bends(tables.lane_offset, road, middle_m)
    bent |= _sections_with_bent_widths(tables, int(section.max(initial=0)) + 1)[section]
    by_radius = np.sqrt(8.0 * CHORD_ERROR_M / np.maximum(sharpest, 1e-12))
    on_curve = np.clip(by_radius, SHORTEST_STEP_M, CURVED_STEP_M)
    return np.where(sharpest > 0.0, on_curve, np.where(bent, CURVED_STEP_M, STRAIGHT_STEP_M))


def _bends(pieces: Pieces, owner: I64, s_m: F64) -> NDArray[np.bool_]:
    """Return whether the record that holds is more than linear."""
    bends: NDArray[np.bool_] = np.any(pieces.coefficients[pieces.find(owner, s_m)][:, 2:] != 0.0, axis=1)
    return bends


def _sections_with_bent_widths(tables: Tables, sections: int) -> NDArray[np.bool_]:
    bent = np.zeros(sections, dtype=np.bool_)
    lanes = tables.lanes
    owner = _owners(tables.widths)[np.any(tables.widths.coefficients[:, 2:] != 0.0, axis=1)]
    bent[sections_before(tables)[lanes["road"][owner]] + lanes["section"][owner]] = True
    return bent


class Strips(NamedTuple):
    """Lane after lane, each with all places of its section in ascending s; all (P,) but ``samples``."""

    samples: Samples
    lane: I64  # row of Tables.lanes
    place: I64  # row of ``samples``
    continues: NDArray[np.bool_]  # whether the next row lies further along the same lane

    @property
    def s_m(self) -> F64:
        """S along the road."""
        return self.samples.s_m[self.place]

    @property
    def probe_m(self) -> F64:
        """The s that chooses the records that hold there."""
        return self.samples.probe_m[self.place]


class Edges(NamedTuple):
    """Both edges of the lanes of a :class:`Strips`, (P, 3) in m, in OpenDRIVE's frame, lifted by the lanes' heights."""

    inner: F64
    outer: F64


def strips_of(tables: Tables, rows: I64 | None = None) -> Strips:
    """Lay out all lanes, or those of the given rows of Tables.lanes."""
    samples = sample(tables, sections_of(tables))
    rows = np.arange(len(tables.lanes)) if rows is None else rows
    before = sections_before(tables)
    count_of_section = np.bincount(samples.section, minlength=int(before[-1]))
    first_of_section = np.cumsum(count_of_section) - count_of_section
    section = before[tables.lanes["road"][rows]] + tables.lanes["section"][rows]
    counts = count_of_section[section]
    refuse_beyond(counts.sum(), MOST_PLACES, "places along its lanes, section by section and lane by lane")
    of_row = np.repeat(np.arange(len(rows)), counts)
    nth = np.arange(len(of_row)) - np.repeat(np.cumsum(counts) - counts, counts)
    return Strips(samples, rows[of_row], first_of_section[section[of_row]] + nth, nth < counts[of_row] - 1)


def edges_of(tables: Tables, strips: Strips) -> Edges:
    """Return where the edges of the strips lie."""
    samples, place = strips.samples, strips.place
    s_m, probe_m = strips.s_m, strips.probe_m
    pose = tables.curves.pose(samples.road, samples.s_m, samples.probe_m)
    z_m = tables.elevation.value(samples.road, samples.s_m, samples.probe_m)[place]
    left_x, left_y = -np.sin(pose.heading_rad)[place], np.cos(pose.heading_rad)[place]
    x_m, y_m = pose.x_m[place], pose.y_m[place]
    edges = [
        np.stack([x_m + left_x * t_m, y_m + left_y * t_m, z_m + heights.value(strips.lane, s_m, probe_m)], axis=1)
        for t_m, heights in zip(
            tables.lane_sides(strips.lane, s_m, probe_m), (tables.heights_inner, tables.heights_outer), strict=True
        )
    ]
    return Edges(*edges)
