"""Train a policy by PPO of Ray's RLlib, on several environments at once.

usage: python examples/rllib_training.py [--environments 4] [--runners 0] [--iterations 3] [--steps 2000] [--seed 0]

``pip install basu[rllib]`` brings Ray's RLlib and PyTorch. RLlib makes one vector of environments for each of its
runners, by the function that ``register_env`` names. Each environment has a worker process and a simulator of its own.
PPO: Schulman et al. 2017, "Proximal Policy Optimization Algorithms".
"""

import argparse

from ray.tune.registry import register_env

from basu.gym import ShuttleEnv
from basu.gym_vector import ShuttleVectorEnv

NAME = "basu-linden"


def environment(settings):
    """A vector of environments where RLlib gives ``num_envs``, else one; the rest are settings of ShuttleEnv."""
    settings = dict(settings)
    number = settings.pop("num_envs", None)
    return ShuttleEnv(**settings) if number is None else ShuttleVectorEnv(number, **settings)


def configuration(environments, runners, steps, seed, **settings):
    """PPO with a small network, on observations that are joined to one row of numbers."""
    from ray.rllib.algorithms.ppo import PPOConfig  # noqa: PLC0415 - these two need PyTorch
    from ray.rllib.connectors.env_to_module import FlattenObservations  # noqa: PLC0415

    register_env(NAME, environment)
    return (
        PPOConfig()
        .environment(NAME, env_config=settings)
        .env_runners(
            num_env_runners=runners,
            num_envs_per_env_runner=environments,
            gym_env_vectorize_mode="vector_entry_point",
            env_to_module_connector=lambda *_of_runner: FlattenObservations(),
        )
        .training(train_batch_size_per_learner=steps, minibatch_size=min(steps, 256), num_epochs=8, lr=3e-4)
        .rl_module(model_config={"fcnet_hiddens": [64, 64]})
        .debugging(seed=seed, log_level="ERROR")
    )


def train(algorithm, iterations):
    """Train for some iterations; return the steps, the ended episodes and their mean return of each, and print them."""
    found = []
    for iteration in range(iterations):
        seen = algorithm.train()["env_runners"]
        steps, episodes = int(seen["num_env_steps_sampled"]), int(seen["num_episodes"])
        mean = float(seen["episode_return_mean"]) if episodes else float("nan")
        found.append((steps, episodes, mean))
        print(f"iteration {iteration}: {steps} steps, {episodes} episodes ended, mean return {mean:.2f}", flush=True)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--environments", type=int, default=4, help="of each runner")
    parser.add_argument("--runners", type=int, default=0, help="processes of Ray; 0: environments of this process")
    parser.add_argument("--iterations", type=int, default=3)
    parser.add_argument("--steps", type=int, default=2000, help="of all environments together, in an iteration")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    algorithm = configuration(given.environments, given.runners, given.steps, given.seed).build_algo()
    try:
        train(algorithm, given.iterations)
    finally:
        algorithm.stop()


if __name__ == "__main__":
    main()
