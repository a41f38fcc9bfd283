"""Drive along a path, at a speed or by a profile of speeds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.scenarios.actions.puppet import AtEnd, Limits, Puppet, minded

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.scenarios.paths import Path

Speeds = float | tuple[tuple[float, float], ...]  # m/s; or (m along the path, m/s) pairs, linear between them
COMFORT = 0.8  # of the brake is used for what is known beforehand


def bend_speeds_mps(path: Path, sideways_mps2: float, brake_mps2: float) -> NDArray[np.float64]:
    """(N,) the speeds at a path's points at which its bends throw outwards by no more, braked for beforehand.

    The curvature is taken over 4 m, as a lane's points have kinks that no vehicle follows.
    """
    ahead_m, behind_m = np.minimum(path.s_m + 2.0, path.length_m), np.maximum(path.s_m - 2.0, 0.0)
    turned_rad = np.interp(ahead_m, path.s_m, path.yaw_rad) - np.interp(behind_m, path.s_m, path.yaw_rad)
    curvature = np.abs(turned_rad) / (ahead_m - behind_m)
    speeds_mps: NDArray[np.float64] = np.sqrt(sideways_mps2 / np.maximum(curvature, 1e-4))
    for index in range(len(speeds_mps) - 2, -1, -1):
        step_m = float(path.s_m[index + 1] - path.s_m[index])
        speeds_mps[index] = min(speeds_mps[index], math.sqrt(speeds_mps[index + 1] ** 2 + 2.0 * brake_mps2 * step_m))
    return speeds_mps


class DriveAlong(Puppet):
    """Lead a vehicle along a path.

    ``considerate`` makes it brake for the ego where that is ahead on its path, ``minds`` for others by name.
    ``at_end``: "hold" brakes to stand at the end of the path, "go on" leaves it rolling straight on, "vanish" takes
    it out of the world. ``to_m`` ends it before the end of the path. ``bends_mps2`` makes it slow down before bends,
    so that it is not thrown outwards by more.
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
        bends_mps2: float = math.inf,
    ) -> None:
        self.bends_mps2 = bends_mps2
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

    def begin(self) -> None:
        """Look at the bends ahead."""
        super().begin()
        self.bend_mps: NDArray[np.float64] | None = None
        if math.isfinite(self.bends_mps2):
            self.bend_mps = bend_speeds_mps(self.path, self.bends_mps2, COMFORT * self.limits.brake_mps2)

    def wanted_mps(self) -> float:
        """By the profile; slower in bends, and towards an end at which it is to stand."""
        s_m, mps = zip(*self.speeds, strict=True)
        wanted_mps = float(np.interp(self.s_m, s_m, mps))
        if self.bend_mps is not None:
            wanted_mps = min(wanted_mps, float(np.interp(self.s_m, self.path.s_m, self.bend_mps)))
        if self.at_end != "hold":
            return wanted_mps
        left_m = max(0.0, self.path.length_m - self.s_m)
        slow_mps = math.sqrt(2.0 * COMFORT * self.limits.brake_mps2 * left_m)
        return min(wanted_mps, max(slow_mps, 0.3))
