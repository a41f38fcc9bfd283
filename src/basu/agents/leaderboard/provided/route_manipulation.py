"""Thinning a plan as the leaderboard does before it hands it to an agent."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.leaderboard.provided.road_option import RoadOption

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    import carla

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
