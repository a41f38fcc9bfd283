"""Claims about the PettingZoo environment: it keeps PettingZoo's contract, and each vehicle ends by itself."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test

from basu.errors import UserError
from basu.gym_parallel import ShuttlesEnv
from servers import RunningServer

GENTLE, HARD = np.array([0.4, 0.0], np.float32), np.array([1.0, 0.0], np.float32)


@pytest.fixture
def env(simulator: RunningServer) -> Iterator[ShuttlesEnv]:
    made = ShuttlesEnv(headway_m=14.0, host="127.0.0.1", port=simulator.port)
    yield made
    made.close()


def test_pettingzoos_own_test_is_content(env: ShuttlesEnv) -> None:
    parallel_api_test(env, num_cycles=60)


def test_one_seed_gives_the_same_drive_again(env: ShuttlesEnv) -> None:
    def drive() -> list[Any]:
        seen, _ = env.reset(seed=3)
        found: list[Any] = [seen]
        for _ in range(40):
            observations, rewards, *_ = env.step(dict.fromkeys(env.agents, GENTLE))
            found += [observations, rewards]
        return found

    one, again = drive(), drive()
    np.testing.assert_equal(one, again)
    assert not np.array_equal(one[-2]["hero"]["route"], one[-2]["hero_2"]["route"])


def test_each_observes_the_other_at_its_headway(env: ShuttlesEnv) -> None:
    seen, _ = env.reset(seed=0)
    ahead, behind = seen["hero"]["others"][0], seen["hero_2"]["others"][0]
    assert ahead[0] == behind[0] == 1.0
    assert ahead[1] == pytest.approx(14.0, abs=1.5)
    assert behind[1] == pytest.approx(-14.0, abs=1.5)


def test_a_contact_costs_both_and_an_end_is_ones_own(env: ShuttlesEnv) -> None:
    env.reset(seed=0)
    found: dict[str, list[Any]] = {"hero": [], "hero_2": []}
    standing = np.array([-1.0, 0.0], np.float32)
    for _ in range(120):
        _, _, _, _, infos = env.step({"hero": HARD, "hero_2": standing})
        for name, info in infos.items():
            found[name] += info["infractions"]
    assert [each.kind.value for each in found["hero"]][:1] == ["collision_vehicle"]
    assert [each.kind.value for each in found["hero_2"]] == ["collision_vehicle"]
    turning = np.array([1.0, -0.1], np.float32)
    env.reset(seed=0)
    ended: set[str] = set()
    for _ in range(400):
        _, _, terminated, _, infos = env.step({name: turning if name == "hero_2" else standing for name in env.agents})
        ended |= {name for name, is_over in terminated.items() if is_over}
        if ended:
            assert infos["hero_2"]["outcome"] == "RouteDeviation"
            break
    assert ended == {"hero_2"}
    assert env.agents == ["hero"]
    seen, *_ = env.step({"hero": standing})
    assert set(seen) == {"hero"}


def test_a_missing_action_gets_a_sentence(env: ShuttlesEnv) -> None:
    env.reset(seed=0)
    with pytest.raises(UserError, match=r"no action for hero_2; give one for each"):
        env.step({"hero": GENTLE})
    with pytest.raises(UserError, match="shuttles is 0"):
        ShuttlesEnv(shuttles=0)
