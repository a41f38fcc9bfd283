"""Train a driver by PPO of Stable-Baselines3, and compare it with others on routes that it has never driven.

usage: python examples/sb3_training.py train [--steps 300000] [--seed 0] [--output sb3]
       python examples/sb3_training.py compare [--policy sb3/policy.npz]

``pip install basu[sb3]`` brings Stable-Baselines3 and PyTorch. ``compare`` needs neither. The routes are parts of the
LEAP route with bends, junctions and a roundabout, without other road users. They have no stop sign: an observation
shows none. Each training route has a process and a simulator of its own.
PPO: Schulman et al. 2017, "Proximal Policy Optimization Algorithms".
"""

import argparse
import csv
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.wrappers import FilterObservation, FlattenObservation
from matplotlib.figure import Figure
from mlp_policy import Policy, write_policy

from basu.agents.builtin.basic import BasicAgent
from basu.gym import Reward, ShuttleEnv
from basu.metrics.infraction import Infraction

ROUTES = Path(__file__).with_name("training_routes.xml")
TRAINING, UNSEEN = ("train_1", "train_2", "train_3", "train_4"), ("unseen_1", "unseen_2", "unseen_3")
BASELINE = Path(__file__).with_name("sb3_baseline") / "policy.npz"
HELD_STEPS = 4  # a policy acts every 0.2 s
OFF_LANE_M, STANDING_MPS, STANDING_ACTIONS = 2.5, 0.5, 50
COLUMNS = ("actions", "episode_return", "route_share", "passed")  # of curve.csv, a row for each episode of training
AVERAGED = 40  # episodes
COLLISIONS = {Infraction.COLLISION_PEDESTRIAN, Infraction.COLLISION_VEHICLE, Infraction.COLLISION_STATIC}


# -- the task


class Hold(gymnasium.Wrapper):
    """Repeat each action for some steps, sum their rewards, and add ``route_share`` to the info."""

    def __init__(self, env, steps):
        super().__init__(env)
        self.steps = steps

    def step(self, action):
        total, infractions = 0.0, ()
        for _ in range(self.steps):
            seen, reward, terminated, truncated, info = self.env.step(action)
            total, infractions = total + reward, infractions + info["infractions"]
            if terminated or truncated:
                break
        share = info["route_s_m"] / self.unwrapped.episode.ground.route.s_m[-1]
        return seen, total, terminated, truncated, {**info, "infractions": infractions, "route_share": share}


class GiveUp(gymnasium.Wrapper):
    """End an episode as a failure once the vehicle has left its lane, or stands for 10 s: it saves time."""

    def reset(self, **settings):
        self.stood = 0
        return self.env.reset(**settings)

    def step(self, action):
        seen, reward, terminated, truncated, info = self.env.step(action)
        speed_mps, offset_m = seen["ego"][0], seen["ego"][3]
        self.stood = self.stood + 1 if speed_mps < STANDING_MPS else 0
        if not terminated and (abs(offset_m) > OFF_LANE_M or self.stood > STANDING_ACTIONS):
            return seen, reward + Reward().failure, True, truncated, {**info, "passed": False}
        return seen, reward, terminated, truncated, info


def environment(route, *, held_steps=HELD_STEPS, gives_up=False):
    """Return the environment of one route. An observation is one row: state of the vehicle, and the route ahead."""
    made = Hold(ShuttleEnv(routes=str(ROUTES), route_id=route), held_steps)
    made = GiveUp(made) if gives_up else made
    return FlattenObservation(FilterObservation(made, ["ego", "route"]))


# -- training


def train(routes, actions, seed, folder, **settings):
    """Train for so many actions; write untrained.npz, policy.npz, curve.csv and curve.png; return the model."""
    import torch  # noqa: PLC0415 - of the extra sb3, which is needed for training only
    from stable_baselines3 import PPO  # noqa: PLC0415
    from stable_baselines3.common.monitor import Monitor  # noqa: PLC0415
    from stable_baselines3.common.vec_env import SubprocVecEnv, VecNormalize  # noqa: PLC0415

    torch.set_num_threads(1)  # more threads take the processors from the simulators
    folder.mkdir(parents=True, exist_ok=True)
    makers = [lambda name=name: Monitor(environment(name, gives_up=True)) for name in routes]
    environments = VecNormalize(SubprocVecEnv(makers, start_method="spawn"), gamma=0.99)
    usual = {"n_steps": 512, "batch_size": 256, "policy_kwargs": {"log_std_init": -0.7}}
    try:
        with (folder / "curve.csv").open("w", newline="") as file:
            model = PPO("MlpPolicy", environments, seed=seed, device="cpu", **usual | settings)
            write_policy(folder / "untrained.npz", model, environments)
            rows = csv.writer(file)
            rows.writerow(COLUMNS)
            model.learn(actions, callback=lambda now, _: note_ends(rows, now["self"].num_timesteps, now["infos"]))
            write_policy(folder / "policy.npz", model, environments)
    finally:
        environments.close()
    draw_curve(folder)
    return model


