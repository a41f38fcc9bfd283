"""Claims about the reward: a careful driver of the short route gains more than each driver that cheats."""

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.gym import Reward
from fakes.route_drivers import Seen, careful, without_signs
from linden_gym.environment import WorldsVectorEnv

CHEATS = ("stands", "creeps", "runs signs", "races", "weaves", "jerks", "cuts bends", "leaves the route")
NAMES = ("careful", *CHEATS)
CRUISE_MPS = 3.6


def actions_at(step: int, seen: Seen) -> NDArray[np.float32]:
    """Actions of all drivers, in the order of `NAMES`."""
    actions = careful(seen, CRUISE_MPS)
    blind = careful(without_signs(seen), CRUISE_MPS)
    speed_mps = seen["ego"][:, 0]
    row = {name: index for index, name in enumerate(NAMES)}
    actions[row["stands"]] = [-1.0, 0.0]
    actions[row["creeps"], 0] = 0.4 * (min(0.5, CRUISE_MPS) - speed_mps[row["creeps"]])
    actions[row["runs signs"]] = blind[row["runs signs"]]
    actions[row["races"]] = blind[row["races"]]
    actions[row["races"], 0] = 0.4 * (14.0 - speed_mps[row["races"]])
    actions[row["weaves"], 1] += 0.25 * np.sin(step / 15.0)
    if speed_mps[row["jerks"]] > 2.5:
        actions[row["jerks"], 0] = 0.7 if step // 10 % 2 else -0.5
    x_m, y_m = seen["route"][row["cuts bends"], 1]  # 10 m ahead
    actions[row["cuts bends"], 1] = 1.2 * np.arctan2(y_m, x_m)
    actions[row["leaves the route"]] = [0.5, -0.1]
    return actions.clip(-1.0, 1.0).astype(np.float32)


@pytest.fixture(scope="module")
def returns() -> dict[str, dict[str, float]]:
    """The parts of each driver's return, with its outcome as ``arrived``."""
    envs = WorldsVectorEnv(len(NAMES), autoreset_mode="Disabled")
    seen, _ = envs.reset(seed=0)
    drives = np.ones(len(NAMES), np.bool_)
    parts: dict[str, dict[str, float]] = {name: dict.fromkeys(Reward.__slots__, 0.0) for name in NAMES}
    step = 0
    while drives.any():
        seen, _, terminated, truncated, infos = envs.step(actions_at(step, seen))
        for index in np.flatnonzero(drives):
            for part in Reward.__slots__:
                parts[NAMES[index]][part] += float(infos["reward_parts"][part][index])
        over = terminated | truncated
        drives &= ~over
        if over.any():
            seen, _ = envs.reset(options={"reset_mask": over})
        step += 1
    return parts


def test_the_careful_driver_arrives_without_an_infraction(returns: dict[str, dict[str, float]]) -> None:
    careful = returns["careful"]
    assert careful["arrival"] > 0.0
    assert careful["infraction"] == 0.0
    assert sum(careful.values()) > 75.0


@pytest.mark.parametrize("cheat", CHEATS)
def test_a_cheat_gains_less(returns: dict[str, dict[str, float]], cheat: str) -> None:
    assert sum(returns[cheat].values()) < sum(returns["careful"].values()) - 1.0


def test_each_cheat_costs_where_it_cheats(returns: dict[str, dict[str, float]]) -> None:
    assert returns["stands"]["failure"] < 0.0
    assert returns["runs signs"]["infraction"] == 2.0 * Reward().infraction
    assert returns["races"]["discomfort"] < 10.0 * returns["careful"]["discomfort"]
    assert returns["weaves"]["offset"] < 2.0 * returns["careful"]["offset"]
    assert returns["jerks"]["discomfort"] < 2.0 * returns["careful"]["discomfort"]
    assert returns["cuts bends"]["offset"] < 2.0 * returns["careful"]["offset"]
    assert returns["leaves the route"]["arrival"] == 0.0
