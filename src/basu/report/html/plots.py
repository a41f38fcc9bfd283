"""The charts of a report on one axis of time: speed and limit, acceleration, jerk, distance to the lane's middle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from basu.metrics.speeding import TOLERANCE_MPS
from basu.report.markup import e
from basu.report.plots import marks
from basu.report.plots.chart import Line, Mark, Shade, chart
from basu.report.plots.signals import stretches

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.history import History
    from basu.report.plots.signals import Signals

# what standing volunteers could recover from (docs/passengers.md has the sources), both ways
RECOVERABLE_MPS2 = ((1.0, "1.0"), (-1.0, ""), (2.5, "2.5"), (-2.5, ""))


def charts(history: History, felt: Signals, infractions: Sequence[dict[str, Any]]) -> Element:
    """All charts of a run."""
    by_hand = [Shade(begin_s, end_s, "manual") for begin_s, end_s in stretches(felt.manual, felt.t_s)]
    return e(
        "section",
        e("h2", "Plots"),
        _speed(felt, by_hand, infractions),
        chart(
            felt.t_s,
            [
                Line("along, + forward", felt.along_mps2, "first"),
                Line("across, + to the right", felt.across_mps2, "second"),
            ],
            title="Acceleration",
            unit="m/s²",
            id_="acceleration",
            levels=RECOVERABLE_MPS2,
            shades=by_hand,
            least_range=(-1.2, 1.2),
        ),
        chart(
            felt.t_s,
            [Line("along", felt.jerk_mps3, "first")],
            title="Jerk",
            unit="m/s³",
            id_="jerk",
            shades=by_hand,
            least_range=(-1.2, 1.2),
        ),
        _offset(history, felt, by_hand),
        e(
            "p",
            "Acceleration and jerk are means over 0.5 s. Hatched: driven by hand; cross-hatched: above the limit.",
            class_="note",
        ),
    )


def _speed(felt: Signals, by_hand: Sequence[Shade], infractions: Sequence[dict[str, Any]]) -> Element:
    """Speed against the posted limit, with the infractions where they happened."""
    over = felt.speed_mps > np.where(np.isnan(felt.limit_mps), np.inf, felt.limit_mps + TOLERANCE_MPS)
    shades = [*by_hand, *(Shade(begin_s, end_s, "over") for begin_s, end_s in stretches(over, felt.t_s))]
    flags = [
        Mark(infraction["t_s"], str(index), marks.title(index, infraction), f"#{marks.anchor(index)}")
        for index, infraction in enumerate(infractions, start=1)
    ]
    curves = [Line("driven", felt.speed_mps, "first"), Line("limit", felt.limit_mps, "limit", steps=True)]
    return chart(felt.t_s, curves, title="Speed", unit="m/s", id_="speed", shades=shades, marks=flags)


def _offset(history: History, felt: Signals, by_hand: Sequence[Shade]) -> Element:
    """Distance to the lane's middle, figure 5.1 of the thesis; to the planned line where the record has no lanes."""
    if np.isfinite(felt.offset_m).any():
        title, values = "Distance to the lane's middle", felt.offset_m
    else:
        title, values = "Distance to the planned line", history.frames["lateral_m"].astype(np.float64)
    curves = [Line("+ to the right", values, "first")]
    return chart(felt.t_s, curves, title=title, unit="m", id_="offset", shades=by_hand, least_range=(-0.5, 0.5))
