"""`compile_environments`, for `linden compile`: compiles the environments' kernels by a short drive."""

import numpy as np

from linden_gym.environment import WorldsVectorEnv


def compile_environments() -> None:
    """Compile the kernels of worlds and of environments, or load them from the cache."""
    envs = WorldsVectorEnv(2)
    envs.reset()
    envs.step(np.zeros((2, 2), np.float32))
    envs.reset(options={"reset_mask": np.array([True, False])})
