"""The check that the conflict of a scenario came about, from the record alone.

A conflict partner is an actor or object of the scenario that the ego must avoid. The conflict came about where one of
these holds after the phase "conflict" began:

- The ego touched a partner.
- The moving ego came within `INTERACTION_TTC_S` of a collision with a partner.
- The ego would have met a partner, had it driven on unimpeded (`basu.scenarios.continuations`).

An ego that never moved has no continuation, and one that crawled meets only what crossed its path within its own slow
reach. So a driver that is absent from a conflict has not exercised it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes
from basu.metrics.passengers.near_misses import times_to_collision_s
from basu.scenarios.continuations import continuations, meeting
from basu.scenarios.criteria.margin import present_in
from basu.thresholds import IN_MOTION_MPS

if TYPE_CHECKING:
    from collections.abc import Collection

    from basu.scenarios.criteria.criterion import Played
    from basu.scenarios.criteria.margin import Present

INTERACTION_TTC_S = 2.0  # somewhat above the 1.5 s that FHWA-HRT-08-051 calls a conflict
EFFECT_MPS = 2.5  # a disturbance of the ego's own driving is felt from this speed on
MOVED_M = 0.5  # an actor that got so far from its first place moves


class Finding(NamedTuple):
    """One of the three answers of the policy. ``holds`` is None where it could not be judged."""

    holds: bool | None
    sentence: str


def came_about(played: Played, partners: Collection[str] | None = None) -> Finding:
    """Whether the ego met the conflict.

    ``partners`` are roles and names of things; None means the scenario's actors that moved, or all where none moved.
    """
    first = played.first_tick("conflict")
    if first is None:
        return Finding(False, "the conflict never began")
    present = present_in(played)
    keys = _partner_keys(present, partners)
    if not keys:
        return effect_felt(played)
    found = _touched(present, keys) or _nearly_collided(present, keys, first) or _would_have_met(present, keys, first)
    return found or Finding(False, _apart(present, keys, first))


def effect_felt(played: Played, at_least_mps: float = EFFECT_MPS) -> Finding:
    """Find whether the ego drove when the conflict began; for scenarios that disturb the ego without a partner."""
    first = played.first_tick("conflict")
    if first is None:
        return Finding(False, "the conflict never began")
    speed_mps = float(played.history.speed_mps()[first])
    at_s = float(played.history.frames["t_s"][first])
    sentence = f"the ego had {speed_mps:.2f} m/s at {at_s:.2f} s, when the conflict began"
    return Finding(speed_mps >= at_least_mps, f"{sentence}; {at_least_mps:g} m/s are needed")


def _partner_keys(present: Present, partners: Collection[str] | None) -> list[int]:
    """Ids of the partners in the record."""
    others = present.history.others
    if partners is not None:
        return [key for key, name in present.names.items() if name in partners]
    moved = []
    for key in present.names:
        rows = others[others["id"] == key]
        if len(rows) and np.hypot(rows["x_m"] - rows["x_m"][0], rows["y_m"] - rows["y_m"][0]).max() >= MOVED_M:
            moved.append(key)
    return moved or list(present.names)


def _touched(present: Present, keys: list[int]) -> Finding | None:
    """The first contact with a partner."""
    for event in present.history.collisions:
        if event.other_id in keys:
            at_s = float(present.history.frames["t_s"][event.tick])
            return Finding(True, f"the ego touched {present.described(event.other_id)} at {at_s:.2f} s")
    return None


def _nearly_collided(present: Present, keys: list[int], first: int) -> Finding | None:
    """The least time to collision with a partner while the ego moved, where it is short."""
    history = present.history
    others = history.others
    rows = np.flatnonzero(
        np.isin(others["id"], keys) & (others["tick"] >= first) & (history.speed_mps()[others["tick"]] > IN_MOTION_MPS)
    )
    if len(rows) == 0:
        return None
    own, theirs = own_boxes(history.facts, history.frames), other_boxes(history.facts, others)
    ttc_s = times_to_collision_s(history, own, theirs, INTERACTION_TTC_S)[rows]
    least = int(np.argmin(ttc_s))
    if ttc_s[least] > INTERACTION_TTC_S:
        return None
    row = others[rows[least]]
    at_s = float(history.frames["t_s"][row["tick"]])
    return Finding(
        True,
        f"{present.described(int(row['id']))} was {ttc_s[least]:.2f} s from a collision with the ego at {at_s:.2f} s",
    )


def _would_have_met(present: Present, keys: list[int], first: int) -> Finding | None:
    """The first continuation of the ego that meets a partner."""
    history = present.history
    driven = continuations(history, first)
    if driven is None:
        return None
    for key in keys:
        met = meeting(history, driven, key)
        if met is not None:
            start, in_s, speed_mps = met
            at_s = float(history.frames["t_s"][start])
            return Finding(
                True,
                f"driving on unimpeded from {at_s:.2f} s, the ego would have met {present.described(key)} within "
                f"{in_s:.2f} s, at {speed_mps:.2f} m/s",
            )
    return None


def _apart(present: Present, keys: list[int], first: int) -> str:
    """Why the conflict did not come about: how far away the nearest partner was."""
    history = present.history
    rows = history.others[np.isin(history.others["id"], keys) & (history.others["tick"] >= first)]
    top_mps = float(history.speed_mps().max())
    if len(rows) == 0:
        return "no conflict partner was near the ego after the conflict began"
    frames = history.frames[rows["tick"]]
    away_m = np.hypot(rows["x_m"] - frames["x_m"], rows["y_m"] - frames["y_m"])
    nearest = int(np.argmin(away_m))
    at_s = float(frames["t_s"][nearest])
    drove = (
        "the ego never moved" if top_mps <= IN_MOTION_MPS else f"the ego, at most {top_mps:.2f} m/s fast, met no actor"
    )
    return (
        f"{drove} and would have met none, had it driven on: the nearest conflict partner, "
        f"{present.described(int(rows['id'][nearest]))}, was {away_m[nearest]:.1f} m away at {at_s:.2f} s"
    )
