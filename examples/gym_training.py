"""Train a small policy by the cross-entropy method, in several simulators at once.

usage: python examples/gym_training.py [--environments 4] [--generations 8] [--steps 200] [--seed 0]

The policy is linear: steering from the place of the route 10 m ahead, pedals from the speed. The method draws policies
from a normal distribution, drives each once, and moves the distribution to the best of them (Rubinstein, Kroese 2004).
"""

import argparse

import gymnasium
import numpy as np

import basu.gym  # noqa: F401 - registers basu/Linden-v0

BEST = 0.25  # share of a generation's policies that the next one comes from
LEAST_DEVIATION = 0.05


def actions_of(policies, seen):
    """Actions (N, 2) of policies (N, 3) for the observations of N environments."""
    x_m, y_m = seen["route"][:, 1, 0], seen["route"][:, 1, 1]
    steer = policies[:, 0] * np.arctan2(y_m, x_m)
    pedals = policies[:, 1] * (policies[:, 2] - seen["ego"][:, 0])
    return np.column_stack([pedals, steer]).clip(-1.0, 1.0).astype(np.float32)


def returns_of(environments, policies, steps, seed):
    """The sum of rewards of each policy in its first episode, at most so many steps."""
    seen, _ = environments.reset(seed=[seed] * len(policies))
    total, is_over = np.zeros(len(policies)), np.zeros(len(policies), dtype=bool)
    for _ in range(steps):
        seen, rewards, terminated, truncated, _ = environments.step(actions_of(policies, seen))
        total += np.where(is_over, 0.0, rewards)
        is_over |= terminated | truncated
        if is_over.all():
            break
    return total


def train(environments, generations, steps, seed):
    """The best policy of each generation, the mean of all returns, and its own."""
    dice, number = np.random.default_rng(seed), environments.num_envs
    mean, deviation = np.array([0.0, 0.0, 4.0]), np.array([1.0, 0.5, 2.0])
    found = []
    for generation in range(generations):
        policies = mean + deviation * dice.standard_normal((2 * number, 3))
        totals = np.concatenate(
            [returns_of(environments, half, steps, seed) for half in (policies[:number], policies[number:])]
        )
        best = policies[np.argsort(-totals)[: max(2, round(BEST * len(policies)))]]
        mean, deviation = best.mean(axis=0), np.maximum(best.std(axis=0), LEAST_DEVIATION)
        found.append((policies[totals.argmax()], float(totals.mean()), float(totals.max())))
        print(f"generation {generation}: mean {totals.mean():.2f}, best {totals.max():.2f}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--environments", type=int, default=4)
    parser.add_argument("--generations", type=int, default=8)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    environments = gymnasium.make_vec("basu/Linden-v0", num_envs=given.environments)
    try:
        train(environments, given.generations, given.steps, given.seed)
    finally:
        environments.close()


if __name__ == "__main__":
    main()
