"""Train a driver of the short route by PPO of Stable-Baselines3, in many worlds of this process.

usage: python examples/ppo_training.py [--actions 1500000] [--worlds 256] [--seed 0] [--output ppo]

It needs ``pip install linden-gym 'basu[sb3]'``, and writes policy.npz, curve.csv and curve.png. Then
``PPO_POLICY=ppo/policy.npz basu run examples/ppo_agent.py`` drives the policy through the server, as any agent.

The same seed gives the same policy on the same machine. The reward is that of the environment, and four things help to
learn it. Most episodes begin at random places along the route, so that a driver sees all of it from the start. The
costs of an infraction and of an early end grow to their own values once the driver knows the way, and the weights of
discomfort and offset once it obeys stop signs: a driver that still tries at random is never comfortable, and would
learn to stand. An episode ends when the vehicle has stood for 5 s. Driving too fast to stop at a stop sign costs
something long before the line, and a driver that stops there in comfort pays nothing. The drives that choose the policy
are without help, from the route's beginning.
PPO: Schulman et al. 2017, "Proximal Policy Optimization Algorithms".
"""

import argparse
import csv
import time
from pathlib import Path

import gymnasium
import numpy as np
import torch
from matplotlib.figure import Figure
from mlp_policy import Policy, write_policy
from ppo_agent import HELD_STEPS, Driver, rows, smoothed
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv, VecNormalize

from basu.conditions import STEP_S
from basu.gym import Reward
from linden_gym import ID
from linden_gym.starts import LAST_M

OFF_LANE_M, STANDING_MPS, STANDING_ACTIONS = 2.5, 0.1, 25
AWAY_SHARE = 0.8  # of the episodes, which begin at a random place of the route
KNOWN_SHARE = 0.85  # of the rest of the route, which is driven in the mean before the weights grow
STRICT_SHARE, COMFORT_SHARE = 0.1, 0.2  # of the training, in which the one and then the other grows from 0 to 1
OBEYED = 0.3  # infractions of an episode in the mean, at most, before comfort grows
SPARED = 0.8  # of the cost of an infraction and of an early end, before they grow
TOO_FAST = -2.0  # for a second with 1 m/s more than `fastest_mps`
BRAKING_MPS2, BEFORE_LINE_M = 0.8, 1.0
GAMMA = 0.995
SETTINGS = {"n_steps": 64, "batch_size": 2048, "n_epochs": 6, "gamma": GAMMA, "policy_kwargs": {"log_std_init": -0.7}}
FASTEST_LEARNING, SLOWEST_LEARNING = 6e-4, 3e-5
TRIED_EVERY = 5  # rollouts, from one drive without chance to the next, once the reward is whole
COLUMNS = ("actions", "episodes", "episode_return", "route_share", "infractions", "comfort", "tried_return", "seconds")


# -- the task


def fastest_mps(to_line_m):
    """Return the speed at which a vehicle can still come to rest before the line of a stop sign, in comfort."""
    return np.sqrt(2.0 * BRAKING_MPS2 * np.maximum(0.0, to_line_m - BEFORE_LINE_M))


