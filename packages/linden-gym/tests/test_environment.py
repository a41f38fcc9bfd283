"""Claims about environments on worlds: they equal the one through the client, reset as gymnasium says, and refuse."""

import math
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from basu.errors import UserError
from basu.gym import ShuttleEnv
from linden_gym import ID
from linden_gym.environment import WorldsVectorEnv

GENTLE = [0.3, 0.0]
OFF_ROAD = [0.6, -0.12]
Driver = Callable[[int, dict[str, NDArray[np.float32]]], NDArray[np.float32]]


@pytest.fixture(scope="module")
def client_env() -> Iterator[ShuttleEnv]:
    made = ShuttleEnv()
    yield made
    made.close()


@pytest.fixture(scope="module")
def envs() -> WorldsVectorEnv:
    made = gymnasium.make_vec(ID, num_envs=3)
    assert isinstance(made, WorldsVectorEnv)
    return made


def towards_route(cruise_mps: float, weave: float = 0.0) -> Driver:
    """A driver by the observation alone, which swings from side to side by ``weave``."""

    def act(step: int, seen: dict[str, NDArray[np.float32]]) -> NDArray[np.float32]:
        x_m, y_m = seen["route"][1]
        steer = 1.2 * math.atan2(y_m, x_m) + weave * math.sin(step / 25.0)
        return np.array([0.4 * (cruise_mps - seen["ego"][0]), steer], np.float32).clip(-1.0, 1.0)

    return act


def stopping(step: int, seen: dict[str, NDArray[np.float32]]) -> NDArray[np.float32]:
    """A driver that stops at stop signs, and goes on once they are no longer shown."""
    is_near, to_line_m = seen["stop_sign"]
    cruise_mps = min(8.0, math.sqrt(max(0.0, 3.0 * (to_line_m - 0.5)))) if is_near else 8.0
    return towards_route(cruise_mps)(step, seen)


def at_random(step: int, _seen: object) -> NDArray[np.float32]:
    """Random pedals and steer, new ones each second."""
    return np.random.default_rng(step // 20).uniform([-0.3, -0.5], [1.0, 0.5]).astype(np.float32)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("driver", "steps", "outcome", "infractions"),
    [
        pytest.param(towards_route(16.0), 2000, "Completed", 1, id="too fast, to the end"),
        pytest.param(towards_route(8.0, 0.35), 3000, "RouteDeviation", 0, id="weaving through lanes"),
        pytest.param(lambda _step, _seen: np.array(OFF_ROAD, np.float32), 400, "RouteDeviation", 0, id="off the road"),
        pytest.param(stopping, 1500, None, 0, id="with a stop"),
        pytest.param(at_random, 400, None, 0, id="at random"),
    ],
)
def test_a_world_equals_the_environment_through_the_client(
    client_env: ShuttleEnv,
    envs: WorldsVectorEnv,
    driver: Driver,
    steps: int,
    outcome: str | None,
    infractions: int,
) -> None:
    one, _ = client_env.reset(seed=0)
    many, _ = envs.reset(seed=0)
    found, ended = 0, None
    for step in range(steps):
        assert all(np.array_equal(one[name], many[name][1]) for name in one)
        action = driver(step, one)
        one, reward, terminated, truncated, info = client_env.step(action)
        many, rewards, over, cut, infos = envs.step(np.array([GENTLE, action, GENTLE], np.float32))
        assert rewards[1] == pytest.approx(reward, abs=1e-9)
        assert infos["route_s_m"][1] == pytest.approx(info["route_s_m"], abs=1e-9)
        assert infos["infractions"][1] == len(info["infractions"])
        assert (over[1], cut[1]) == (terminated, truncated)
        found += len(info["infractions"])
        if terminated or truncated:
            ended = info["outcome"]
            assert infos["outcome"][1] == ended
            break
    assert ended == outcome
    assert found >= infractions


def test_road_users_are_observed_as_through_the_client(client_env: ShuttleEnv) -> None:
    envs = WorldsVectorEnv(2)
    client_env.reset(seed=0)
    run = client_env.episode.vehicle.run
    library, at = run.world.get_blueprint_library(), run.route.waypoints[20].transform
    at.location.z += 0.3
    others = [("vehicle.tesla.model3", 20), ("walker.pedestrian.0003", 12), ("static.prop.trafficcone01", 8)]
    actors = []
    try:
        for name, point in others:
            pose = run.route.waypoints[point].transform
            pose.location.z += 1.0
            actors.append(run.world.spawn_actor(library.find(name), pose))
            place, turned = pose.location, pose.rotation
            envs.worlds.spawn(name, [place.x, place.y, place.z, turned.pitch, turned.yaw, turned.roll])
        envs.reset(seed=0)
        for _ in range(40):  # the list of actors is read again every 20 steps
            one = client_env.step(np.array([0.0, 0.0], np.float32))[0]
            many = envs.step(np.zeros((2, 2), np.float32))[0]
        assert many["others"][0, :, 0].sum() == 3
        assert np.allclose(one["others"], many["others"][1], atol=1e-3)
    finally:
        for actor in actors:
            actor.destroy()


