"""`JudgedSteps`: observation, reward, end and info of each step of one vehicle, for the environments."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from basu.gym_spaces import FAILED, JUDGED_TICKS, TRUNCATED, Preview
from basu.managers.scenario_results import results_of
from basu.metrics.success import success, success_of_verdict
from basu.outcome import Status

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from basu.episode import Episode, Observation, VehicleUnderTest
    from basu.gym_spaces import Reward
    from basu.metrics.infraction import Evidence
    from basu.outcome import Outcome


class JudgedSteps:
    """The steps of a vehicle in one drive."""

    def __init__(self, episode: Episode, vehicle: VehicleUnderTest, reward: Reward) -> None:
        """Begin with the first frame of the drive."""
        self._episode, self._vehicle, self._reward = episode, vehicle, reward
        self._preview = Preview(vehicle)
        self._driven_m = vehicle.observation.driven_m
        self._infractions = 0

    def first(self) -> tuple[dict[str, NDArray[np.float32]], dict[str, Any]]:
        """Return observation and info before the first step."""
        seen = self._vehicle.observation
        return self._preview.of(seen), {"route_s_m": seen.progress.s_m, "infractions": ()}

    def next(self) -> tuple[dict[str, NDArray[np.float32]], float, bool, bool, dict[str, Any]]:
        """Return observation, reward, terminated, truncated and info after a step."""
        vehicle = self._vehicle
        seen, outcome = vehicle.observation, vehicle.outcome
        new: tuple[Evidence, ...] = ()
        if outcome is not None or seen.frame.tick % JUDGED_TICKS == 0:
            found = vehicle.metrics.infractions_so_far()
            new, self._infractions = found[self._infractions :], len(found)
        parts = self._parts(seen, len(new), outcome)
        self._driven_m = seen.driven_m
        info: dict[str, Any] = {"route_s_m": seen.progress.s_m, "infractions": new, "reward_parts": parts}
        if outcome is not None:
            info |= {"outcome": outcome.status.value, "message": outcome.message, **self._success(outcome, found)}
        truncated = outcome is not None and outcome.status in TRUNCATED
        terminated = outcome is not None and not truncated
        return self._preview.of(seen), sum(parts.values()), terminated, truncated, info

    def _success(self, outcome: Outcome, found: Sequence[Evidence]) -> dict[str, Any]:
        """Return whether the drive passed, by the rule of all runs, with the reasons."""
        history = self._vehicle.metrics.history()
        playing = self._episode.playing if self._vehicle is self._episode.vehicle else ()
        if self._episode.is_case:
            judged = playing[0].judged(history, outcome)
            said = success_of_verdict(judged.verdict.value, judged.message)
        else:
            said = success(outcome, history, found, results_of(playing, history, outcome))
        return said._asdict()

    def _parts(self, seen: Observation, infractions: int, outcome: Outcome | None) -> dict[str, float]:
        """Return the parts of a step's reward, by the names of `Reward`'s fields."""
        status, ego = None if outcome is None else outcome.status, seen.frame.ego
        return self._reward.parts(
            driven_m=seen.driven_m - self._driven_m,
            infractions=infractions,
            arrived=status is Status.COMPLETED,
            failed=status in FAILED,
            push_mps2=math.hypot(ego.acceleration_x_mps2, ego.acceleration_y_mps2),
            lateral_m=seen.progress.lateral_m,
        )