class TrainingWorlds(VecEnv):
    """The environments `linden/Shuttle-v0` as Stable-Baselines3 wants them; an action holds for `HELD_STEPS` steps.

    To save time, an episode ends as a failure once the vehicle has left its lane, stands for 5 s, or commits an
    infraction. ``ended`` has for each episode that ended: the return, the share of the way from its beginning to the
    route's end, and the infractions.
    """

    render_mode = None

    def __init__(self, count, reward, seed):
        self.dice = np.random.default_rng(seed)
        self.worlds = gymnasium.make_vec(ID, num_envs=count, autoreset_mode="Disabled", reward=reward)
        self.length_m, self.failure = self.worlds.unwrapped.route.length_m, reward.failure
        self.strict, self.comfort, self.ended = 0.0, 0.0, []
        space = gymnasium.spaces.Box(-np.inf, np.inf, rows(*self._begun(count)).shape[1:], np.float32)
        super().__init__(count, space, self.worlds.single_action_space)

    def _begun(self, count):
        self.returns, self.infractions, self.stood = (np.zeros(count) for _ in range(3))
        self.applied = np.zeros((count, 2), np.float32)
        self.began_m = np.zeros(count)
        return self._begin(np.ones(count, np.bool_)), self.applied

    def _begin(self, mask):
        """Begin episodes, most of them at random places; return the observations."""
        away = self.dice.random(len(mask)) < AWAY_SHARE
        places_m = away * self.dice.uniform(0.0, self.length_m - LAST_M, len(mask))
        seen, told = self.worlds.reset(options={"reset_mask": mask, "start_m": places_m})
        self.began_m = np.where(mask, told["route_s_m"], self.began_m)
        return seen

    def reset(self):
        return rows(*self._begun(self.num_envs))

    def step_async(self, actions):
        self.applied = smoothed(self.applied, actions)

    def step_wait(self):
        rewards, over = np.zeros(self.num_envs), np.zeros(self.num_envs, np.bool_)
        infos = [{} for _ in range(self.num_envs)]
        for _ in range(HELD_STEPS):
            seen, reward, terminated, truncated, told = self.worlds.step(self.applied)
            speed_mps, offset_m = seen["ego"][:, 0], seen["ego"][:, 3]
            self.stood = np.where(speed_mps < STANDING_MPS, self.stood + 1, 0)
            gives_up = (np.abs(offset_m) > OFF_LANE_M) | (self.stood > STANDING_ACTIONS * HELD_STEPS)
            gives_up &= ~(terminated | truncated)
            reward = reward + self._help(seen, told) + np.where(gives_up, self.failure * (1.0 - self._spared()), 0.0)
            rewards += np.where(over, 0.0, reward)  # what an action that goes on does at a new beginning is not counted
            self.infractions += np.where(over, 0, told["infractions"])
            ends = terminated | truncated | gives_up
            if ends.any():
                last = rows(seen, self.applied)
                for row in np.flatnonzero(ends & ~over):
                    infos[row] = {"terminal_observation": last[row], "TimeLimit.truncated": bool(truncated[row])}
                    share = (told["route_s_m"][row] - self.began_m[row]) / (self.length_m - self.began_m[row])
                    self.ended.append((self.returns[row] + rewards[row], share, self.infractions[row]))
                over |= ends
                self.stood[ends] = 0
                seen = self._begin(ends)
        self.returns = np.where(over, 0.0, self.returns + rewards)
        self.infractions[over], self.applied[over] = 0, 0.0
        return rows(seen, self.applied), rewards, over, infos

    def know(self, share, infractions, of_training):
        """Let the weights grow after a rollout with this mean share of the way and of infractions."""
        if share >= KNOWN_SHARE and self.strict < 1.0:
            self.strict = min(1.0, self.strict + of_training / STRICT_SHARE)
        elif share >= KNOWN_SHARE and infractions <= OBEYED:
            self.comfort = min(1.0, self.comfort + of_training / COMFORT_SHARE)

    def _spared(self):
        """Return the share of the cost of infractions and early ends that does not count yet."""
        return SPARED * (1.0 - self.strict)

    def _help(self, seen, told):
        """Return what the training adds to the reward of a step."""
        is_near, to_line_m = seen["stop_sign"].T
        too_fast_mps = is_near * np.maximum(0.0, seen["ego"][:, 0] - fastest_mps(to_line_m))
        parts = told["reward_parts"]
        spared = (1.0 - self.comfort) * (parts["discomfort"] + parts["offset"])
        spared += self._spared() * parts["infraction"]
        return TOO_FAST * STEP_S * too_fast_mps - spared

    def close(self):
        self.worlds.close()

    def get_attr(self, attr_name, indices=None):
        return [getattr(self, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name, value, indices=None):
        raise NotImplementedError("the worlds share their attributes; set them on the object itself")

    def env_method(self, method_name, *args, indices=None, **settings):
        raise NotImplementedError("the worlds are no objects; call methods of `worlds`")

    def env_is_wrapped(self, wrapper_class, indices=None):
        return [False for _ in self._get_indices(indices)]


def drive(driver, reward, worlds=None):
    """Drive one world to the end of its episode; return the parts of the return, the last info and the steps."""
    worlds = worlds or gymnasium.make_vec(ID, num_envs=1, autoreset_mode="Disabled", reward=reward)
    seen, _ = worlds.reset()
    parts, steps, is_over = dict.fromkeys(reward.__slots__, 0.0), 0, False
    while not is_over:
        seen, _, terminated, truncated, told = worlds.step(driver(seen))
        parts = {name: total + float(told["reward_parts"][name][0]) for name, total in parts.items()}
        is_over, steps = bool(terminated[0] or truncated[0]), steps + 1
    return parts, told, steps


# -- training


class Curve(BaseCallback):
    """Writes a row of curve.csv after each rollout; at times the policy drives without chance, and the best is kept."""

    def __init__(self, actions, worlds, reward, folder):
        super().__init__()
        self.actions, self.worlds, self.reward, self.folder = actions, worlds, reward, folder
        self.trial = gymnasium.make_vec(ID, num_envs=1, autoreset_mode="Disabled", reward=reward)
        self.rollouts, self.best, self.began_s = 0, -np.inf, time.perf_counter()
        self.file = (folder / "curve.csv").open("w", newline="")
        self.table = csv.writer(self.file)
        self.table.writerow(COLUMNS)

    def _on_step(self):
        return True

    def _on_rollout_end(self):
        done = self.num_timesteps / self.actions
        ended, self.worlds.ended = self.worlds.ended, []
        self.rollouts += 1
        tried = ""
        if (self.worlds.comfort == 1.0 and self.rollouts % TRIED_EVERY == 0) or done >= 1.0:
            tried = f"{self._try():.2f}"
        if ended:
            _, share, infractions = np.mean(ended, axis=0)
            self.worlds.know(share, infractions, self.num_timesteps / self.rollouts / self.actions)
        means = [f"{mean:.3f}" for mean in np.mean(ended, axis=0)] if ended else ["", "", ""]
        row = [
            self.num_timesteps,
            len(ended),
            *means,
            f"{self.worlds.comfort:.3f}",
            tried,
            f"{time.perf_counter() - self.began_s:.1f}",
        ]
        self.table.writerow(row)
        self.file.flush()
        print("  ".join(f"{name} {value}" for name, value in zip(COLUMNS, row, strict=True) if value != ""), flush=True)

    def _try(self):
        """Drive the policy once by its mean actions, keep it if it is the best one, and return its return."""
        path = self.folder / "tried.npz"
        write_policy(path, self.model, self.model.get_vec_normalize_env())
        parts, _, _ = drive(Driver(Policy(path)), self.reward, self.trial)
        total = sum(parts.values())
        if total > self.best:
            self.best = total
            path.replace(self.folder / "policy.npz")
        path.unlink(missing_ok=True)
        return total

    def _on_training_end(self):
        self.file.close()


def train(actions, count, seed, folder, reward=Reward(), **settings):  # noqa: B008 - frozen
    """Train for so many actions of ``count`` worlds together; write policy.npz, curve.csv and curve.png."""
    torch.set_num_threads(1)
    folder.mkdir(parents=True, exist_ok=True)
    worlds = TrainingWorlds(count, reward, seed)
    environments = VecNormalize(worlds, gamma=GAMMA)
    usual = SETTINGS | {"learning_rate": lambda left: max(SLOWEST_LEARNING, FASTEST_LEARNING * left)}
    model = PPO("MlpPolicy", environments, seed=seed, device="cpu", **usual | settings)
    model.learn(actions, callback=Curve(actions, worlds, reward, folder))
    draw_curve(folder)
    return model


def draw_curve(folder):
    """Draw curve.png from curve.csv, over the actions with the seconds above, and return nothing."""
    columns = np.genfromtxt(folder / "curve.csv", delimiter=",", names=True, ndmin=1)
    actions, seconds = columns["actions"], columns["seconds"]
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    labels = ("return", "share of the route", "infractions")
    for axis, name, label in zip(axes, COLUMNS[2:5], labels, strict=True):
        axis.plot(actions, columns[name], color="0.55", label="mean of the episodes that ended, with chance")
        axis.set(ylabel=label)
        axis.grid(color="0.92")
    tried = np.isfinite(columns["tried_return"])
    axes[0].plot(
        actions[tried], columns["tried_return"][tried], "o-", color="black", markersize=3, label="mean actions"
    )
    axes[0].legend(loc="lower right")
    above = axes[0].secondary_xaxis(
        "top", functions=(lambda x: np.interp(x, actions, seconds), lambda x: np.interp(x, seconds, actions))
    )
    above.set(xlabel="seconds of training")
    axes[-1].set(xlabel=f"actions of all worlds together, {HELD_STEPS * STEP_S:g} s each")
    figure.savefig(folder / "curve.png", dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--actions", type=int, default=1_500_000, help="of all worlds together")
    parser.add_argument("--worlds", type=int, default=256)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=Path("ppo"))
    given = parser.parse_args()
    train(given.actions, given.worlds, given.seed, given.output)
    parts, told, steps = drive(Driver(Policy(given.output / "policy.npz")), Reward())
    shown = ", ".join(f"{name} {value:.2f}" for name, value in parts.items())
    print(f"{told['outcome'][0]} after {steps * STEP_S:.1f} s, return {sum(parts.values()):.2f}: {shown}")


if __name__ == "__main__":
    main()
