"""Speeding: stretches of driving above the posted limit, each one infraction."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, evidence
from basu.metrics.json_schema import number, record
from basu.metrics.registry import Column, Drive, Metric, register
from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.stretches import stretches

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.registry import JudgedRun
    from basu.records.history import History

ON_ROUTE_M = 2.0  # from the planned line; nearer than this the vehicle is on the plan's lane, and its limit holds
LEAST_S = 0.5  # an excess shorter than this is a sign just passed, not a way of driving


def speeding(history: History, tolerance_mps: float = TOLERANCE_MPS) -> tuple[Evidence, ...]:
    """One infraction for each episode: it begins ``tolerance_mps`` over and ends back at the limit.

    :func:`limits_mps` says which limit holds.
    """
    speed_mps, limit_mps = history.speed_mps(), limits_mps(history)
    found = []
    for first, end in episodes(speed_mps, limit_mps, tolerance_mps):
        if (end - first) * history.facts.step_s < LEAST_S:
            continue
        fastest = first + int(np.argmax(speed_mps[first:end] - limit_mps[first:end]))
        found.append(
            episode(
                history,
                first,
                top_mps=float(speed_mps[fastest]),
                posted_mps=float(limit_mps[fastest]),
                seconds=(end - first) * history.facts.step_s,
            )
        )
    return tuple(found)


def episode(history: History, first: int, *, top_mps: float, posted_mps: float, seconds: float) -> Evidence:
    """The evidence for an episode that begins in frame ``first``; its speed is that of the largest excess."""
    return evidence(
        history,
        Infraction.SPEEDING,
        first,
        speed_mps=top_mps,
        other=None,
        detail=f"up to {top_mps:.2f} m/s where {posted_mps:.2f} m/s are posted, for {seconds:.1f} s",
    )


def limits_mps(history: History) -> NDArray[np.float64]:
    """(T,) the limit that holds in each frame, inf where there is none.

    On the planned lane it is the map's limit of that lane. Elsewhere, and where the map posts none, it is what the
    simulator posts to the vehicle: in a junction, where lanes lie over one another, a simulator may mean any of them.
    """
    route = history.facts.route
    posted = history.frames["speed_limit_mps"].astype(np.float64)
    index = np.clip(np.searchsorted(route.s_m, history.frames["route_s_m"], side="right") - 1, 0, None)
    planned = route.speed_limit_mps[index]
    off_route = np.abs(history.frames["lateral_m"]) > ON_ROUTE_M
    elsewhere = np.where(posted > 0.0, posted, np.inf)
    return np.where(off_route | np.isnan(planned), elsewhere, planned)


def episodes(
    speed_mps: NDArray[np.float64], limit_mps: NDArray[np.float64], tolerance_mps: float
) -> list[tuple[int, int]]:
    """(first, end) of each stretch that exceeds the tolerance somewhere and the limit throughout."""
    beyond = speed_mps > limit_mps + tolerance_mps
    found = []
    for first, end in stretches(speed_mps > limit_mps):
        if beyond[first:end].any():
            found.append((first + int(np.argmax(beyond[first:end])), end))
    return found


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
        """Time and excess."""
        excess_mps = drive.history.speed_mps() - limits_mps(drive.history)
        beyond = excess_mps > drive.scoring.speeding_tolerance_mps
        return {
            "seconds": float(np.count_nonzero(beyond) * drive.history.facts.step_s),
            "largest_excess_mps": float(excess_mps[beyond].max(initial=0.0)),
        }

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Each episode."""
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
        """The number of episodes."""
        episodes_found = sum(found.kind is Infraction.SPEEDING for found in result.infractions)
        return [Column("speeding", str(episodes_found))]
