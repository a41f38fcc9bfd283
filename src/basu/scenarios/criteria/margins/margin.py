"""What all margins share: a figure for each row of others, the least of which decides."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from basu.errors import ScenarioError
from basu.records.history.model import NEAR_M
from basu.scenarios.criteria.criterion import Criterion
from basu.scenarios.criteria.margins.company import company

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.scenarios.criteria.criterion import Judgement, Played
    from basu.scenarios.criteria.margins.company import Company


class Margin(Criterion):
    """Stays ``at_least`` away from others: vehicles, walkers and the scenario's things alike.

    ``to`` is a role or a thing's name, None for everybody; ``since`` a phase from which on it is judged. Without
    ``at_least`` it only tells. Whom the ego's collision sensor named was 0 away.
    """

    called: ClassVar[str]
    unit: ClassVar[str]
    horizon: ClassVar[float] = math.inf  # beyond this nothing is measured

    def __init__(
        self,
        at_least: float | None = None,
        *,
        to: str | None = None,
        since: str | None = None,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding and at_least is not None)
        if at_least is not None and not 0.0 <= at_least <= self.horizon:
            raise ScenarioError(
                f"the {self.called} cannot be held against {at_least:g} {self.unit}: it is measured from 0 to "
                f"{self.horizon:g} {self.unit}"
            )
        self.name = self.called if to is None else f"{self.called} to {to}"
        self.at_least, self.to, self.since = at_least, to, since

    @abstractmethod
    def measure(self, with_whom: Company, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """(K,) the figure of each of these rows of others, inf beyond the horizon, and (K,) the frame it is of."""

    @abstractmethod
    def words(self, value: float) -> str:
        """What the least figure means, after a party's name."""

    def never(self) -> str:
        """What is said where nobody came within the horizon."""
        return f"it never was below {self.horizon:g} {self.unit}"

    def frames(self, with_whom: Company) -> NDArray[np.bool_]:
        """(T,) which frames count."""
        return np.ones(len(with_whom.history.frames), dtype=np.bool_)

    def touched(self, with_whom: Company, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(K,) whether the ego's collision sensor named this party in this frame."""
        others = with_whom.history.others[rows]
        named = {(event.tick, event.other_id) for event in with_whom.history.collisions}
        pairs = zip(others["tick"].tolist(), others["id"].tolist(), strict=True)
        return np.array([pair in named for pair in pairs], dtype=np.bool_)

    def judge(self, played: Played) -> Judgement:
        """The frame and the party of the least figure."""
        limit = "" if self.at_least is None else f"at least {self.at_least:g} {self.unit}"
        first = played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit=self.unit, limit=limit)
        with_whom = company(played)
        rows = with_whom.rows_of(self.to)
        ticks = with_whom.history.others["tick"][rows]
        rows = rows[(ticks >= first) & self.frames(with_whom)[ticks]]
        if len(rows) == 0:
            who = "nobody" if self.to is None else f"{self.to} never"
            return self.says(played, None, f"{who} was within {NEAR_M:g} m of the ego", unit=self.unit, limit=limit)
        touched = self.touched(with_whom, rows)
        if touched.any():
            return self._touched(played, with_whom, int(rows[np.argmax(touched)]), limit)
        values, ticks = self.measure(with_whom, rows)
        return self._least(played, with_whom, rows, values, ticks, limit)

    def _least(
        self,
        played: Played,
        with_whom: Company,
        rows: NDArray[np.int64],
        values: NDArray[np.float64],
        ticks: NDArray[np.int64],
        limit: str,
    ) -> Judgement:
        """The judgement of the row with the least figure."""
        nearest = int(np.argmin(values))
        least = float(values[nearest])
        row = with_whom.history.others[rows[nearest]]
        if math.isinf(least):
            passed = None if self.at_least is None else True
            return self.says(played, passed, self.never(), unit=self.unit, limit=limit)
        theirs_mps = math.hypot(float(row["velocity_x_mps"]), float(row["velocity_y_mps"]))
        key, tick = int(row["id"]), int(ticks[nearest])
        t_s = float(played.history.frames["t_s"][tick])
        return self.says(
            played,
            None if self.at_least is None else least >= self.at_least,
            f"{with_whom.told(key)} {self.words(least)} at {t_s:.2f} s, the ego at "
            f"{float(played.history.speed_mps()[tick]):.2f} m/s and the other at {theirs_mps:.2f} m/s",
            tick=tick,
            measured=least,
            unit=self.unit,
            limit=limit,
            other=with_whom.called(key),
        )

    def _touched(self, played: Played, with_whom: Company, row: int, limit: str) -> Judgement:
        """The judgement of a contact; the speed told is that of the frame before."""
        key, tick = int(with_whom.history.others["id"][row]), int(with_whom.history.others["tick"][row])
        before_mps = float(played.history.speed_mps()[max(0, tick - 1)])
        t_s = float(played.history.frames["t_s"][tick])
        return self.says(
            played,
            None if self.at_least is None else self.at_least <= 0.0,
            f"{with_whom.told(key)} was touched at {t_s:.2f} s, the ego at {before_mps:.2f} m/s",
            tick=tick,
            measured=0.0,
            unit=self.unit,
            limit=limit,
            other=with_whom.called(key),
        )
