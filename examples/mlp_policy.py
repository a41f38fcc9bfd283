"""A trained policy of Stable-Baselines3 as plain arrays: written by `write_policy`, read and applied by `Policy`.

Numpy alone applies it. The file has no pickles, so that it may come from anywhere.
"""

import numpy as np

LAYERS = ("mlp_extractor.policy_net.0", "mlp_extractor.policy_net.2", "action_net")


def write_policy(path, model, environments):
    """Write the weights of the policy, and mean and variance of the observations of a `VecNormalize`."""
    weights = {name: values.numpy() for name, values in model.policy.state_dict().items() if name.startswith(LAYERS)}
    seen = environments.obs_rms
    np.savez_compressed(path, mean=seen.mean.astype(np.float32), var=seen.var.astype(np.float32), **weights)


class Policy:
    """The policy: normalised observations (n,) or (N, n), two hidden layers, and the mean action (2,) or (N, 2)."""

    def __init__(self, path):
        with np.load(path, allow_pickle=False) as kept:
            self.mean, self.deviation = kept["mean"], np.sqrt(kept["var"] + 1e-8)
            self.layers = [(kept[f"{name}.weight"], kept[f"{name}.bias"]) for name in LAYERS]

    def __call__(self, seen):
        values = np.clip((seen - self.mean) / self.deviation, -10.0, 10.0)
        for weight, bias in self.layers[:-1]:
            values = np.tanh(values @ weight.T + bias)
        weight, bias = self.layers[-1]
        return np.clip(values @ weight.T + bias, -1.0, 1.0).astype(np.float32)