def test_an_episode_begins_again_in_the_step_after_its_end(envs: WorldsVectorEnv) -> None:
    first, _ = envs.reset(seed=0)
    actions = np.array([OFF_ROAD, GENTLE, GENTLE], np.float32)
    for _ in range(400):
        _, rewards, terminated, _, infos = envs.step(actions)
        if terminated.any():
            break
    assert terminated.tolist() == [True, False, False]
    assert infos["_outcome"].tolist() == [True, False, False]
    assert rewards[0] < -5.0
    seen, rewards, terminated, truncated, _ = envs.step(actions)
    assert not (terminated | truncated).any()
    assert rewards[0] == 0.0
    assert all(np.array_equal(seen[name][0], first[name][0]) for name in seen)
    assert not np.array_equal(seen["ego"][1], first["ego"][1])


def test_same_step_gives_the_last_observation_and_begins_at_once() -> None:
    envs = WorldsVectorEnv(2, autoreset_mode=AutoresetMode.SAME_STEP)
    first, _ = envs.reset()
    for _ in range(400):
        seen, _, terminated, _, infos = envs.step(np.array([OFF_ROAD, GENTLE], np.float32))
        if terminated.any():
            break
    assert np.array_equal(seen["ego"][0], first["ego"][0])
    assert abs(infos["final_obs"][0]["ego"][3]) > 25.0  # m off the route
    assert infos["final_obs"][1] is None
    assert infos["final_info"]["outcome"][0] == "RouteDeviation"
    assert infos["_final_info"].tolist() == [True, False]
    assert infos["route_s_m"][0] < 1.0


def test_without_autoreset_an_ended_episode_waits_for_the_mask() -> None:
    envs = WorldsVectorEnv(2, autoreset_mode="Disabled")
    envs.reset()
    actions = np.array([OFF_ROAD, GENTLE], np.float32)
    while not envs.step(actions)[2].any():
        pass
    with pytest.raises(UserError, match="environment 0 has no episode; call reset"):
        envs.step(actions)
    seen, infos = envs.reset(options={"reset_mask": np.array([True, False])})
    assert infos["_route_s_m"].tolist() == [True, False]
    assert seen["ego"][0, 0] < 0.1
    assert seen["ego"][1, 0] > 1.0
    envs.step(actions)


def test_the_number_of_threads_and_of_worlds_changes_nothing() -> None:
    dice = np.random.default_rng(7)
    actions = dice.uniform([0.0, -0.3], [1.0, 0.3], (300, 70, 2)).astype(np.float32)
    many, one, few = WorldsVectorEnv(70), WorldsVectorEnv(70, threads=1), WorldsVectorEnv(1)
    for each in (many, one, few):
        each.reset()
    for row in actions:
        seen, rewards, *_ = many.step(row)
        again, rewards_again, *_ = one.step(row)
        alone, reward, *_ = few.step(row[69:])
        assert rewards.tobytes() == rewards_again.tobytes()
        assert rewards[69] == reward[0]
        for name, values in seen.items():
            assert values.tobytes() == again[name].tobytes()
            assert values[69].tobytes() == alone[name][0].tobytes()


@pytest.mark.parametrize(
    ("actions", "sentence"),
    [
        pytest.param(np.full((3, 2), np.nan), r"an action of environment 0 is \[nan, nan\]", id="nan"),
        pytest.param([[0, 0], [0, 0], [0, 1.5]], r"an action of environment 2 is \[0, 1\.5\].*-1\.\.1", id="range"),
        pytest.param(np.zeros((2, 2)), r"the shape \(2, 2\); give \(3, 2\)", id="shape"),
        pytest.param(np.full((3, 2), "gas"), "give 3 pairs of numbers", id="dtype"),
        pytest.param(None, "an action is None", id="none"),
    ],
)
def test_wrong_actions_are_a_sentence_and_change_nothing(envs: WorldsVectorEnv, actions: Any, sentence: str) -> None:
    envs.reset()
    before = envs.worlds.state.tobytes()
    with pytest.raises(UserError, match=sentence):
        envs.step(actions)
    assert envs.worlds.state.tobytes() == before


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        pytest.param({"num_envs": 0}, "count is a whole number from 1", id="none"),
        pytest.param({"num_envs": 1, "route_id": "77"}, "has no route '77'; it has 1", id="route"),
        pytest.param({"num_envs": 1, "vehicle": "vehicle.none"}, "vehicle.none", id="vehicle"),
        pytest.param({"num_envs": 1, "device": "tpu"}, "device 'tpu'", id="device"),
        pytest.param(
            {"num_envs": 1, "autoreset_mode": "never"}, "no autoreset_mode 'never'; there are", id="autoreset"
        ),
        pytest.param({"num_envs": 1, "render_mode": "human"}, "no render mode 'human'", id="render"),
    ],
)
def test_settings_that_cannot_be_used_are_a_sentence(settings: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        WorldsVectorEnv(**settings)


def test_a_step_before_a_reset_and_a_wrong_mask_are_sentences(envs: WorldsVectorEnv) -> None:
    with pytest.raises(UserError, match="call reset"):
        WorldsVectorEnv(1).step(np.zeros((1, 2), np.float32))
    with pytest.raises(UserError, match=r"reset_mask needs an array \(3,\) of bools"):
        envs.reset(options={"reset_mask": np.array([True])})
    with pytest.raises(UserError, match="2 seeds for 3 environments"):
        envs.reset(seed=[1, 2])
