"""The base of surrogate measures of safety: the actors present in a record, and a figure of which the least decides.

`present_in` puts the scenario's things among the record's other actors, each with its name. A `Margin` has a figure for
each row of others.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from basu.errors import ScenarioError
from basu.records.history.model import NEAR_M, OTHER
from basu.scenarios.criteria.criterion import Criterion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Judgement, Played


LAST_ID = 2**32 - 1  # ids of things count down from here, where no simulator has come to yet


class Present(NamedTuple):
    """A record in which things stand among the others."""

    history: History
    names: Mapping[int, str]  # of ids: the role, or the thing's name; others have none

    def name_of(self, key: int) -> str:
        """For ``Judgement.other``: a role, a thing's name or a blueprint id."""
        return self.names.get(key, self.history.facts.actor_types.get(key, "an unknown type"))

    def described(self, key: int) -> str:
        """For a sentence."""
        kind = self.history.facts.actor_types.get(key)
        if key in self.names:
            return self.names[key] if kind is None else f"{self.names[key]} ({kind})"
        return f"{kind or 'an unknown type'} (actor {key})"

    def rows_of(self, name: str | None) -> NDArray[np.int64]:
        """Rows of the record's others: of one role or thing, or of all."""
        if name is None:
            return np.arange(len(self.history.others))
        keys = [key for key, known in self.names.items() if known == name]
        return np.flatnonzero(np.isin(self.history.others["id"], keys))


def present_in(played: Played) -> Present:
    """The record with a row for each thing in each frame in which it was as near as others are recorded.

    Things that wheels roll over have no rows and are no partners. Other things are actors without a row of their own,
    so their contacts have the same ids.
    """
    history, facts = played.history, played.history.facts
    standing = [thing for thing in played.things if not thing.rolled_over]
    low = {thing.name for thing in played.things if thing.rolled_over}
    names = {key: role for key, role in played.roles.items() if role not in low}
    sizes = dict(facts.actor_sizes)
    key_of = {name: LAST_ID - number for number, name in enumerate(dict.fromkeys(thing.name for thing in standing))}
    t_s, slack_s = history.frames["t_s"], facts.step_s / 2.0
    rows = [history.others]
    for thing in standing:
        key = key_of[thing.name]
        names[key], sizes[key] = thing.name, (thing.half_length_m, thing.half_width_m)
        away_m = np.hypot(history.frames["x_m"] - thing.x_m, history.frames["y_m"] - thing.y_m)
        there = (t_s >= thing.from_s - slack_s) & (thing.until_s is None or t_s < thing.until_s - slack_s)
        near = history.frames["tick"][there & (away_m <= NEAR_M)]
        stood = np.zeros(len(near), dtype=OTHER)
        stood["tick"], stood["id"] = near, key
        stood["x_m"], stood["y_m"], stood["yaw_rad"] = thing.x_m, thing.y_m, thing.yaw_rad
        rows.append(stood)
    together = np.concatenate(rows)
    others = together[np.argsort(together["tick"], kind="stable")]
    contacts = tuple(
        replace(event, other_id=key_of.get(played.roles.get(event.other_id, ""), event.other_id))
        for event in history.collisions
    )
    facts = replace(facts, actor_sizes=sizes)
    return Present(replace(history, others=others, collisions=contacts, facts=facts), names)


class Margin(Criterion):
    """Stays ``at_least`` away from others: vehicles, walkers and the scenario's things alike.

    ``to`` is a role or a thing's name, None for all actors; ``since`` a phase from which on it is judged. Without
    ``at_least`` it only reports. A party named by the ego's collision sensor was 0 away.
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
    def measure(self, present: Present, rows: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """(K,) the figure of each of these rows of others, inf beyond the horizon, and (K,) the frame it is of."""

    @abstractmethod
    def words(self, value: float) -> str:
        """What the least figure means, after a party's name."""

    def never(self) -> str:
        """The sentence where no actor came within the horizon."""
        return f"it never was below {self.horizon:g} {self.unit}"

    def frames(self, present: Present) -> NDArray[np.bool_]:
        """(T,) which frames count."""
        return np.ones(len(present.history.frames), dtype=np.bool_)

    def touched(self, present: Present, rows: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(K,) whether the ego's collision sensor named this party in this frame."""
        others = present.history.others[rows]
        named = {(event.tick, event.other_id) for event in present.history.collisions}
        pairs = zip(others["tick"].tolist(), others["id"].tolist(), strict=True)
        return np.array([pair in named for pair in pairs], dtype=np.bool_)

    def judge(self, played: Played) -> Judgement:
        """The frame and the party of the least figure."""
        limit = "" if self.at_least is None else f"at least {self.at_least:g} {self.unit}"
        first = played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit=self.unit, limit=limit)
        present = present_in(played)
        rows = present.rows_of(self.to)
        ticks = present.history.others["tick"][rows]
        near = rows[ticks >= first]
        rows = near[self.frames(present)[present.history.others["tick"][near]]]
        if len(near) > len(rows) == 0:
            sentence = f"the ego never moved while an actor was within {NEAR_M:g} m"
            return self.says(played, None, sentence, unit=self.unit, limit=limit)
        if len(rows) == 0:
            party = "no actor" if self.to is None else f"{self.to} never"
            return self.says(played, None, f"{party} was within {NEAR_M:g} m of the ego", unit=self.unit, limit=limit)
        touched = self.touched(present, rows)
        if touched.any():
            return self._touched(played, present, int(rows[np.argmax(touched)]), limit)
        values, ticks = self.measure(present, rows)
        return self._least(played, present, rows, values, ticks, limit)

    def _least(
        self,
        played: Played,
        present: Present,
        rows: NDArray[np.int64],
        values: NDArray[np.float64],
        ticks: NDArray[np.int64],
        limit: str,
    ) -> Judgement:
        """The judgement of the row with the least figure."""
        nearest = int(np.argmin(values))
        least = float(values[nearest])
        row = present.history.others[rows[nearest]]
        if math.isinf(least):
            passed = None if self.at_least is None else True
            return self.says(played, passed, self.never(), unit=self.unit, limit=limit)
        theirs_mps = math.hypot(float(row["velocity_x_mps"]), float(row["velocity_y_mps"]))
        key, tick = int(row["id"]), int(ticks[nearest])
        t_s = float(played.history.frames["t_s"][tick])
        return self.says(
            played,
            None if self.at_least is None else least >= self.at_least,
            f"{present.described(key)} {self.words(least)} at {t_s:.2f} s, the ego at "
            f"{float(played.history.speed_mps()[tick]):.2f} m/s and the other at {theirs_mps:.2f} m/s",
            tick=tick,
            measured=least,
            unit=self.unit,
            limit=limit,
            other=present.name_of(key),
        )

    def _touched(self, played: Played, present: Present, row: int, limit: str) -> Judgement:
        """The judgement of a contact; its speed is that of the frame before."""
        key, tick = int(present.history.others["id"][row]), int(present.history.others["tick"][row])
        before_mps = float(played.history.speed_mps()[max(0, tick - 1)])
        t_s = float(played.history.frames["t_s"][tick])
        return self.says(
            played,
            None if self.at_least is None else self.at_least <= 0.0,
            f"{present.described(key)} was touched at {t_s:.2f} s, the ego at {before_mps:.2f} m/s",
            tick=tick,
            measured=0.0,
            unit=self.unit,
            limit=limit,
            other=present.name_of(key),
        )
