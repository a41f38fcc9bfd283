"""The driver that `examples/ppo_training.py` has trained: `basu run examples/ppo_agent.py`.

The policy is the file that the environment variable PPO_POLICY names, or the one that comes with this example.
"""

import os
from pathlib import Path

import numpy as np
from mlp_policy import Policy

from basu.gym_agent import GymAgent

BASELINE = Path(__file__).with_name("ppo_baseline") / "policy.npz"
SEEN = ("ego", "route", "stop_sign")  # of the observation; the policy was trained without other road users
HELD_STEPS = 4  # the policy acts every 0.2 s
SMOOTHING = np.float32(0.3)  # share of the way from the pedals and the steering of before to those of the policy


def rows(seen, applied):
    """Return what the policy sees of N vehicles, (N, n): parts of the observation, and the action that is applied."""
    return np.concatenate([*(seen[name].reshape(len(applied), -1) for name in SEEN), applied], axis=1)


def smoothed(applied, actions):
    """Return the actions (N, 2) to apply after those ``applied``: passengers feel sudden changes."""
    return applied + SMOOTHING * (actions - applied)


class Driver:
    """A policy at the wheel of N vehicles; call it with the observation of each step of 0.05 s."""

    def __init__(self, policy, count=1):
        self.policy, self.steps, self.applied = policy, 0, np.zeros((count, 2), np.float32)

    def __call__(self, seen):
        if self.steps % HELD_STEPS == 0:
            self.applied = smoothed(self.applied, self.policy(rows(seen, self.applied)))
        self.steps += 1
        return self.applied


class PpoAgent(GymAgent):
    def setup(self):
        super().setup()
        self.driver = Driver(Policy(os.environ.get("PPO_POLICY", BASELINE)))

    def act(self, seen):
        return self.driver({name: values[None] for name, values in seen.items()})[0]

    def config(self):
        return {"routes": "routes/linden_short.xml", "vehicle": "vehicle.easymile.ez10"}
