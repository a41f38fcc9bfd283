"""Episodes that begin along the route: as drives that came there, drawn by the seed, refused with a sentence."""

import math
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

from basu.errors import UserError
from basu.gym_spaces import Reward
from basu.metrics.delays import SLOWEST_MPS
from fakes import route_drivers
from fakes.route_drivers import Seen
from linden.errors import UserError as LindenUserError
from linden.physics.state import BODY
from linden_gym import ID
from linden_gym.environment import WorldsVectorEnv
from linden_gym.starts import LAST_M

START_M = 300.0
CRUISE_MPS = 4.0


def careful(seen: Seen) -> NDArray[np.float32]:
    """Return actions (N, 2) of a careful driver, as the environments take them."""
    return route_drivers.careful(seen, CRUISE_MPS).clip(-1.0, 1.0).astype(np.float32)


def blind(seen: Seen) -> NDArray[np.float32]:
    """Return the actions of that driver if it sees no stop sign."""
    return careful(route_drivers.without_signs(seen))


@pytest.fixture(scope="module")
def envs() -> WorldsVectorEnv:
    return WorldsVectorEnv(2, autoreset_mode="Disabled")


def until_over(envs: WorldsVectorEnv, driver: Callable[[Seen], NDArray[np.float32]], seen: Seen) -> dict[str, Any]:
    """Drive to the end of both episodes, which must be the same; returns the sums of the reward's parts."""
    parts = dict.fromkeys(Reward.__slots__, 0.0)
    for _ in range(6000):
        assert all(np.array_equal(values[0], values[1]) for values in seen.values())
        seen, rewards, terminated, truncated, infos = envs.step(driver(seen))
        assert rewards[0] == pytest.approx(rewards[1], abs=1e-9)
        assert infos["route_s_m"][0] == infos["route_s_m"][1]
        assert infos["infractions"][0] == infos["infractions"][1]
        parts = {name: total + float(infos["reward_parts"][name][1]) for name, total in parts.items()}
        over = terminated | truncated
        assert over[0] == over[1]
        if over[0]:
            assert infos["outcome"][0] == infos["outcome"][1]
            return parts | {"outcome": infos["outcome"][0]}
    raise AssertionError("the episodes did not end")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("driver", "infractions", "outcome"),
    [pytest.param(careful, 0, "Completed", id="careful"), pytest.param(blind, 2, "Completed", id="runs signs")],
)
def test_a_world_that_begins_on_the_way_goes_on_as_one_that_drove_there(
    envs: WorldsVectorEnv, driver: Callable[[Seen], NDArray[np.float32]], infractions: int, outcome: str
) -> None:
    seen, infos = envs.reset(options={"start_m": 0.0})
    assert infos["route_s_m"].tolist() == pytest.approx([0.0, 0.0], abs=0.5)
    steps = 0
    while infos["route_s_m"][0] < START_M - 8.0 or steps % 10:  # infractions are reported in every tenth step
        seen, _, _, _, infos = envs.step(careful(seen))
        steps += 1
    began_m = float(infos["route_s_m"][0])
    seen, infos = envs.reset(options={"reset_mask": np.array([False, True]), "start_m": began_m})
    assert abs(float(infos["route_s_m"][1]) - began_m) < 0.6
    envs.worlds.set_state(envs.worlds.state[1:, 0].copy(), 0, [0])  # the same body: what differs is how it came there
    envs._limits_kmh[0] = envs._limits_kmh[1]
    envs.step(np.array([[-1.0, 0.0], [-1.0, 0.0]], np.float32))
    for _ in range(9):
        seen, *_ = envs.step(np.array([[-1.0, 0.0], [-1.0, 0.0]], np.float32))
    assert seen["stop_sign"][1, 0] == 1.0  # the sign ahead is shown to both
    found = until_over(envs, driver, seen)
    assert found["outcome"] == outcome
    assert found["infraction"] == infractions * Reward().infraction
    rest_m = envs.route.length_m - began_m
    assert rest_m - 3.0 < found["progress"] / Reward().progress <= rest_m


def test_signs_behind_the_beginning_count_as_obeyed_and_time_as_used(envs: WorldsVectorEnv) -> None:
    sign_m = float(envs._ahead.signs_m[0])
    seen, _ = envs.reset(options={"start_m": np.array([sign_m - 8.0, sign_m + 1.0])})
    assert seen["stop_sign"][:, 0].tolist() == [1.0, 0.0]
    assert envs._drives.stopped[:, 0].tolist() == [False, True]
    limit_s = envs._drives.table["limit_s"]
    between_m = float(envs._drives.table["s_m"][1] - envs._drives.table["s_m"][0])
    assert limit_s[0] - limit_s[1] == pytest.approx(between_m / SLOWEST_MPS, abs=0.1)