def note_ends(rows, actions, infos):
    """Write a row of curve.csv for each episode that has just ended, and print it; return that training goes on."""
    for info in infos:
        if "episode" in info:
            total, share = float(info["episode"]["r"]), float(info["route_share"])
            rows.writerow([actions, f"{total:.2f}", f"{share:.3f}", int(info["passed"])])
            print(f"{actions:>7} actions: return {total:7.2f}, {share:4.0%} of the route", flush=True)
    return True


def draw_curve(folder):
    """Draw curve.png from curve.csv: each episode of training, and the mean of the last 40."""
    columns = np.genfromtxt(folder / "curve.csv", delimiter=",", names=True, ndmin=1)
    figure = Figure(figsize=(8.0, 4.5), layout="constrained")
    for axis, name, label in zip(
        figure.subplots(2, 1, sharex=True), COLUMNS[1:3], ("return", "share of the route"), strict=True
    ):
        values = columns[name]
        means = [values[max(0, end - AVERAGED) : end].mean() for end in range(1, len(values) + 1)]
        axis.plot(columns["actions"], values, ".", color="0.7", markersize=3, label="one episode")
        axis.plot(columns["actions"], means, color="black", label=f"mean of the last {AVERAGED}")
        axis.set(ylabel=label)
        axis.grid(color="0.92")
    axis.set(xlabel=f"actions of all environments together, {HELD_STEPS * 0.05:g} s each")
    axis.legend(loc="upper left")
    figure.savefig(folder / "curve.png", dpi=110)


# -- comparing


def built_in(env):
    """Return the driver `basic` on the route of an environment, as a function of the observation."""
    run, agent = env.unwrapped.episode.vehicle.run, BasicAgent()
    agent.bind(
        client=run.client, world=run.world, map=run.carla_map, vehicle=run.vehicle, route=run.route,
        config_values=agent.config(), time_step_s=run.step_s,
    )  # fmt: skip
    agent.setup()

    def act(_seen):
        control = agent.run_step({})
        return np.array([control.throttle - control.brake, control.steer], np.float32)

    return act


def drive(env, driver, seed, most_actions=None):
    """Drive one episode; return its return, share of the route, infractions, collisions and whether it passed."""
    seen, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    act, total, infractions, actions, is_over = driver(env), 0.0, [], 0, False
    while not is_over and actions != most_actions:
        seen, reward, terminated, truncated, info = env.step(act(seen))
        total, is_over, actions = total + reward, terminated or truncated, actions + 1
        infractions += info["infractions"]
    collisions = sum(found.kind in COLLISIONS for found in infractions)
    return total, info["route_share"], len(infractions), collisions, info.get("passed", False)


def compare(drivers, routes, seeds=(0,), most_actions=None):
    """Print the means of each driver over the routes; return them by the drivers' names."""
    print(f"{'driver':<12}{'return':>8}{'route':>8}{'infractions':>13}{'collisions':>12}{'passed':>10}")
    means = {}
    for name, (driver, held_steps) in drivers.items():
        rows = []
        for route in routes:
            env = environment(route, held_steps=held_steps)
            rows += [drive(env, driver, seed, most_actions) for seed in seeds]
            env.close()
        means[name] = np.mean(np.array(rows, dtype=np.float64), axis=0)
        total, share, infractions, collisions, _ = means[name]
        passed = f"{sum(row[-1] for row in rows)} of {len(rows)}"
        print(f"{name:<12}{total:>8.1f}{share:>8.1%}{infractions:>13.2f}{collisions:>12.2f}{passed:>10}", flush=True)
    return means


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    training = commands.add_parser("train")
    training.add_argument("--steps", type=int, default=300_000, help="actions of all environments together")
    training.add_argument("--seed", type=int, default=0)
    training.add_argument("--output", type=Path, default=Path("sb3"))
    comparing = commands.add_parser("compare")
    comparing.add_argument("--policy", type=Path, default=BASELINE)
    comparing.add_argument("--training-routes", action="store_true", help="in place of the unseen ones")
    given = parser.parse_args()
    if given.command == "train":
        train(TRAINING, given.steps, given.seed, given.output)
        return
    drivers = {
        "random": (lambda env: lambda _seen: env.action_space.sample(), HELD_STEPS),
        "untrained": (lambda _env: Policy(given.policy.with_name("untrained.npz")), HELD_STEPS),
        "trained": (lambda _env: Policy(given.policy), HELD_STEPS),
        "basic": (built_in, 1),
    }
    compare(drivers, TRAINING if given.training_routes else UNSEEN)


if __name__ == "__main__":
    main()
