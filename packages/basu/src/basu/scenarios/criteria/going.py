"""Criteria of progress: arrival at the route's end, a place or point reached, and completion within a time limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics import path_following
from basu.metrics.validity import validity
from basu.outcome import Status
from basu.scenarios.criteria.criterion import Aspect, Criterion
from basu.scenarios.triggers.along_route import SLACK_M, SLACK_MPS

if TYPE_CHECKING:
    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Judgement, Played


def arrival_tick(history: History) -> int | None:
    """The first frame in which the ego has arrived, with the slack of `EgoArrives`; None where it never has."""
    return path_following.arrival_tick(history, slack_m=SLACK_M, slack_mps=SLACK_MPS)


class Arrives(Criterion):
    """The ego drives its route to the end: within 2 m of it, or to rest within 5 m (`basu.metrics.validity`)."""

    aspect = Aspect.COMPLETED
    name = "arrives"

    def judge(self, played: Played) -> Judgement:
        """The figure is how far it got along its route."""
        history = played.history
        length_m, tick = history.facts.route.length_m, arrival_tick(history)
        limit = f"{length_m:.0f} m"
        if tick is not None:
            took_s = float(history.frames["t_s"][tick] - history.frames["t_s"][0])
            sentence = f"it arrived after {took_s:.2f} s"
            return self.says(played, True, sentence, tick=tick, measured=length_m, unit="m", limit=limit)
        farthest = int(np.argmax(history.frames["route_s_m"]))
        got_m = validity(history).reached_m
        sentence = f"it got to {got_m:.1f} m of {length_m:.1f} m{_off_route(history)}: {played.outcome.message}"
        return self.says(played, False, sentence, tick=farthest, measured=got_m, unit="m", limit=limit)


def _off_route(history: History) -> str:
    """How the ego left its route for good, in words; empty where it did not."""
    found = validity(history)
    if found.gaps:
        gap = found.gaps[0]
        at_s = float(history.frames["t_s"][gap.tick])
        return f", left its route there and was back at {gap.to_s_m:.1f} m, at {at_s:.2f} s"
    if len(found.valid) and not found.valid[-1]:
        return f", and was {found.checks[-1].sentence} at the end"
    return ""


class Reaches(Criterion):
    """The ego's origin drives along its route to a place, ``s_m`` from the route's beginning."""

    aspect = Aspect.COMPLETED

    def __init__(self, s_m: float, what: str = "", *, deciding: bool = True) -> None:
        super().__init__(deciding=deciding)
        self.s_m, self.what = s_m, what or f"{s_m:.0f} m of the route"
        self.name = f"reaches {self.what}"

    def judge(self, played: Played) -> Judgement:
        """The figure is how far it got along its route."""
        frames, found = played.history.frames, validity(played.history)
        beyond = (frames["route_s_m"] >= self.s_m) & found.valid & found.unbroken
        tick = int(np.argmax(beyond)) if beyond.any() else int(np.argmax(frames["route_s_m"]))
        got_m = float(frames["route_s_m"][tick]) if beyond.any() else found.reached_m
        t_s = float(frames["t_s"][tick])
        reached = bool(beyond.any())
        sentence = (
            f"it was at {self.what} at {t_s:.2f} s"
            if reached
            else f"it got to {got_m:.1f} m of its route{_off_route(played.history)}, "
            f"{self.s_m - got_m:.1f} m short of {self.what}"
        )
        return self.says(
            played, reached, sentence, tick=tick, measured=got_m, unit="m", limit=f"at least {self.s_m:.1f} m"
        )


class ReachesPoint(Criterion):
    """The ego's origin comes within ``radius_m`` of a point on the map (CARLA's frame)."""

    aspect = Aspect.COMPLETED

    def __init__(
        self, x_m: float, y_m: float, radius_m: float, what: str = "the place", *, deciding: bool = True
    ) -> None:
        super().__init__(deciding=deciding)
        self.x_m, self.y_m, self.radius_m, self.what = x_m, y_m, radius_m, what
        self.name = f"reaches {what}"

    def judge(self, played: Played) -> Judgement:
        """The figure is the least distance from the point."""
        frames = played.history.frames
        away_m = np.hypot(frames["x_m"] - self.x_m, frames["y_m"] - self.y_m)
        within = away_m <= self.radius_m
        tick = int(np.argmax(within)) if within.any() else int(np.argmin(away_m))
        least_m, t_s = float(away_m.min()), float(frames["t_s"][tick])
        sentence = (
            f"it was at {self.what} at {t_s:.2f} s"
            if within.any()
            else f"it came no nearer to {self.what} than {least_m:.1f} m, at {t_s:.2f} s"
        )
        limit = f"within {self.radius_m:g} m"
        return self.says(played, bool(within.any()), sentence, tick=tick, measured=least_m, unit="m", limit=limit)


class InTime(Criterion):
    """The scenario is over within ``limit_s`` of simulated time from the first frame; None: the scenario's own time.

    Over is when the phase "end" begins or the ego arrives. A drive that ended before its time for another reason, such
    as a collision, is neither in time nor late.
    """

    aspect = Aspect.COMPLETED
    name = "in time"

    def __init__(self, limit_s: float | None = None, *, deciding: bool = True) -> None:
        super().__init__(deciding=deciding)
        self.limit_s = limit_s

    def judge(self, played: Played) -> Judgement:
        """The figure is the time that it took."""
        t_s = played.history.frames["t_s"]
        limit_s = played.timeout_s if self.limit_s is None else self.limit_s
        ended = [tick for tick in (played.first_tick("end"), arrival_tick(played.history)) if tick is not None]
        last = min(ended, default=len(t_s) - 1)
        took_s = float(t_s[last] - t_s[0])
        late = took_s > limit_s or (not ended and _used_up(played, took_s, limit_s))
        limit = f"at most {limit_s:g} s"
        if late:
            sentence = (
                f"after {took_s:.2f} s it was {'over' if ended else 'not over yet'}, and {limit_s:g} s are allowed"
            )
            return self.says(played, False, sentence, tick=last, measured=took_s, unit="s", limit=limit)
        if not ended:
            sentence = f"it ended after {took_s:.2f} s of {limit_s:g} s before it was over: {played.outcome.message}"
            return self.says(played, None, sentence, measured=took_s, unit="s", limit=limit)
        sentence = f"it was over after {took_s:.2f} s of {limit_s:g} s"
        return self.says(played, True, sentence, tick=last, measured=took_s, unit="s", limit=limit)


def _used_up(played: Played, took_s: float, limit_s: float) -> bool:
    """Whether a drive that was never over was ended by its time, rather than by something else."""
    by_time = played.outcome.status in (Status.ROUTE_TIMEOUT, Status.ROUTE_BLOCKED)
    return by_time or took_s >= limit_s - 1.5 * played.history.facts.step_s
