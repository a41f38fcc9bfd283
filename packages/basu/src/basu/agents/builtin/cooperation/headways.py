"""Headway control against bunching: a vehicle holds at a stop while the one ahead is nearer than the one behind.

Each vehicle tells when it left its latest stops: `LEFT STOP AGO STOP AGO …`, times in s. From that and the time of a
round each vehicle reckons how long ago its leader left this stop and when its follower will. It holds for a part of
half the difference. Both gaps count, as in C. F. Daganzo and J. Pilachowski 2011, "Reducing bunching with bus-to-bus
cooperation", Transportation Research Part B 45(1), 267-277, which controls speeds by both spacings. Holding at stops
without a timetable is as in J. J. Bartholdi and D. D. Eisenstein 2012, "A self-coordinating bus route to resist bus
bunching", Part B 46(4), 481-491. Radios need not reach over the whole route: what was heard last is moved on by the
time of a round.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.agents.autonomous_agent import LONGEST_TEXT_BYTES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

HEAD = "LEFT"
GAIN = 0.8  # of half the difference of both gaps
LONGEST_HOLD_S = 60.0
MEAN_MPS, MEAN_STOP_S = 5.0, 15.0  # of a shuttle between stops, and at one: until a round was driven
OLDEST_S = 3600.0


class Headways:
    """One vehicle's view of a round and of the others on it."""

    def __init__(self, places_m: Mapping[str, float], round_m: float) -> None:
        """Take each stop's place along a round."""
        self._places_m, self._round_m = dict(places_m), round_m
        self._round_s = round_m / MEAN_MPS + MEAN_STOP_S * len(places_m)
        self._own_s: dict[str, float] = {}  # when this vehicle left each stop last
        self._others: dict[str, tuple[str, float]] = {}  # by sender: stop and time of its latest departure

    def left(self, stop_id: str, now_s: float) -> None:
        """Note that this vehicle has left a stop; a round that was driven tells the time of a round."""
        if stop_id in self._own_s:
            self._round_s = now_s - self._own_s[stop_id]
        self._own_s[stop_id] = now_s

    def text(self, now_s: float) -> str | None:
        """Return what this vehicle tells; None before it has left a stop."""
        latest = sorted(self._own_s.items(), key=lambda each: -each[1])
        text = HEAD
        for stop_id, left_s in latest:
            more = f"{text} {stop_id} {now_s - left_s:.0f}"
            if len(more.encode()) > LONGEST_TEXT_BYTES:
                break
            text = more
        return None if text == HEAD else text

    def hear(self, texts: Sequence[tuple[str, str]], now_s: float) -> None:
        """Take in texts, each with its sender; the first stop that the round has is the latest one."""
        for sender, text in texts:
            words = text.split()
            if words[:1] != [HEAD]:
                continue
            told = zip(words[1::2], words[2::2], strict=False)
            known = [each for each in told if each[0] in self._places_m]
            try:
                stop_id, ago_s = known[0][0], float(known[0][1])
            except (IndexError, ValueError):
                continue
            if 0.0 <= ago_s <= OLDEST_S:
                self._others[sender] = stop_id, now_s - ago_s

    def gaps_s(self, stop_id: str, at_s: float) -> tuple[float, float] | None:
        """Return the time since the leader left a stop and until the follower leaves it, both seen from ``at_s``.

        None while no other vehicle was heard, or where the round has no such stop.
        """
        if stop_id not in self._places_m or not self._others:
            return None
        since_s = [
            math.fmod(at_s - left_s - self._way_s(other, stop_id), self._round_s) % self._round_s
            for other, left_s in self._others.values()
        ]
        return min(since_s), self._round_s - max(since_s)

    def hold_s(self, stop_id: str, at_s: float) -> float:
        """Return for how long this vehicle holds at a stop that it could leave at ``at_s``."""
        gaps_s = self.gaps_s(stop_id, at_s)
        if gaps_s is None:
            return 0.0
        ahead_s, behind_s = gaps_s
        return min(max(0.0, GAIN * 0.5 * (behind_s - ahead_s)), LONGEST_HOLD_S)

    def _way_s(self, from_id: str, to_id: str) -> float:
        """Return the time of the way from leaving one stop to leaving another one."""
        way_m = (self._places_m[to_id] - self._places_m[from_id]) % self._round_m
        return self._round_s * way_m / self._round_m
