"""Figures of a drive that enter no score: its length, lane invasions, the largest offset, the top speed; its stops."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from basu.metrics.json_schema import flag, integer, listing, mapping, number, record, text
from basu.metrics.path_following import near_stop, path_following, serving
from basu.metrics.registry import Drive, Metric, TimedMark, register
from basu.metrics.stretches import spans

if TYPE_CHECKING:
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History


class LaneInvasions(NamedTuple):
    """The count, and the count by what was crossed."""

    total: int
    by_marking: tuple[tuple[str, int], ...]  # `type/colour` and number, by name


def lane_invasions(history: History) -> LaneInvasions:
    """Count events, not corners: two corners over one line in one frame are one invasion.

    Lane invasions are reported and never scored (section 5.2.2 of the thesis).
    """
    by_marking = Counter(marking for event in history.lane_invasions for marking in sorted(set(event.markings)))
    return LaneInvasions(len(history.lane_invasions), tuple(sorted(by_marking.items())))


@register
class Reported(Metric):
    """Figures of the whole drive."""

    name = "reported"
    title = "reported, not scored"
    order = 0
    has_figures = True
    timeline_row = "lane lines crossed"
    schema = record(
        null_=True,
        about_="figures that enter no score",
        driven_m=number("m", low=0),
        planned_m=number("m", low=0),
        route_completion=number(low=0, high=1),
        lane_invasions=record(
            null_=True,
            about_="null in a case, which does not listen to them",
            total=integer(low=0),
            by_marking=mapping(integer(low=0)),
        ),
        largest_lateral_m=number("m", low=0),
        top_speed_mps=number("m/s", low=0),
    )

    def compute(self, drive: Drive) -> dict[str, Any]:
        """Return the figures that the route reports."""
        frames, invasions, path = drive.history.frames, lane_invasions(drive.history), path_following(drive.history)
        return {
            "driven_m": path.driven_m,
            "planned_m": path.planned_m,
            "route_completion": min(1.0, path.valid_m / path.planned_m),
            "lane_invasions": {"total": invasions.total, "by_marking": dict(invasions.by_marking)}
            if drive.hears_lane_invasions
            else None,
            "largest_lateral_m": float(np.abs(frames["lateral_m"]).max()),
            "top_speed_mps": float(drive.history.speed_mps().max()),
        }

    def lines(self, result: JudgedRun) -> list[str]:
        """Return a line with the lane invasions and the way."""
        found = result.metrics[self.name]
        lanes = found["lane_invasions"]
        way = f"{found['driven_m'] / 1000.0:.3f} km of {found['planned_m'] / 1000.0:.3f} km"
        invasions = [] if lanes is None else [f"{'lane invasions':<18}{lanes['total']} (reported, not scored)"]
        return [*invasions, f"{'driven':<18}{way:>8}"]

    def moments(self, result: JudgedRun, history: History) -> list[TimedMark]:  # noqa: ARG002 - of the record
        """Return each lane invasion."""
        times_s = [(float(history.frames["t_s"][event.tick]), event) for event in history.lane_invasions]
        return [
            TimedMark(t_s, None, f"{', '.join(event.markings)} at {t_s:.1f} s", "", "stroke") for t_s, event in times_s
        ]

    def series(self, value: Any) -> dict[str, Any]:  # noqa: ANN401 - as `schema` says
        """Return the way."""
        found = value or {}
        return {"driven_m": found.get("driven_m", 0.0), "planned_m": found.get("planned_m")}


@register
class ServiceStops(Metric):
    """Each service stop of the route: was it served, and how slow did the vehicle get there?"""

    name = "stops"
    title = "service stops"
    order = 25
    timeline_row = "service stops"
    schema = listing(
        record(
            id=text(),
            name=text(),
            route_s_m=number("m"),
            lowest_speed_mps=number("m/s", low=0, null=True),
            rest_s=number("s", low=0),
            served=flag(),
        ),
        "the service stops",
    )
    nothing: ClassVar[list[Any]] = []

    def compute(self, drive: Drive) -> list[dict[str, Any]]:
        """A row for each stop."""
        history, speed_mps, rows = drive.history, drive.history.speed_mps(), []
        for stop in history.facts.route.stops:
            near, rests = near_stop(history, stop.s_m), serving(history, stop.s_m)
            rows.append(
                {
                    "id": stop.id,
                    "name": stop.name,
                    "route_s_m": stop.s_m,
                    "lowest_speed_mps": float(speed_mps[near].min()) if near.any() else None,
                    "rest_s": float(np.count_nonzero(rests) * history.facts.step_s),
                    "served": bool(rests.any()),
                }
            )
        return rows

    def lines(self, result: JudgedRun) -> list[str]:
        """Return a line with the number of stops that were served."""
        stops = result.metrics[self.name]
        served = sum(stop["served"] for stop in stops)
        return [f"service stops     {served} of {len(stops)} served"] if stops else []

    def moments(self, result: JudgedRun, history: History) -> list[TimedMark]:  # noqa: ARG002 - of the record
        """Return the stretches at rest at each stop."""
        found = [
            span._replace(label=stop.id)
            for stop in history.facts.route.stops
            for span in spans(history, serving(history, stop.s_m), f"{stop.id}, {stop.name}", "service")
        ]
        return sorted(found)
