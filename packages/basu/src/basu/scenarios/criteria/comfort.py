"""Gentle: what standing passengers felt of it, by the measures of ``basu.metrics.passengers``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.causes import StopCause, cause
from basu.metrics.passengers.felt import felt
from basu.metrics.passengers.harsh_stops import HARSH_MPS2, harsh_stops
from basu.scenarios.criteria.criterion import Criterion
from basu.scenarios.criteria.margin import present_in

if TYPE_CHECKING:
    from basu.metrics.passengers.felt import Felt
    from basu.scenarios.criteria.criterion import Judgement, Played


class Gentle(Criterion):
    """No braking is felt with ``harsh_mps2`` or more where one stands.

    With ``phantom_only`` only stops count for which nothing in the record was a reason: no line, no stop, no bend,
    no actor and no thing of the scenario's ahead. ``since`` is a phase from which on it is judged.
    """

    def __init__(
        self,
        harsh_mps2: float = HARSH_MPS2,
        *,
        phantom_only: bool = False,
        since: str | None = None,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding)
        self.name = "no phantom stop" if phantom_only else "gentle"
        self.harsh_mps2, self.phantom_only, self.since = harsh_mps2, phantom_only, since

    def judge(self, played: Played) -> Judgement:
        """The figure is the hardest braking felt."""
        limit, first = f"below {self.harsh_mps2:g} m/s²", played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m/s²", limit=limit)
        sensed = felt(played.history)
        if sensed is None:
            return self.says(played, None, "the drive was too short to feel anything", unit="m/s²", limit=limit)
        record = present_in(played).history
        stops = [(s, cause(record, s)) for s in harsh_stops(sensed, self.harsh_mps2) if s.tick >= first]
        counting = [(s, why) for s, why in stops if why.kind is StopCause.NOTHING or not self.phantom_only]
        if not counting:
            return self._calm(played, sensed, first, limit, caused=len(stops))
        worst, _ = max(counting, key=lambda found: found[0].strongest_mps2)
        said = [
            f"{'phantom' if why.kind is StopCause.NOTHING else 'harsh'} stop at {s.t_s:.2f} s from {s.from_mps:.2f} to "
            f"{s.to_mps:.2f} m/s, up to {s.strongest_mps2:.2f} m/s² and {s.jerk_mps3:.1f} m/s³: {why.detail}"
            for s, why in counting
        ]
        return self.says(
            played,
            False,
            "; ".join(said),
            tick=worst.tick,
            measured=worst.strongest_mps2,
            unit="m/s²",
            limit=limit,
        )

    def _calm(self, played: Played, sensed: Felt, first: int, limit: str, *, caused: int) -> Judgement:
        """Nothing counted: the hardest braking all the same."""
        braking_mps2 = -sensed.filtered_along_mps2 * np.where(sensed.speed_mps < 0.0, -1.0, 1.0)
        worst = first + int(np.argmax(braking_mps2[first:]))
        hardest_mps2 = max(0.0, float(braking_mps2[worst]))
        jerk_mps3 = float(np.abs(sensed.jerk_along_mps3[first:]).max())
        sentence = (
            f"the hardest braking felt was {hardest_mps2:.2f} m/s² at {float(sensed.t_s[worst]):.2f} s, "
            f"the largest jerk {jerk_mps3:.1f} m/s³"
        )
        if caused:
            sentence += f"; {caused} harsh stop{'s' if caused > 1 else ''} had a cause"
        return self.says(played, True, sentence, tick=worst, measured=hardest_mps2, unit="m/s²", limit=limit)
