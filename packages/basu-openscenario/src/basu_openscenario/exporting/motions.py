"""The motion of an actor in a rehearsal as trajectories with times, one for each part, with few points."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.stage import EGO
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.testing import Rehearsal
    from basu_openscenario.exporting.phases import Guard, Part

CLOSE_M, CLOSE_RAD = 0.005, 0.002
"""A point is left out where its neighbours give place and heading so well."""
TURN_RAD = 0.04
"""A player may turn an entity at the points alone, so that headings of neighbours differ by no more."""
LEAST_POINTS = 2
"""A motion with fewer is none."""
NEAR_REST_M = 0.06
"""A point so near to a rest is left out."""
STILL_M, STILL_RAD = 0.01, 0.005
"""A motion that stays within is none."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A part of an actor's motion.

    Attributes:
        guard: it begins when this comes true, or ``late_s`` after it; None: the beginning of the rehearsal.
        points: (N, 4) s since its beginning, x and y in m, yaw in rad; CARLA's axes. Without points the actor stands.
        put: whether the actor is put at the first point, away from where it was.
        vanishes: whether the actor leaves the world at its end.
    """

    actor: str
    guard: Guard | None
    points: NDArray[np.float64]
    length_s: float
    late_s: float = 0.0
    put: bool = False
    vanishes: bool = False

    @property
    def moves(self) -> bool:
        """Whether the actor moves in it."""
        return len(self.points) > 1


def motions_of(played: Rehearsal, parts: Sequence[Part], actor: str) -> tuple[Motion, ...]:
    """Return the motions of an actor in order; the first begins with the rehearsal."""
    triggered = [int(np.searchsorted(played.times_s, one.guard.at_s - 1e-6)) for one in parts if one.guard]
    guards = sorted((one.guard for one in parts if one.actor == actor and one.guard), key=lambda one: one.at_s)
    puts_s = [one.time_s for one in played.commands if one.what == "put" and one.details[0] == actor]
    cuts: list[tuple[float, Guard | None]] = [(0.0, None), *((one.at_s, one) for one in guards)]
    cuts = sorted([*cuts, *((time_s, None) for time_s in puts_s)], key=lambda cut: cut[0])
    times_s = played.times_s
    trail, marks = at_rest(played.trails[actor])
    is_there = ~np.isnan(trail[:, 0])
    gone_s = float(times_s[is_there][-1]) if not is_there.all() else None
    found: list[Motion] = []
    for (from_s, cut_guard), following in itertools.pairwise([*cuts, (float(times_s[-1]), None)]):
        inside = (times_s >= from_s - 1e-6) & (times_s <= following[0] + 1e-6) & is_there
        if np.count_nonzero(inside) < LEAST_POINTS:
            continue
        first = int(np.flatnonzero(inside)[0])
        points = np.column_stack([times_s[inside] - from_s, trail[inside, :2], np.unwrap(trail[inside, 2])])
        put = cut_guard is None and from_s in puts_s
        if put:
            points[0, 1:] = points[1, 1:]  # the command comes true in the next frame
        elif following[0] in puts_s:
            points[-1, 1:] = points[-2, 1:]
        before = found[-1] if put and found else None
        found.append(
            Motion(
                actor,
                cut_guard if before is None else before.guard,
                thinned(
                    points,
                    [mark - first for mark in marks if inside[mark]],
                    [nth - first for nth in triggered if inside[nth]],
                ),
                length_s=float(points[-1, 0]),
                late_s=0.0 if before is None else before.late_s + before.length_s,
                put=put,
                vanishes=gone_s is not None and from_s <= gone_s <= following[0] and actor != EGO,
            )
        )
    return tuple(found)


def at_rest(trail: NDArray[np.float64]) -> tuple[NDArray[np.float64], list[int]]:
    """Return a trail in which an actor that rests keeps its place, and the first and last frames of its rests.

    ``StandsStill`` counts speeds below ``AT_REST_MPS`` as rest; players count the speed 0 alone.

    Args:
        trail: (N, 4) x and y in m, yaw in rad, speed in m/s.
    """
    trail, marks = trail.copy(), []
    rests = np.concatenate([[False], trail[:, 3] < AT_REST_MPS, [False]])
    changes = np.flatnonzero(rests[1:] != rests[:-1])
    for first, end in zip(changes[::2], changes[1::2], strict=True):
        trail[first:end, :3] = trail[first, :3]  # its end would be reached by a jump, faster than the motion before
        marks += [int(first), int(end) - 1]
    return trail, marks


def thinned(points: NDArray[np.float64], rests: Sequence[int] = (), moments: Sequence[int] = ()) -> NDArray[np.float64]:
    """Return the points between which the others are linear in time, as closely as ``CLOSE_M`` and ``CLOSE_RAD`` say.

    A motion that stays where it is has no points but its first. See Douglas and Peucker 1973, with time as the axis.
    Points near a rest are left out, since esmini merges points within 5 cm and would let it begin or end at others. A
    moment shortly before a rest is kept. Without it the way into the rest has one speed. A trigger that waits for
    a low speed then comes late. esmini then lets the rest begin at that moment.

    Args:
        points: (N, 4) s, x and y in m, yaw in rad.
        rests: the first and last points of rests, which are kept.
        moments: further points that are kept, so that speeds before and after them are not mixed.
    """
    off = np.abs(points - points[0])
    if float(off[:, 1:3].max()) < STILL_M and float(off[:, 3].max()) < STILL_RAD:
        return points[:1]
    kept = {0, len(points) - 1, *rests, *moments}
    left = list(itertools.pairwise(sorted(kept)))
    while left:
        first, last = left.pop()
        inner = points[first + 1 : last]
        if not len(inner):
            continue
        share = (inner[:, :1] - points[first, 0]) / (points[last, 0] - points[first, 0])
        off = np.abs(inner[:, 1:] - points[first, 1:] - share * (points[last, 1:] - points[first, 1:]))
        excess = np.maximum(np.hypot(off[:, 0], off[:, 1]) / CLOSE_M, off[:, 2] / CLOSE_RAD)
        worst = int(np.argmax(excess))
        turns = abs(points[last, 3] - points[first, 3]) > TURN_RAD
        if turns and excess[worst] <= 1.0:
            worst = len(inner) // 2
        if turns or excess[worst] > 1.0:
            middle = first + 1 + worst
            kept.add(middle)
            left += [(first, middle), (middle, last)]
    near = {nth for nth in kept - {0, len(points) - 1, *rests} if _is_near_rest(points, nth, rests)}
    near -= {nth for nth in moments if not _is_near_rest(points, nth, [mark for mark in rests if mark < nth])}
    return points[sorted(kept.difference(near))]


def _is_near_rest(points: NDArray[np.float64], nth: int, rests: Sequence[int]) -> bool:
    """Return whether a point is so near to the place of a rest that esmini would merge them."""
    places = points[list(rests), 1:3]
    return len(places) > 0 and float(np.hypot(*(places - points[nth, 1:3]).T).min()) < NEAR_REST_M
