"""Registers ``linden/Shuttle-v0`` with gymnasium: many environments on `linden.Worlds`, or a single one over a client.

After ``import linden_gym``, ``gymnasium.make_vec("linden/Shuttle-v0", num_envs=1000)`` makes them, and
``gymnasium.make`` makes a single one through the official client. See ``docs/how-to/worlds.md``.
"""

from typing import Any

from basu.errors import UserError

try:
    import gymnasium

    from basu.gym import ShuttleEnv
except ImportError as error:
    raise UserError("linden_gym needs gymnasium; install it with `pip install linden-gym`") from error

ID = "linden/Shuttle-v0"


def single(**settings: Any) -> ShuttleEnv:  # noqa: ANN401 - of ShuttleEnv
    """Return one environment, through the official client.

    Raises:
        UserError: a setting is one of many environments only.
    """
    if "start_m" in settings:
        raise UserError("through the client a drive begins at the route's beginning; start_m needs gymnasium.make_vec")
    return ShuttleEnv(**settings)


gymnasium.register(id=ID, entry_point="linden_gym:single", vector_entry_point="linden_gym.environment:WorldsVectorEnv")
