"""Drive along a path, at a speed or by a profile of speeds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.actions.puppet import AtEnd, Limits, Puppet, minded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.paths import Path

Speeds = float | tuple[tuple[float, float], ...]  # m/s; or (m along the path, m/s) pairs, linear between them


class DriveAlong(Puppet):
    """Lead a vehicle along a path.

    ``considerate`` makes it brake for the ego where that is ahead on its path, ``minds`` for others by name.
    ``at_end``: "hold" brakes to stand at the end of the path, "go on" leaves it rolling straight on, "vanish" takes
    it out of the world. ``to_m`` ends it before the end of the path.
    """

    def __init__(
        self,
        actor: str,
        path: Path,
        speed_mps: Speeds,
        *,
        to_m: float | None = None,
        considerate: bool = False,
        minds: Sequence[str] = (),
        at_end: AtEnd = "hold",
        accelerate_mps2: float = 2.5,
        brake_mps2: float = 4.0,
    ) -> None:
        self.speeds: tuple[tuple[float, float], ...] = (
            speed_mps if isinstance(speed_mps, tuple) else ((0.0, speed_mps),)
        )
        how_fast = " to ".join(f"{mps:g}" for _, mps in self.speeds)
        super().__init__(
            f"{actor} drives {path.length_m if to_m is None else to_m:.0f} m at {how_fast} m/s",
            actor,
            path if to_m is None else path.part(0.0, to_m),
            limits=Limits(accelerate_mps2, brake_mps2),
            at_end=at_end,
            minds=minded(considerate=considerate, minds=minds),
        )

    def wanted_mps(self) -> float:
        """By the profile; slower towards an end at which it is to stand."""
        s_m, mps = zip(*self.speeds, strict=True)
        wanted_mps = float(np.interp(self.s_m, s_m, mps))
        if self.at_end != "hold":
            return wanted_mps
        left_m = max(0.0, self.path.length_m - self.s_m)
        slow_mps = math.sqrt(2.0 * 0.8 * self.limits.brake_mps2 * left_m)  # a fifth of the brake in hand
        return min(wanted_mps, max(slow_mps, 0.3))
