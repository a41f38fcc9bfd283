"""How Rerun's viewer is laid out: the world at the left, pictures, signals and what happened at the right."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import rerun.blueprint as rrb

from basu.output.viewer.frames import shown

if TYPE_CHECKING:
    from basu.output.viewer.frames import Pose

TIMELINE = "simulated_time"  # s since the run's first tick: the only one, so that one seed gives one recording
BEHIND_M, ABOVE_M = 22.0, 14.0  # where one looks from, at the vehicle
SIGNALS = {
    "speed": "speed and limit [m/s]",
    "control": "throttle, brake, steer",
    "acceleration": "acceleration [m/s2]: forward, right",
}
SCORE = {"score": "scores so far"}


class Parts(NamedTuple):
    """What there is to be shown."""

    start: Pose  # of the vehicle under test
    cameras: bool
    judged: bool  # scores, and what is held against the driver


def layout(parts: Parts) -> Any:  # noqa: ANN401 - a blueprint of Rerun's
    """The blueprint."""
    world = rrb.Spatial3DView(
        origin="world",
        name="world: x east, y north, z up [m]",
        background=rrb.BackgroundKind.GradientDark,
        overrides={"world/driven": _until_now(), "world/infractions": _until_now()},
        eye_controls=_eye(parts.start),
    )
    titles = SIGNALS | SCORE if parts.judged else SIGNALS
    signals = [rrb.TimeSeriesView(origin=f"signals/{name}", name=title) for name, title in titles.items()]
    pictures = [rrb.Spatial2DView(origin="cameras", name="cameras")] if parts.cameras else []
    events = [rrb.TextLogView(origin="events", name="events")] if parts.judged else []
    right = rrb.Vertical(*pictures, *signals, *events)
    return rrb.Blueprint(
        rrb.Horizontal(world, right, column_shares=[3, 2]),
        rrb.TimePanel(timeline=TIMELINE, state="collapsed"),
        collapse_panels=True,
    )


def _until_now() -> rrb.VisibleTimeRanges:
    """What was shown before stays to be seen."""
    return rrb.VisibleTimeRanges(
        timeline=TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )


def _eye(start: Pose) -> rrb.EyeControls3D:
    """Behind the vehicle and above it, going along with it."""
    ahead = np.array([math.cos(start.yaw_rad), math.sin(start.yaw_rad), 0.0])
    at = np.array(start[:3])
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=shown(at - BEHIND_M * ahead + np.array([0.0, 0.0, ABOVE_M])),
        look_target=shown(at),
        tracking_entity="world/ego",
    )
