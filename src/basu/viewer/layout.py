"""How Rerun's viewer is laid out: the world at the left, cameras, signals and what happened at the right."""

from __future__ import annotations

from typing import Any

import rerun.blueprint as rrb

from basu.viewer.stream import TIMELINE

ALL_BEFORE = (rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative())


def layout() -> Any:  # noqa: ANN401 - a blueprint of Rerun's
    """The blueprint."""
    until_now = rrb.VisibleTimeRanges(timeline=TIMELINE, start=ALL_BEFORE[0], end=ALL_BEFORE[1])
    world = rrb.Spatial3DView(
        origin="world",
        name="world",
        overrides={"world/driven": until_now, "world/infractions": until_now},
        eye_controls=rrb.EyeControls3D(tracking_entity="world/ego", kind=rrb.Eye3DKind.Orbital),
    )
    signals = [
        rrb.TimeSeriesView(origin=f"signals/{name}", name=title)
        for name, title in (
            ("speed", "speed and limit [m/s]"),
            ("control", "throttle, brake, steer"),
            ("acceleration", "acceleration [m/s2]: forward, right"),
            ("score", "score so far"),
        )
    ]
    seen = rrb.Tabs(
        rrb.Spatial2DView(origin="cameras", name="cameras"), rrb.TextLogView(origin="events", name="events")
    )
    return rrb.Blueprint(
        rrb.Horizontal(world, rrb.Vertical(seen, *signals), column_shares=[3, 2]),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed"),
        collapse_panels=True,
    )
