"""Claims about boxes: when they touch, held against a grid of points and against small steps of time."""

import numpy as np
import pytest

from basu.metrics.boxes import distance_m, own_boxes, time_to_touch_s, touching
from fakes.rides import eastward, ride


def box(x_m: float, y_m: float, yaw_rad: float = 0.0, half: tuple[float, float] = (2.0, 1.0)) -> np.ndarray:
    return np.array([[x_m, y_m, yaw_rad, *half]])


def points_of(one: np.ndarray) -> np.ndarray:
    """A grid over a box."""
    x, y, yaw, length, width = one
    along, aside = np.meshgrid(np.linspace(-length, length, 21), np.linspace(-width, width, 21))
    return np.column_stack(
        [
            x + along.ravel() * np.cos(yaw) - aside.ravel() * np.sin(yaw),
            y + along.ravel() * np.sin(yaw) + aside.ravel() * np.cos(yaw),
        ]
    )


def test_boxes_touch_where_a_point_of_one_lies_in_the_other() -> None:
    dice = np.random.default_rng(5)
    a = np.column_stack([dice.uniform(-4, 4, (300, 2)), dice.uniform(-3, 3, 300), dice.uniform(0.3, 2.5, (300, 2))])
    b = np.column_stack([dice.uniform(-4, 4, (300, 2)), dice.uniform(-3, 3, 300), dice.uniform(0.3, 2.5, (300, 2))])
    said = touching(a, b)
    for one, other, touch in zip(a, b, said, strict=True):
        nearest_m = min(distance_m(points_of(one), other).min(), distance_m(points_of(other), one).min())
        assert touch == (nearest_m == 0.0) or nearest_m < 0.15  # a grid misses a corner that grazes


def test_head_on_the_time_is_the_gap_over_both_speeds() -> None:
    assert time_to_touch_s(box(0, 0), box(14, 0), np.array([[-10.0, 0.0]])) == pytest.approx([1.0])


def test_an_actor_that_passes_beside_or_goes_away_never_touches() -> None:
    speeds = np.array([[-10.0, 0.0], [10.0, 0.0], [0.0, 0.0]])
    a, b = np.repeat(box(0, 0), 3, axis=0), np.vstack([box(14, 2.1), box(14, 0), box(14, 0)])
    assert time_to_touch_s(a, b, speeds).tolist() == [np.inf] * 3


def test_an_actor_that_touches_already_touches_now() -> None:
    assert time_to_touch_s(box(0, 0), box(3, 0), np.array([[5.0, 0.0]])).tolist() == [0.0]


def test_the_time_is_that_of_small_steps() -> None:
    dice = np.random.default_rng(6)
    a = np.column_stack([np.zeros((100, 2)), dice.uniform(-3, 3, 100), dice.uniform(0.5, 2.5, (100, 2))])
    b = np.column_stack([dice.uniform(-9, 9, (100, 2)), dice.uniform(-3, 3, 100), dice.uniform(0.5, 2.5, (100, 2))])
    speed = -b[:, :2] / 2.0 + dice.uniform(-1, 1, (100, 2))
    said = time_to_touch_s(a, b, speed)
    stepped = np.full(100, np.inf)
    for at_s in np.arange(0.0, 6.0, 0.01):
        moved = b.copy()
        moved[:, :2] += speed * at_s
        stepped[np.isinf(stepped) & touching(a, moved)] = at_s
    both = np.isfinite(stepped)
    assert both.sum() > 50
    assert said[both] == pytest.approx(stepped[both], abs=0.011)


def test_the_vehicles_own_box_lies_about_its_middle_not_its_origin() -> None:
    history = ride(0.2, eastward(lambda _: 1.0, 1.0))
    assert own_boxes(history.facts, history.frames)[0].tolist() == [0.0, 0.0, 0.0, 2.0, 1.0]
