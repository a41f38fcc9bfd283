"""Everybody the ego could meet: the record's others and the scenario's things alike, and what each is called."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.records.history.model import NEAR_M, OTHER

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Played

LAST_ID = 2**32 - 1  # ids of things count down from here, where no simulator has come to yet


class Company(NamedTuple):
    """A record in which things stand among the others."""

    history: History
    names: Mapping[int, str]  # of ids: the role, or the thing's name; others have none

    def called(self, key: int) -> str:
        """For ``Judgement.other``: a role, a thing's name or a blueprint id."""
        return self.names.get(key, self.history.facts.actor_types.get(key, "somebody"))

    def told(self, key: int) -> str:
        """For a sentence."""
        kind = self.history.facts.actor_types.get(key)
        if key in self.names:
            return self.names[key] if kind is None else f"{self.names[key]} ({kind})"
        return f"{kind or 'somebody'} (actor {key})"

    def rows_of(self, name: str | None) -> NDArray[np.int64]:
        """Rows of the record's others: of one role or thing, or of everybody."""
        if name is None:
            return np.arange(len(self.history.others))
        keys = [key for key, known in self.names.items() if known == name]
        return np.flatnonzero(np.isin(self.history.others["id"], keys))


def company(played: Played) -> Company:
    """The record with a row for each thing in each frame in which it was as near as others are recorded.

    Things are actors without a row of their own, so contacts with them are told under the same ids.
    """
    history, facts = played.history, played.history.facts
    names, sizes = dict(played.roles), dict(facts.actor_sizes)
    key_of = {name: LAST_ID - number for number, name in enumerate(dict.fromkeys(t.name for t in played.things))}
    t_s, slack_s = history.frames["t_s"], facts.step_s / 2.0
    rows = [history.others]
    for thing in played.things:
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
    return Company(replace(history, others=others, collisions=contacts, facts=facts), names)
