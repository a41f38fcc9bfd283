"""A CARLA 0.9.16 server in Python: no Unreal, no GPU, the same answer every time. `Worlds`: many worlds, no server."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from linden.worlds import Worlds

__version__ = "0.1.0"
CARLA_VERSION = "0.9.16"
"""The release of the wire protocol; the official client compares it with its own."""

__all__ = ["CARLA_VERSION", "Worlds", "__version__"]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - of any kind
    """Return ``Worlds``, imported at its first use: a command that prints its help does without numba."""
    if name == "Worlds":
        from linden.worlds import Worlds  # noqa: PLC0415 - 0.5 s that commands without a world do without

        return Worlds
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
