"""Speeding: episodes of driving above the posted limit; an infraction for each started share of way gained by it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, evidence
from basu.metrics.json_schema import number, record
from basu.metrics.registry import Column, Drive, Metric, register
from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.validity import in_planned_lane

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from basu.metrics.registry import JudgedRun, Watcher
    from basu.metrics.scoring import Scoring
    from basu.records.history import History

LEAST_S = 0.5  # an excess shorter than this is a sign just passed, not a way of driving
SHARE_M = 2.23 * 15.0
"""Way gained on the limit that one infraction stands for, the excess summed over time.

nuPlan's speed limit compliance is 0 for an excess of 2.23 m/s (5 mph) in the mean of a scenario of 15 s."""


@dataclass(slots=True)
class Excess:
    """A piece of an episode above the limit: one infraction."""

    first: int
    end: int  # the frame after its last one
    top_mps: float  # the speed of its largest excess, the earliest of equal ones
    posted_mps: float  # the limit there
    gained_m: float  # on a vehicle at the limit

    def evidence(self, history: History, tick: int) -> Evidence:
        """The evidence for it; ``tick`` is its first frame in ``history``, and its speed that of the largest excess."""
        seconds = (self.end - self.first) * history.facts.step_s
        return evidence(
            history,
            Infraction.SPEEDING,
            tick,
            speed_mps=self.top_mps,
            other=None,
            detail=f"up to {self.top_mps:.2f} m/s where {self.posted_mps:.2f} m/s are posted, for {seconds:.1f} s",
        )


class EpisodeFinder:
    """Finds episodes frame by frame: one begins above the tolerance, and ends back at the limit.

    It is cut into pieces: one ends where `SHARE_M` was gained on the limit. ``pieces`` are those of the open episode.
    """

    def __init__(self, tolerance_mps: float, step_s: float) -> None:
        self.pieces: list[Excess] = []
        self._tolerance_mps, self._step_s = tolerance_mps, step_s

    def step(self, tick: int, speed_mps: float, limit_mps: float) -> list[Excess]:
        """Take in a frame and return the pieces of the episode that it ended; none for one that goes on."""
        if not exceeds(speed_mps, limit_mps, self._tolerance_mps, bool(self.pieces)):
            ended, self.pieces = self.counted(), []
            return ended
        if not self.pieces or is_whole(self.pieces[-1].gained_m):
            self.pieces.append(Excess(tick, tick, speed_mps, limit_mps, 0.0))
        piece = self.pieces[-1]
        piece.end, piece.gained_m = tick + 1, piece.gained_m + (speed_mps - limit_mps) * self._step_s
        if speed_mps - limit_mps > piece.top_mps - piece.posted_mps:
            piece.top_mps, piece.posted_mps = speed_mps, limit_mps
        return []

    def counted(self) -> list[Excess]:
        """The pieces of the open episode; none where it is too short to count."""
        if not self.pieces or not lasts(self.pieces[0].first, self.pieces[-1].end, self._step_s):
            return []
        return self.pieces


# For numbers, and for arrays of the vehicles of `linden_gym`.


def exceeds(speed_mps: Any, limit_mps: Any, tolerance_mps: float, is_open: Any) -> Any:  # noqa: ANN401 - either
    """Return whether a frame belongs to an episode, where ``is_open`` says that one goes on."""
    return (speed_mps > limit_mps) & (is_open | (speed_mps > limit_mps + tolerance_mps))


def is_whole(gained_m: Any) -> Any:  # noqa: ANN401 - a number or an array
    """Return whether a piece has its whole way, so that another one begins."""
    return gained_m >= SHARE_M


def lasts(first_tick: Any, end_tick: Any, step_s: float) -> Any:  # noqa: ANN401 - numbers or arrays
    """Return whether an episode is long enough to count."""
    return (end_tick - first_tick) * step_s >= LEAST_S


def speeding(history: History, tolerance_mps: float = TOLERANCE_MPS) -> tuple[Evidence, ...]:
    """One infraction for each started `SHARE_M` of an episode; `limits_mps` returns the limit that holds."""
    found = episodes(history.speed_mps(), limits_mps(history), tolerance_mps, history.facts.step_s)
    return tuple(piece.evidence(history, piece.first) for pieces in found for piece in pieces)


