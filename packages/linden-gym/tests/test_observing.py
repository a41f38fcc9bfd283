"""Observations from compiled functions: those of `basu` to the last bit, and those of array functions of numpy."""

import math

import numpy as np
import pytest

from basu import gym_view
from basu.gym_spaces import empty_views
from basu.gym_view import OTHERS, EgoRows, Others, Places, RouteColumns, put_view
from linden_gym import observing
from linden_gym.observing import observed

COUNT, NEAR, SIGNS = 300, 12, 5


@pytest.fixture(scope="module")
def given() -> tuple[RouteColumns, EgoRows, Places, Others]:
    dice = np.random.default_rng(8)
    s_m = np.concatenate([[0.0], np.cumsum(dice.uniform(0.2, 3.0, 200))])
    x_m, y_m, yaw_rad = np.cumsum(dice.normal(0.0, 1.0, (3, 201)), axis=1)
    route = RouteColumns(s_m, x_m, y_m, yaw_rad, np.sort(dice.uniform(0.0, s_m[-1], SIGNS)), np.array([2.4, 2.5]))
    ego = EgoRows(*dice.normal(0.0, 12.0, (9, COUNT)))
    at_m = dice.uniform(-5.0, s_m[-1] + 5.0, COUNT)
    at_m[:201:10] = s_m[::10]  # exactly at points of the route
    places = Places(
        at_m, dice.normal(0.0, 2.0, COUNT), dice.uniform(0.0, 20.0, COUNT), dice.random((COUNT, SIGNS)) < 0.3
    )
    rows = dice.normal(0.0, 25.0, (COUNT, NEAR, 6))
    rows[::7, 3] = rows[::7, 2]  # two at the same place: the first of them comes first
    rows[::7, 3, 3] += 1.0
    return route, ego, places, Others(rows, dice.random((COUNT, NEAR)) < 0.8)


def by_arrays(route: RouteColumns, ego: EgoRows, places: Places, others: Others) -> dict[str, np.ndarray]:
    """Return the observations by functions of numpy on whole arrays."""
    cos, sin = np.cos(ego.yaw_rad), np.sin(ego.yaw_rad)

    def in_frame(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.stack([x * cos[:, None] + y * sin[:, None], y * cos[:, None] - x * sin[:, None]], axis=-1)

    def wrapped(angle_rad: np.ndarray) -> np.ndarray:
        return np.remainder(angle_rad + math.pi, math.tau) - math.pi

    at_m = places.s_m[:, None] + 5.0 * np.arange(1, 11)
    x_m, y_m = (np.interp(at_m, route.s_m, column) for column in (route.x_m, route.y_m))
    heading = wrapped(ego.yaw_rad - np.interp(places.s_m, route.s_m, route.yaw_rad))
    forward = ego.acceleration_x_mps2 * cos + ego.acceleration_y_mps2 * sin
    turn = ego.angular_velocity_z_radps
    state = np.stack([ego.speed_mps, forward, turn, places.lateral_m, heading, places.limit_mps], axis=-1)
    at = in_frame(others.rows[..., 0] - ego.x_m[:, None], others.rows[..., 1] - ego.y_m[:, None])
    away_m = np.where(others.is_there, np.sqrt(at[..., 0] ** 2 + at[..., 1] ** 2), np.inf)
    yaw = wrapped(others.rows[..., 3] - ego.yaw_rad[:, None])[..., None]
    table = np.concatenate([np.ones_like(yaw), at, yaw, in_frame(others.rows[..., 4], others.rows[..., 5])], axis=-1)
    table[~others.is_there] = 0.0
    nearest = np.argsort(away_m, axis=1, kind="stable")[:, :OTHERS, None]
    ahead_m = route.signs_m - (places.s_m[:, None] + route.box_m[0])
    due = ~places.stopped & (ahead_m >= -route.box_m[1]) & (ahead_m <= gym_view.FARTHEST_M)
    sign_m = np.where(due, ahead_m, np.inf).min(axis=1)
    there = np.isfinite(sign_m)
    far, fast, pi = gym_view.FARTHEST_M, gym_view.FASTEST_MPS, gym_view.TURN_RAD
    bounds = {
        "ego": [fast, gym_view.HARDEST_MPS2, gym_view.FASTEST_TURN_RADPS, far, pi, fast],
        "route": far,
        "others": [1.0, far, far, pi, fast, fast],
        "stop_sign": [1.0, far],
    }
    found = {
        "ego": state,
        "route": in_frame(x_m - ego.x_m[:, None], y_m - ego.y_m[:, None]),
        "others": np.take_along_axis(table, nearest, axis=1),
        "stop_sign": np.stack([there, np.where(there, sign_m, 0.0)], axis=-1),
    }
    return {name: np.clip(each, -np.array(bounds[name]), bounds[name]) for name, each in found.items()}


def test_compiled_observations_are_those_of_array_functions(
    given: tuple[RouteColumns, EgoRows, Places, Others],
) -> None:
    found, expected = observed(*given, threads=0), by_arrays(*given)
    assert (found["others"][:, -1, 0] == 1.0).any()
    assert 0.2 < found["stop_sign"][:, 0].mean() < 1.0
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, rtol=1e-6, atol=1e-5, err_msg=name)


def test_compiled_observations_are_those_of_basu_to_the_last_bit(
    given: tuple[RouteColumns, EgoRows, Places, Others],
) -> None:
    plain, away_m = empty_views(COUNT), np.empty(OTHERS)
    for k in range(COUNT):
        put_view(k, *given, away_m, plain)
    for name, values in observed(*given, threads=0).items():
        assert values.tobytes() == getattr(plain, name).tobytes()


def test_threads_change_no_bit_of_an_observation(
    given: tuple[RouteColumns, EgoRows, Places, Others], monkeypatch: pytest.MonkeyPatch
) -> None:
    one = observed(*given, threads=1)
    monkeypatch.setattr(observing, "FEWEST", 1)
    for name, values in observed(*given, threads=0).items():
        assert values.tobytes() == one[name].tobytes()


def test_a_vehicle_that_is_lost_in_space_has_nan_and_the_others_have_numbers(
    given: tuple[RouteColumns, EgoRows, Places, Others],
) -> None:
    route, ego, places, others = given
    x_m = ego.x_m.copy()
    x_m[3] = math.nan
    found = observed(route, ego._replace(x_m=x_m), places, others, threads=0)
    assert np.isnan(found["route"][3]).all()
    assert np.isfinite(found["route"][4:]).all()
