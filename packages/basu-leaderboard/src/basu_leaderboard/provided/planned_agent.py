"""The plan of foreign agents: road options, thinning of a plan, and the base class that both hosts' agents share."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Any, ClassVar

import carla

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class RoadOption(enum.IntEnum):
    """A command of high level, as CARLA's planner numbers them."""

    VOID = -1
    LEFT = 1
    RIGHT = 2
    STRAIGHT = 3
    LANEFOLLOW = 4
    CHANGELANELEFT = 5
    CHANGELANERIGHT = 6


LANE_CHANGES = (RoadOption.CHANGELANELEFT, RoadOption.CHANGELANERIGHT)


def downsample_route(route: Sequence[tuple[carla.Transform, Any]], sample_factor: float) -> list[int]:
    """The indices of the points that are kept: both ends, where the option changes, and one every ``sample_factor`` m.

    Distances run from the last point that was kept, and a point is due once they have exceeded the factor; all points
    of a lane change are kept, and the one behind it is not taken for a change of option.
    """
    kept: list[int] = []
    since_m = 0.0
    for index, (pose, option) in enumerate(route):
        if index == 0:
            kept.append(index)
            continue
        before, option_before = route[index - 1]
        has_changed = option != option_before and option_before not in LANE_CHANGES
        if option in LANE_CHANGES or has_changed or since_m > sample_factor or index == len(route) - 1:
            kept.append(index)
            since_m = 0.0
        else:
            since_m += pose.location.distance(before.location)
    return kept


class PlannedAgent:
    """An agent that receives a plan, names its sensors, then steps.

    The thinned plan lies in ``_global_plan`` (dicts of lat, lon in degrees and z in m) and ``_global_plan_world_coord``
    (transforms), each entry with its ``RoadOption``; agents read these names.
    """

    PLAN_SPACING_M: ClassVar[float]  # of the plan that an agent is left with, where the option stays the same

    _global_plan: list[tuple[Mapping[str, float], Any]] | None = None
    _global_plan_world_coord: list[tuple[carla.Transform, Any]] | None = None

    def setup(self, path_to_conf_file: str) -> None:
        """Get ready; the file is that of ``--agent-config``, the empty text where there is none."""

    def sensors(self) -> Sequence[Mapping[str, Any]]:
        """Say which sensors are wanted: none."""
        return []

    def run_step(self, input_data: Mapping[str, tuple[int, Any]], timestamp: float) -> carla.VehicleControl:
        """Answer a step: neither throttle nor brake."""
        del input_data, timestamp
        return carla.VehicleControl()

    def destroy(self) -> None:
        """Put away what ``setup`` took."""

    def set_global_plan(
        self,
        global_plan_gps: Sequence[tuple[Mapping[str, float], Any]],
        global_plan_world_coord: Sequence[tuple[carla.Transform, Any]],
    ) -> None:
        """Keep the plan, thinned."""
        kept = downsample_route(global_plan_world_coord, self.PLAN_SPACING_M)
        self._global_plan_world_coord = [global_plan_world_coord[index] for index in kept]
        self._global_plan = [global_plan_gps[index] for index in kept]
