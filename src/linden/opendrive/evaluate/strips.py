"""Every lane laid along the sampled places of its section: what the mesh, the look-ups and the drawings are made of."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.opendrive.evaluate.pieces import F64, I64
from linden.opendrive.evaluate.sampling import Samples, sample, sections_before, sections_of
from linden.opendrive.evaluate.tables import Tables
from linden.opendrive.limits import MOST_PLACES, refuse_beyond


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
