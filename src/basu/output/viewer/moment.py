"""One tick as it is shown: where everybody is, what is driven, what has happened."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import rerun as rr

from basu.output.viewer.frames import Pose, about_the_vertical, shown, turned
from basu.output.viewer.layout import TIMELINE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from basu.metrics.infraction import Evidence
    from basu.metrics.score import Scores

DRIVEN_COLOUR, WALKER_COLOUR, OTHER_COLOUR, INFRACTION_COLOUR = (
    (250, 200, 60),
    (240, 90, 160),
    (90, 190, 230),
    (230, 40, 40),
)
OTHER_HEIGHT_M = 1.6  # of the boxes that are drawn: records hold lengths and widths
DRIVEN_ABOVE_M = 0.3  # the driven path, so that it lies over the planned one
HALF_SIZE_M = (2.3, 0.95)  # of who has none in the record


class Driving(NamedTuple):
    """What is driven in a tick: world, CARLA's axes; nan where it is not known."""

    velocity_mps: tuple[float, float, float]
    acceleration_mps2: tuple[float, float, float]
    limit_mps: float
    throttle: float
    steer: float
    brake: float


class Other(NamedTuple):
    """Somebody near; CARLA's frame."""

    id: int
    type_id: str
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    half_size_m: tuple[float, float] | None  # half length and half width


class Shower:
    """Shows ticks one after the other."""

    def __init__(self, recording: Any) -> None:  # noqa: ANN401 - rerun.RecordingStream
        self.recording = recording
        self._last: NDArray[np.float64] | None = None
        self._told: set[tuple[str, int, str | None]] = set()

    def tick(self, t_s: float, ego: Pose, driving: Driving, others: Sequence[Other]) -> None:
        """Show where everybody is and what is driven; what is shown later belongs to this time too."""
        self.recording.set_time(TIMELINE, duration=t_s)
        self._pose(ego)
        self._signals(ego, driving)
        self._others(others)

    def scores(self, scores: Scores) -> None:
        """Show the scores so far."""
        for name in ("driving", "infraction", "path_following"):
            self.recording.log(f"signals/score/{name}", rr.Scalars([getattr(scores, name)]))

    def infractions(self, found: Sequence[Evidence]) -> None:
        """Show what has not been shown yet of what is held against the driver, at the time it happened."""
        for one in found:
            key = (one.kind.value, one.tick, one.other)
            if key in self._told:
                continue
            self._told.add(key)
            self.recording.set_time(TIMELINE, duration=one.t_s)
            text = f"{one.kind.value}: {one.detail}"
            self.recording.log("events", rr.TextLog(text, level="WARN"))
            place = shown((one.x_m, one.y_m, one.z_m + 3.0))
            self.recording.log(
                "world/infractions",
                rr.Points3D([place], labels=[one.kind.value], colors=[INFRACTION_COLOUR], radii=[0.8]),
            )

    def _pose(self, ego: Pose) -> None:
        self.recording.log("world/ego", rr.Transform3D(translation=shown(ego[:3]), mat3x3=turned(ego)))
        here = shown((ego.x_m, ego.y_m, ego.z_m + DRIVEN_ABOVE_M))
        if self._last is not None:
            self.recording.log(
                "world/driven", rr.LineStrips3D([[self._last, here]], colors=[DRIVEN_COLOUR], radii=[0.12])
            )
        self._last = here

    def _signals(self, ego: Pose, driving: Driving) -> None:
        cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
        east, south, _ = driving.acceleration_mps2
        values: Mapping[str, float] = {
            "speed/driven": math.hypot(*driving.velocity_mps),
            "speed/limit": driving.limit_mps if driving.limit_mps > 0.0 else math.nan,
            "control/throttle": driving.throttle,
            "control/brake": driving.brake,
            "control/steer": driving.steer,
            "acceleration/forward": cos * east + sin * south,
            "acceleration/right": cos * south - sin * east,
        }
        for name, value in values.items():
            if not math.isnan(value):
                self.recording.log(f"signals/{name}", rr.Scalars([value]))

    def _others(self, others: Sequence[Other]) -> None:
        half_height_m = OTHER_HEIGHT_M / 2.0
        sizes = [(*(other.half_size_m or HALF_SIZE_M), half_height_m) for other in others]
        centres = np.array([(other.x_m, other.y_m, other.z_m + half_height_m) for other in others]).reshape(-1, 3)
        self.recording.log(
            "world/others",
            rr.Boxes3D(
                half_sizes=np.array(sizes).reshape(-1, 3),
                centers=shown(centres),
                quaternions=about_the_vertical(np.array([other.yaw_rad for other in others])),
                labels=[f"{other.type_id} {other.id}" for other in others],
                show_labels=False,
                colors=[WALKER_COLOUR if other.type_id.startswith("walker.") else OTHER_COLOUR for other in others],
            ),
        )
