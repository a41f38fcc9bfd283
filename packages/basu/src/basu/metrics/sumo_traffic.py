"""SUMO's traffic in a run: its load, its time loss, and actors that the vehicle under test met; reported, not scored.

Delay is SUMO's time loss, which is the cost of driving below the allowed speed (SUMO's documentation, "Simulation
Output: TripInfo", ``timeLoss``), here of all vehicles for each kilometre that they drove together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.metrics.json_schema import integer, number, record
from basu.metrics.registry import Drive, Metric, register

if TYPE_CHECKING:
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History
    from basu.records.history.sumo import SumoRecord

M_PER_KM = 1000.0


@register
class SumoTraffic(Metric):
    """SUMO's traffic and the passengers of the vehicle under test."""

    name = "sumo"
    title = "SUMO's traffic"
    order = 96
    has_figures = True
    schema = record(
        null_=True,
        about_="SUMO's traffic: docs/how-to/sumo.md; null for a run without SUMO",
        vehicles=record(
            about_="load, the vehicle under test left out",
            mean=number(low=0),
            most=integer(low=0),
            departed=integer(low=0),
            arrived=integer(low=0),
            delayed=integer(low=0),
            hidden=integer(low=0),
            met=integer(low=0),
        ),
        people=record(about_="on foot", mean=number(low=0), most=integer(low=0), met=integer(low=0)),
        mean_speed_mps=number("m/s", low=0, null=True),
        halted_share=number(low=0, high=1, null=True),
        lost_s_per_km=number("s/km", low=0, null=True),
        contacts=integer(low=0),
        passengers=record(
            about_="of the vehicle under test",
            came=integer(low=0),
            boarded=integer(low=0),
            alighted=integer(low=0),
            mean_wait_s=number("s", low=0, null=True),
        ),
    )

    def compute(self, drive: Drive) -> dict[str, Any] | None:
        """The figures; None for a run without SUMO."""
        found = drive.history.sumo
        return None if found is None else _figures(drive.history, found)

    def lines(self, result: JudgedRun) -> list[str]:
        """Load, delay and encounters; passengers where there were any."""
        value = result.metrics.get(self.name)
        if value is None:
            return []
        vehicles, people, passengers = value["vehicles"], value["people"], value["passengers"]
        lost = "" if value["lost_s_per_km"] is None else f", {value['lost_s_per_km']:.0f} s lost on each km"
        lines = [
            f"SUMO's traffic    {vehicles['mean']:.0f} vehicles and {people['mean']:.0f} people on foot{lost}",
            f"                  met {vehicles['met']} vehicles and {people['met']} people",
        ]
        if passengers["came"]:
            wait = "" if passengers["mean_wait_s"] is None else f", after {passengers['mean_wait_s']:.0f} s"
            lines.append(
                f"riders            {passengers['came']} came to the stops, {passengers['boarded']} boarded{wait}, "
                f"{passengers['alighted']} alighted"
            )
        return lines


def _figures(history: History, found: SumoRecord) -> dict[str, Any]:
    """The value of the metric."""
    seconds, count = found.seconds, max(1, len(found.seconds))
    vehicle_seconds, driven_m = sum(row.vehicles for row in seconds), sum(row.driven_m for row in seconds)
    time_s = sum(row.vehicles * since_s for row, since_s in _since(found))
    waits_s = [each.boarded_s - each.came_s for each in found.passengers if each.boarded_s is not None]
    met = [history.facts.actor_types.get(int(key), "") for key in sorted(set(history.others["id"].tolist()))]
    return {
        "vehicles": {
            "mean": vehicle_seconds / count,
            "most": max((row.vehicles for row in seconds), default=0),
            "departed": found.departed,
            "arrived": found.arrived,
            "delayed": found.delayed,
            "hidden": found.hidden,
            "met": sum(kind.startswith("vehicle.") for kind in met),
        },
        "people": {
            "mean": sum(row.people for row in seconds) / count,
            "most": max((row.people for row in seconds), default=0),
            "met": sum(kind.startswith("walker.") for kind in met),
        },
        "mean_speed_mps": driven_m / time_s if time_s else None,
        "halted_share": sum(row.halted for row in seconds) / vehicle_seconds if vehicle_seconds else None,
        "lost_s_per_km": sum(row.lost_s for row in seconds) / driven_m * M_PER_KM if driven_m else None,
        "contacts": found.contacts,
        "passengers": {
            "came": len(found.passengers),
            "boarded": len(waits_s),
            "alighted": sum(each.alighted_s is not None for each in found.passengers),
            "mean_wait_s": sum(waits_s) / len(waits_s) if waits_s else None,
        },
    }


def _since(found: SumoRecord) -> list[tuple[Any, float]]:
    """Each second with the time that it stands for."""
    times_s = [0.0, *(row.t_s for row in found.seconds)]
    return [(row, row.t_s - before_s) for row, before_s in zip(found.seconds, times_s, strict=False)]