def episodes(
    speed_mps: NDArray[np.float64], limit_mps: NDArray[np.float64], tolerance_mps: float, step_s: float
) -> list[list[Excess]]:
    """The pieces of each episode that is long enough to count."""
    episode, found = EpisodeFinder(tolerance_mps, step_s), []
    for tick, (speed, limit) in enumerate(zip(speed_mps.tolist(), limit_mps.tolist(), strict=True)):
        found.append(episode.step(tick, speed, limit))
    return [pieces for pieces in (*found, episode.counted()) if pieces]


def limits_mps(history: History) -> NDArray[np.float64]:
    """(T,) the limit that holds in each frame, inf where there is none.

    On the planned lane it is the map's limit of that lane. Elsewhere, and where the map posts none, it is what the
    simulator posts to the vehicle: in a junction, where lanes lie over one another, a simulator may mean any of them.
    """
    route = history.facts.route
    posted = history.frames["speed_limit_mps"].astype(np.float64)
    index = np.clip(np.searchsorted(route.s_m, history.frames["route_s_m"], side="right") - 1, 0, None)
    return holding_mps(route.speed_limit_mps[index], posted, in_planned_lane(history))


def holding_mps(
    planned_mps: NDArray[np.float64], posted_mps: NDArray[np.float64], in_lane: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return (T,) the limits that hold, of the planned lane (nan for none) and posted to the vehicle (0 for none)."""
    elsewhere = np.where(posted_mps > 0.0, posted_mps, np.inf)
    return np.where(~in_lane | np.isnan(planned_mps), elsewhere, planned_mps)


class SpeedingSoFar:
    """The infractions until now; ``pending`` holds those of the episode that goes on."""

    def __init__(self, tolerance_mps: float) -> None:
        self.settled: list[Evidence] = []
        self.pending: list[Evidence] = []
        self._tolerance_mps = tolerance_mps
        self._seen = 0  # frames looked at
        self._episode: EpisodeFinder | None = None

    def look(self, window: Callable[[int], History]) -> None:
        """Take in the frames that are new."""
        history = window(self._seen)
        episode = self._episode = self._episode or EpisodeFinder(self._tolerance_mps, history.facts.step_s)
        speeds, limits = history.speed_mps().tolist(), limits_mps(history).tolist()
        for tick, (speed_mps, limit_mps) in enumerate(zip(speeds, limits, strict=True), self._seen):
            self.settled += _evidence(window, episode.step(tick, speed_mps, limit_mps))
        self._seen += len(speeds)
        self.pending = _evidence(window, episode.counted())


def _evidence(window: Callable[[int], History], pieces: Sequence[Excess]) -> list[Evidence]:
    """The evidence for pieces of an episode."""
    return [replace(piece.evidence(window(piece.first), 0), tick=piece.first) for piece in pieces]


@register
class Speeding(Metric):
    """How long and by how much the vehicle was too fast."""

    name = "speeding"
    title = "speeding"
    order = 40
    schema = record(
        null_=True,
        about_="above the limit by more than the tolerance",
        seconds=number("s", low=0),
        largest_excess_mps=number("m/s", low=0),
    )
    penalties: ClassVar[dict[str, float]] = {Infraction.SPEEDING.value: DEFAULT_PENALTIES[Infraction.SPEEDING]}

    def compute(self, drive: Drive) -> dict[str, float]:
        """Return the time above the limit and the largest excess."""
        excess_mps = drive.history.speed_mps() - limits_mps(drive.history)
        beyond = excess_mps > drive.scoring.speeding_tolerance_mps
        return {
            "seconds": float(np.count_nonzero(beyond) * drive.history.facts.step_s),
            "largest_excess_mps": float(excess_mps[beyond].max(initial=0.0)),
        }

    def watch(self, scoring: Scoring) -> Watcher:
        """Return what finds the events while a drive lasts."""
        return SpeedingSoFar(scoring.speeding_tolerance_mps)

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Each infraction, in the order of time."""
        return speeding(drive.history, drive.scoring.speeding_tolerance_mps)

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where it happened."""
        found = result.metrics[self.name]
        if not found["seconds"]:
            return []
        return [
            f"{self.title:<18}{found['seconds']:.1f} s, up to {found['largest_excess_mps']:.2f} m/s above the limit"
        ]

    def columns(self, result: JudgedRun) -> list[Column]:
        """Return the number of infractions."""
        number_found = sum(found.kind is Infraction.SPEEDING for found in result.infractions)
        return [Column("speeding", str(number_found))]
