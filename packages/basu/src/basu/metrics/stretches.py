"""Stretches of a drive on which something holds: frames, metres, seconds, and their share of the path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.metrics.display import TimedMark
from basu.metrics.infraction import Evidence, Incident, evidence, row_of
from basu.metrics.json_schema import EVIDENCE, Schema, listing, number, record
from basu.records.structured import StructuredArray

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from basu.records.history import History


SPACING_M = 0.25  # between the points that a driven path is measured with: finer would add up jitter


class Chords(NamedTuple):
    """A driven path as straight pieces, each from the end of the one before."""

    length_m: NDArray[np.float64]  # (K,)
    end: NDArray[np.int64]  # (K,) the frame in which each ends


def stretches(holds: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, end) of every unbroken stretch of frames in which ``holds`` (T,) is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8)))
    return [(first, end) for first, end in edges.reshape(-1, 2).tolist()]


def spans(history: History, holds: NDArray[np.bool_], what: str, style: str) -> list[TimedMark]:
    """Return each stretch in which ``holds`` (T,) is true, for the timeline; ``what`` says what lasted."""
    t_s = history.frames["t_s"]
    found = [(float(t_s[first]), float(t_s[end - 1])) for first, end in stretches(holds)]
    return [TimedMark(b, e, f"{what} from {b:.1f} s to {e:.1f} s", style=style) for b, e in found]


def chords(points_m: NDArray[np.float64]) -> Chords:
    """The path through ``points_m`` (T, 2), skipping points within ``SPACING_M`` of the last one taken.

    Equation 5.2 of the thesis by chords. The last point is always taken, so a path of two points has its full length.
    """
    x_m, y_m = points_m[:, 0].tolist(), points_m[:, 1].tolist()
    lengths: list[float] = []
    ends: list[int] = []
    last, final = 0, len(x_m) - 1
    for at in range(1, len(x_m)):
        chord_m = ((x_m[at] - x_m[last]) ** 2 + (y_m[at] - y_m[last]) ** 2) ** 0.5
        if chord_m >= SPACING_M or (at == final and chord_m > 0.0):
            lengths.append(chord_m)
            ends.append(at)
            last = at
    return Chords(np.array(lengths, dtype=np.float64), np.array(ends, dtype=np.int64))


def path_m(frames: StructuredArray) -> NDArray[np.float64]:
    """(T, 2) where the vehicle's origin was, CARLA frame."""
    return np.column_stack([frames["x_m"], frames["y_m"]]).astype(np.float64)


def total_m(lengths_m: NDArray[np.float64]) -> float:
    """Their sum, added up in order: the same to the last bit on every machine."""
    return float(sum(lengths_m.tolist()))


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """How much of a drive something held."""

    metres: float  # of the driven path, equation 5.2
    share: float  # of the whole driven path, 0..1; 0 for a drive that went nowhere
    seconds: float
    events: tuple[Evidence, ...]  # one a stretch


def share_of(
    history: History,
    holds: NDArray[np.bool_],
    kind: Incident,
    words: Callable[[int, int], str],
    *,
    forgiven_m: float = 0.0,
) -> Share:
    """Measure where ``holds`` (T,); ``words`` says what it was from frame to frame.

    A stretch with a path no longer than ``forgiven_m`` does not count.
    """
    pieces = chords(path_m(history.frames))
    speed_mps = history.speed_mps()
    metres, ticks, events = 0.0, 0, []
    for first, end in stretches(holds):
        within = (pieces.end >= first) & (pieces.end < end)
        length_m = total_m(pieces.length_m[within])
        if length_m <= forgiven_m and forgiven_m > 0.0:
            continue
        metres += length_m
        ticks += end - first
        seconds = (end - first) * history.facts.step_s
        events.append(
            evidence(
                history,
                kind,
                first,
                speed_mps=float(speed_mps[first]),
                other=None,
                detail=f"{words(first, end)} for {length_m:.1f} m and {seconds:.1f} s",
            )
        )
    driven_m = total_m(pieces.length_m)
    return Share(
        metres=metres,
        share=metres / driven_m if driven_m > 0.0 else 0.0,
        seconds=ticks * history.facts.step_s,
        events=tuple(events),
    )


def share_record(about: str, **more: Schema) -> Schema:
    """The schema of :func:`share_row` with what a metric adds."""
    return record(
        null_=True,
        about_=about,
        metres=number("m", low=0),
        share=number(low=0, high=1),
        seconds=number("s", low=0),
        events=listing(EVIDENCE),
        **more,
    )


def share_row(share: Share) -> dict[str, Any]:
    """A share as plain values."""
    return {
        "metres": share.metres,
        "share": share.share,
        "seconds": share.seconds,
        "events": [row_of(event) for event in share.events],
    }


def share_line(title: str, found: dict[str, Any]) -> list[str]:
    """A line of the console's table for a share; none where it is 0."""
    if not found["metres"]:
        return []
    return [f"{title:<18}{found['metres']:.1f} m, {100.0 * found['share']:.1f} % of the way (not scored)"]
