"""Many gymnasium environments in one process, on `linden.Worlds`, by the rules of `basu.gym`.

After ``import linden_gym``, ``gymnasium.make_vec("linden/Shuttle-v0", num_envs=1000)`` makes them, and
``gymnasium.make`` makes a single one through the official client. See ``docs/how-to/worlds.md``.
"""

from basu.errors import UserError

try:
    import gymnasium
except ImportError as error:
    raise UserError("linden_gym needs gymnasium; install it with `pip install linden-gym`") from error

ID = "linden/Shuttle-v0"

gymnasium.register(
    id=ID, entry_point="basu.gym:ShuttleEnv", vector_entry_point="linden_gym.environment:WorldsVectorEnv"
)
