"""The layout of Rerun's viewer, and poses in its right-handed frame.

Shown is x east, y north, z up. A rotation R becomes S R S with S = diag(1, -1, 1): what turns clockwise as seen from
above, as CARLA's yaw does, turns clockwise on the screen too.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import rerun.blueprint as rrb

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


MIRROR = np.array([1.0, -1.0, 1.0])


class Pose(NamedTuple):
    """An actor's place and attitude: CARLA's frame, m and rad."""

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float


def shown(points_m: ArrayLike) -> NDArray[np.float64]:
    """Points (..., 3) of CARLA's frame, or of a vehicle's or sensor's own, as they are drawn."""
    mirrored: NDArray[np.float64] = np.asarray(points_m, dtype=np.float64) * MIRROR
    return mirrored


def turned(pose: Pose) -> NDArray[np.float64]:
    """(3, 3) the rotation from an actor's own frame into the world, as it is drawn.

    The matrix before it is mirrored: LibCarla, ``carla/geom/Transform.h``, ``GetMatrix``.
    """
    (sr, cr), (sp, cp), (sy, cy) = (
        (math.sin(angle), math.cos(angle)) for angle in (pose.roll_rad, pose.pitch_rad, pose.yaw_rad)
    )
    world_from_own = np.array(
        [
            [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr],
            [cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr],
            [sp, -cp * sr, cp * cr],
        ]
    )
    mirrored: NDArray[np.float64] = world_from_own * np.outer(MIRROR, MIRROR)
    return mirrored


def about_the_vertical(yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4) quaternions (x, y, z, w) of yaws, as they are drawn."""
    half = -np.asarray(yaw_rad, dtype=np.float64) / 2.0
    zero = np.zeros_like(half)
    return np.column_stack([zero, zero, np.sin(half), np.cos(half)])


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
    """Return the arrangement of the viewer's windows."""
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
    """Return the range of time until now, so that what was shown before stays visible."""
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
