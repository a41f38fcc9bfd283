"""Claims about the view from above."""

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from basu_window.hud.top_down import View, lanes_of


def lane(yaws_deg: Sequence[float], lane_id: int = -1, *, junction: bool = False) -> list[Any]:
    """Samples of a lane, 2 m apart, beginning at the origin."""
    x_m = y_m = 0.0
    found = []
    for number, yaw_deg in enumerate(yaws_deg):
        place = SimpleNamespace(location=SimpleNamespace(x=x_m, y=y_m), rotation=SimpleNamespace(yaw=yaw_deg))
        found.append(
            SimpleNamespace(
                road_id=int(junction), section_id=0, lane_id=lane_id, s=2.0 * number, transform=place, lane_width=3.0,
                is_junction=junction,
            )
        )  # fmt: skip
        x_m += 2.0 * math.cos(math.radians(yaw_deg))
        y_m += 2.0 * math.sin(math.radians(yaw_deg))
    return found


def mapped(*lanes: list[Any]) -> Any:
    """A map of these lanes."""
    return SimpleNamespace(generate_waypoints=lambda _: [waypoint for samples in lanes for waypoint in samples])


def test_the_vehicles_way_is_up_and_its_right_is_right() -> None:
    view = View(x_m=100.0, y_m=50.0, yaw_rad=math.pi / 2, scale=2.0, centre=(400.0, 300.0))  # driving south
    ahead, right = view.pixels(np.array([[100.0, 60.0], [90.0, 50.0]]))
    assert ahead == pytest.approx((400.0, 280.0))
    assert right == pytest.approx((420.0, 300.0))


def test_a_straight_lane_needs_its_corners_alone() -> None:
    (outline,) = lanes_of(mapped(lane([0.0] * 10))).outlines_m
    assert outline.tolist() == [[0.0, -1.5], [20.0, -1.5], [20.0, 1.5], [0.0, 1.5]]


def test_a_bend_keeps_its_points_and_a_long_lane_comes_in_pieces() -> None:
    lanes = lanes_of(mapped(lane([3.0 * n for n in range(30)])))
    assert len(lanes.outlines_m) == 2
    assert len(lanes.outlines_m[0]) == 2 * 21
    assert all(
        np.hypot(*(outline - middle).T).max() <= reach
        for outline, middle, reach in zip(lanes.outlines_m, lanes.middles_m, lanes.reaches_m, strict=True)
    )


def test_roads_lie_over_junctions() -> None:
    lanes = lanes_of(mapped(lane([0.0] * 3), lane([90.0] * 3, junction=True)))
    assert lanes.outlines_m[0][1] == pytest.approx((1.5, 6.0))
