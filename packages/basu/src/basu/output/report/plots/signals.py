"""Signals over time and their charts: speed and limit, acceleration, jerk, distance to the lane's middle."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers import felt
from basu.metrics.passengers.felt import GRIP_MPS2, STEP_MPS2
from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.speeding import limits_mps
from basu.output.report.plots.chart import Curve, Flag, Shade, chart
from basu.output.report.templates import e

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray

    from basu.output.report.events import MarkedEvent
    from basu.records.history import History


class Signals(NamedTuple):
    """All (T,), one value a tick."""

    t_s: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    limit_mps: NDArray[np.float64]  # nan where none is posted
    along_mps2: NDArray[np.float64]  # acceleration, + forward
    across_mps2: NDArray[np.float64]  # + to the right
    jerk_mps3: NDArray[np.float64]  # of the acceleration along
    offset_m: NDArray[np.float64]  # off the lane's middle, + to the right; nan where there is no lane
    manual: NDArray[np.bool_]  # a person drives


def signals(history: History) -> Signals:
    """Return the signals of a record; accelerations and jerk are those at a standing passenger's place, filtered."""
    frames = history.frames
    sensed = felt(history)
    unknown = np.full(len(frames), np.nan)  # a record too short to feel anything
    limit_mps = limits_mps(history)
    return Signals(
        t_s=frames["t_s"].astype(np.float64),
        speed_mps=history.speed_mps(),
        limit_mps=np.where(np.isfinite(limit_mps), limit_mps, np.nan),
        along_mps2=unknown if sensed is None else sensed.filtered_along_mps2,
        across_mps2=unknown if sensed is None else sensed.filtered_across_mps2,
        jerk_mps3=unknown if sensed is None else sensed.jerk_along_mps3,
        offset_m=frames["lane_offset_m"].astype(np.float64),
        manual=frames["manual"].astype(np.bool_),
    )


def stretches(holds: NDArray[np.bool_], t_s: NDArray[np.float64]) -> list[tuple[float, float]]:
    """From when to when ``holds`` (T,) holds: (first, last) in s of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8))).reshape(-1, 2)
    return [(float(t_s[first]), float(t_s[end - 1])) for first, end in edges.tolist()]


# what standing volunteers could recover from (docs/reference/passengers.md has the sources), both ways
RECOVERABLE = (
    (STEP_MPS2, f"{STEP_MPS2:g}: with a step"),
    (-STEP_MPS2, ""),
    (GRIP_MPS2, f"{GRIP_MPS2:g}: holding on"),
    (-GRIP_MPS2, ""),
)
FELT_KINDS = {"harsh_stop", "phantom_stop", "near_miss"}


def charts(history: History, felt: Signals, found: Sequence[MarkedEvent]) -> Element:
    """Return all charts of a run."""
    by_hand = [Shade(begin_s, end_s, "manual") for begin_s, end_s in stretches(felt.manual, felt.t_s)]
    return e(
        "div",
        _speed(felt, by_hand, _flags(f for f in found if f.factor is not None)),
        chart(
            felt.t_s,
            [
                Curve("along, + forward", felt.along_mps2, "first"),
                Curve("across, + to the right", felt.across_mps2, "second"),
            ],
            title="Acceleration",
            marks=_flags(f for f in found if f.kind in FELT_KINDS),
            unit="m/s²",
            id_="acceleration",
            levels=RECOVERABLE,
            shades=by_hand,
            least_range=(-1.2, 1.2),
        ),
        chart(
            felt.t_s,
            [Curve("along", felt.jerk_mps3, "first")],
            title="Jerk",
            unit="m/s³",
            id_="jerk",
            shades=by_hand,
            least_range=(-1.2, 1.2),
        ),
        _offset(history, felt, by_hand),
        e(
            "p",
            "Acceleration and jerk: at a standing passenger's place, filtered. Hatched: by hand; crossed: too fast.",
            class_="note",
        ),
    )


def _speed(felt: Signals, by_hand: Sequence[Shade], flags: Sequence[Flag]) -> Element:
    """Speed against the posted limit, with the infractions where they happened."""
    over = felt.speed_mps > np.where(np.isnan(felt.limit_mps), np.inf, felt.limit_mps + TOLERANCE_MPS)
    shades = [*by_hand, *(Shade(begin_s, end_s, "over") for begin_s, end_s in stretches(over, felt.t_s))]
    curves = [Curve("driven", felt.speed_mps, "first"), Curve("limit", felt.limit_mps, "limit", steps=True)]
    return chart(felt.t_s, curves, title="Speed", unit="m/s", id_="speed", shades=shades, marks=flags)


def _offset(history: History, felt: Signals, by_hand: Sequence[Shade]) -> Element:
    """Distance to the lane's middle, figure 5.1 of the thesis; to the planned line where the record has no lanes."""
    if np.isfinite(felt.offset_m).any():
        title, values = "Distance to the lane's middle", felt.offset_m
    else:
        title, values = "Distance to the planned line", history.frames["lateral_m"].astype(np.float64)
    curves = [Curve("+ to the right", values, "first")]
    return chart(felt.t_s, curves, title=title, unit="m", id_="offset", shades=by_hand, least_range=(-0.5, 0.5))


def _flags(found: Iterable[MarkedEvent]) -> list[Flag]:
    """Flags that open the evidence."""
    return [Flag(f.t_s, f.label, f.title, f"#{f.anchor}", scored=f.factor is not None) for f in found]
