"""Criteria of traffic rules: stop signs, red lights, speed limits, and needless slowness."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.red_lights import lights_passed, red_lights
from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.speeding import episodes, limits_mps
from basu.metrics.stop_signs import signs_passed, stop_signs
from basu.scenarios.criteria.criterion import Aspect, Criterion, Judgement, Played

if TYPE_CHECKING:
    from basu.metrics.infraction import Evidence


class HeedsStopSigns(Criterion):
    """The ego comes to rest before every stop sign that it passes (``basu.metrics.stop_signs``)."""

    name = "heeds stop signs"

    def judge(self, played: Played) -> Judgement:
        """The figure is how slow it got before the sign that decided."""
        passed, run = signs_passed(played.history), stop_signs(played.history)
        limit = "below 0.1 m/s before the line"
        if run:
            slowest_mps = next(sign.lowest_speed_mps for sign in passed if not sign.stopped)
            return _broken(self, played, run, measured=slowest_mps, limit=limit)
        if not passed:
            return self.says(played, None, "it passed no stop sign", unit="m/s", limit=limit)
        said = [f"stop sign {sign.sign.landmark_id}, {sign.front_to_line_m:.1f} m before its line" for sign in passed]
        fastest = max(passed, key=lambda sign: sign.lowest_speed_mps)
        return self.says(
            played,
            True,
            f"it stopped at {' and at '.join(said)}",
            tick=fastest.tick,
            measured=fastest.lowest_speed_mps,
            unit="m/s",
            limit=limit,
            other=f"stop sign {fastest.sign.landmark_id}",
        )


class HeedsRedLights(Criterion):
    """The ego's rear crosses no light's line on red (``basu.metrics.red_lights``, the leaderboard's rule)."""

    name = "heeds red lights"

    def judge(self, played: Played) -> Judgement:
        """The figure is the speed over the line."""
        passed, run = lights_passed(played.history), red_lights(played.history)
        if run:
            return _broken(self, played, run, measured=run[0].speed_mps, limit="not on red")
        if not passed:
            return self.says(played, None, "it passed no traffic light", unit="m/s", limit="not on red")
        said = [f"{light.light.landmark_id} on {light.state}" for light in passed]
        last = passed[-1]
        return self.says(
            played,
            True,
            f"it passed traffic light {' and '.join(said)}",
            tick=last.tick,
            measured=last.speed_mps,
            unit="m/s",
            limit="not on red",
            other=f"traffic light {last.light.landmark_id}",
        )


def _broken(
    criterion: Criterion, played: Played, run: tuple[Evidence, ...], *, measured: float, limit: str
) -> Judgement:
    """The first one decides, and the sentence names all."""
    return criterion.says(
        played,
        False,
        "; ".join(f"it {found.detail} at {found.t_s:.2f} s" for found in run),
        tick=run[0].tick,
        measured=measured,
        unit="m/s",
        limit=limit,
        other=run[0].other,
    )


class KeepsSpeed(Criterion):
    """The ego is never more than ``tolerance_mps`` above the limit for half a second or longer.

    The limit is the posted one (``basu.metrics.speeding``), or ``limit_mps``. ``since`` is a phase from which on it is
    judged.
    """

    name = "keeps speed"

    def __init__(
        self,
        tolerance_mps: float = TOLERANCE_MPS,
        *,
        limit_mps: float | None = None,
        since: str | None = None,
        deciding: bool = True,
    ) -> None:
        super().__init__(deciding=deciding)
        self.tolerance_mps, self.limit_mps, self.since = tolerance_mps, limit_mps, since

    def judge(self, played: Played) -> Judgement:
        """The figure is the speed where the excess was largest."""
        history, first = played.history, played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m/s")
        speed_mps = history.speed_mps()
        limits = limits_mps(history) if self.limit_mps is None else np.full(len(speed_mps), self.limit_mps)
        if np.isinf(limits[first:]).all():
            return self.says(played, None, "no limit was posted anywhere on its way", unit="m/s")
        excess_mps = speed_mps - limits
        found = [
            (first + pieces[0].first, first + pieces[-1].end)
            for pieces in episodes(speed_mps[first:], limits[first:], self.tolerance_mps, history.facts.step_s)
        ]
        begin, end = max(found, key=lambda span: excess_mps[span[0] : span[1]].max(), default=(first, len(speed_mps)))
        fastest = begin + int(np.argmax(excess_mps[begin:end]))
        seconds = (end - begin) * history.facts.step_s
        how_long = f", for {seconds:.1f} s" if found else ""
        times = f"; {len(found)} times in all" if len(found) > 1 else ""
        return self.says(
            played,
            not found,
            f"it drove up to {speed_mps[fastest]:.2f} m/s where {limits[fastest]:.2f} m/s are allowed, at "
            f"{float(history.frames['t_s'][fastest]):.2f} s{how_long}{times}",
            tick=fastest,
            measured=float(speed_mps[fastest]),
            unit="m/s",
            limit=f"at most {limits[fastest] + self.tolerance_mps:.2f} m/s",
        )


class MinimumSpeed(Criterion):
    """The ego's mean speed from a phase on (``since``, None: from the first frame) is at least ``least_mps``.

    For scenarios in which nothing is in the way: creeping through them shows no ability to drive.
    """

    aspect = Aspect.COMPLETED
    name = "minimum speed"

    def __init__(self, least_mps: float, *, since: str | None = None, deciding: bool = True) -> None:
        super().__init__(deciding=deciding)
        self.least_mps, self.since = least_mps, since

    def judge(self, played: Played) -> Judgement:
        """The figure is the mean."""
        limit, first = f"at least {self.least_mps:g} m/s", played.first_tick(self.since)
        if first is None:
            return self.says(played, None, f"'{self.since}' never began", unit="m/s", limit=limit)
        speed_mps = played.history.speed_mps()[first:]
        mean_mps, seconds = float(speed_mps.mean()), len(speed_mps) * played.history.facts.step_s
        slowest = first + int(np.argmin(speed_mps))
        return self.says(
            played,
            mean_mps >= self.least_mps,
            f"it drove {mean_mps:.2f} m/s in the mean of {seconds:.1f} s, {float(speed_mps.min()):.2f} m/s at least",
            tick=slowest,
            measured=mean_mps,
            unit="m/s",
            limit=limit,
        )
