"""Heeding stop signs and red lights: the rules of ``basu.metrics``, for the signs and lights that were passed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.metrics.red_lights import lights_passed, red_lights
from basu.metrics.stop_signs import signs_passed, stop_signs
from basu.scenarios.criteria.criterion import Criterion

if TYPE_CHECKING:
    from basu.metrics.infraction import Evidence
    from basu.scenarios.criteria.criterion import Judgement, Played


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
    """The first one decides, and all are told."""
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