def test_a_start_at_the_beginning_is_the_usual_one() -> None:
    usual, anywhere = WorldsVectorEnv(2), WorldsVectorEnv(2, start_m=(0.0, math.inf))
    first, infos = usual.reset(seed=4)
    again, _ = anywhere.reset(seed=4, options={"start_m": 0.0})
    assert infos["route_s_m"].max() < 0.5
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert usual.worlds.state.tobytes() == anywhere.worlds.state.tobytes()


def test_random_beginnings_are_those_of_the_seed() -> None:
    envs = WorldsVectorEnv(40, start_m=(100.0, 400.0))
    places_m = [envs.reset(seed=seed)[1]["route_s_m"].copy() for seed in (3, 3, 4)]
    assert np.array_equal(places_m[0], places_m[1])
    assert not np.array_equal(places_m[0], places_m[2])
    assert 99.0 < places_m[0].min() < 150.0
    assert 350.0 < places_m[0].max() < 401.0
    seen, _ = envs.reset(seed=3)
    assert np.abs(seen["ego"][:, [0, 3]]).max() < 0.05  # at rest, on the route
    assert np.abs(seen["ego"][:, 4]).max() < 0.2


def test_episodes_that_begin_by_themselves_draw_their_places() -> None:
    envs = WorldsVectorEnv(2, start_m=(100.0, 400.0))
    _, infos = envs.reset(seed=1)
    before_m = infos["route_s_m"].copy()
    for _ in range(400):
        _, _, terminated, _, _ = envs.step(np.array([[0.6, -0.3], [0.0, 0.0]], np.float32))
        if terminated[0]:
            break
    _, _, _, _, infos = envs.step(np.zeros((2, 2), np.float32))
    assert 99.0 < infos["route_s_m"][0] < 401.0
    assert abs(infos["route_s_m"][0] - before_m[0]) > 1.0


def test_less_is_gained_from_further_on(envs: WorldsVectorEnv) -> None:
    last_m = envs.route.length_m - LAST_M
    seen, _ = envs.reset(options={"start_m": last_m})
    total, over = 0.0, False
    while not over:
        seen, rewards, terminated, _, infos = envs.step(careful(seen))
        total, over = total + float(rewards[0]), bool(terminated[0])
    assert infos["outcome"][0] == "Completed"
    assert Reward().arrival < total < Reward().arrival + Reward().progress * LAST_M


@pytest.mark.parametrize(
    ("start_m", "sentence"),
    [
        pytest.param(-1.0, "cannot begin at -1 m", id="before"),
        pytest.param((0.0, 2000.0), "cannot begin at 2000 m of the route; choose a place from 0 to 749.6 m", id="far"),
        pytest.param(math.nan, "cannot begin at nan m", id="nan"),
        pytest.param((400.0, 100.0), "begins at 400 m and ends before that, at 100 m", id="order"),
        pytest.param("random", "start_m is a place along the route in m, or two, not 'random'", id="word"),
        pytest.param((1.0, 2.0, 3.0), "start_m is a place along the route in m, or two", id="three"),
    ],
)
def test_beginnings_that_cannot_be_are_a_sentence(start_m: Any, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        WorldsVectorEnv(1, start_m=start_m)


@pytest.mark.parametrize("start_m", [np.zeros(3), "here", math.inf, np.array([0.0, math.nan])])
def test_a_wrong_option_changes_no_world(envs: WorldsVectorEnv, start_m: Any) -> None:
    envs.reset()
    before = envs.worlds.state.tobytes()
    with pytest.raises(UserError, match=r"start_m needs an array|cannot begin at"):
        envs.reset(options={"start_m": start_m})
    assert envs.worlds.state.tobytes() == before


@pytest.mark.parametrize(
    ("states", "sentence"),
    [
        pytest.param(np.zeros(2), r"an array \(2,\) of BODY", id="dtype"),
        pytest.param(np.zeros(3, BODY), r"an array \(2,\) of BODY", id="shape"),
        pytest.param(np.zeros(2, BODY), "of another kind of body", id="kind"),
    ],
)
def test_states_that_cannot_be_set_are_a_sentence(envs: WorldsVectorEnv, states: Any, sentence: str) -> None:
    before = envs.worlds.state.tobytes()
    with pytest.raises(LindenUserError, match=sentence):
        envs.worlds.set_state(states)
    lost = envs.worlds.state[:, 0].copy()
    lost["position"][1] = math.nan
    with pytest.raises(LindenUserError, match="not a finite place"):
        envs.worlds.set_state(lost)
    assert envs.worlds.state.tobytes() == before


def test_one_environment_through_the_client_refuses_other_beginnings() -> None:
    with pytest.raises(UserError, match=r"start_m needs gymnasium\.make_vec"):
        gymnasium.make(ID, start_m=100.0)
