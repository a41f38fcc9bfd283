"""Least distance: how near the ego's box came to that of anybody else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.passengers.boxes import other_boxes, own_boxes
from basu.scenarios.criteria.criterion import Criterion
from basu.scenarios.criteria.margins.company import company
from basu.scenarios.criteria.margins.gap import gap_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.criterion import Judgement, Played
    from basu.scenarios.criteria.margins.company import Company

MOVING_MPS = 0.1


class LeastDistance(Criterion):
    """The ego's box stays ``at_least_m`` away from others', vehicles, walkers and the scenario's things alike.

    ``to`` is a role or a thing's name, None for everybody; ``since`` a phase. With ``while_moving`` only frames count
    in which the ego moved: who comes close to a vehicle at rest has done so alone. Without ``at_least_m`` it only
    tells. Whom the ego's collision sensor named was 0 m away.
    """

    def __init__(
        self,
        at_least_m: float | None = None,
        *,
        to: str | None = None,
        since: str | None = None,
        while_moving: bool = False,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding and at_least_m is not None)
        self.name = "least distance" if to is None else f"least distance to {to}"
        self.at_least_m, self.to, self.since, self.while_moving = at_least_m, to, since, while_moving

    def judge(self, played: Played) -> Judgement:
        """The frame and the party of the least distance."""
        limit = "" if self.at_least_m is None else f"at least {self.at_least_m:g} m"
        first = played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m", limit=limit)
        with_whom = company(played)
        rows, away_m = self._distances(with_whom, first)
        if len(rows) == 0:
            who = "nobody" if self.to is None else f"'{self.to}' never"
            return self.says(played, None, f"{who} was within 60 m of the ego", unit="m", limit=limit)
        nearest = int(np.argmin(away_m))
        row, least_m = with_whom.history.others[rows[nearest]], float(away_m[nearest])
        key, tick = int(row["id"]), int(row["tick"])
        speed_mps = float(played.history.speed_mps()[tick])
        t_s = float(played.history.frames["t_s"][tick])
        sentence = (
            f"{with_whom.told(key)} was {least_m:.2f} m away at {t_s:.2f} s, the ego at {speed_mps:.2f} m/s, "
            f"the other at {float(np.hypot(row['velocity_x_mps'], row['velocity_y_mps'])):.2f} m/s"
        )
        return self.says(
            played,
            None if self.at_least_m is None else least_m >= self.at_least_m,
            sentence,
            tick=tick,
            measured=least_m,
            unit="m",
            limit=limit,
            other=with_whom.called(key),
        )

    def _distances(self, with_whom: Company, first: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Rows of others to be looked at, and how far away each was."""
        history = with_whom.history
        rows = with_whom.rows_of(self.to)
        rows = rows[history.others["tick"][rows] >= first]
        if self.while_moving:
            rows = rows[history.speed_mps()[history.others["tick"][rows]] > MOVING_MPS]
        others = history.others[rows]
        own = own_boxes(history.facts, history.frames)[others["tick"]]
        away_m = gap_m(own, other_boxes(history.facts, others))
        touched = {(event.tick, event.other_id) for event in history.collisions}
        in_contact = [pair in touched for pair in zip(others["tick"].tolist(), others["id"].tolist(), strict=True)]
        return rows, np.where(np.array(in_contact, dtype=np.bool_), 0.0, away_m)
