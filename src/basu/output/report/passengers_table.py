"""What the passengers have to say, as lines of the console's table."""

from __future__ import annotations

from typing import Any


def felt(document: dict[str, Any]) -> list[str]:
    """The verdict with its reasons, and the figures behind the comfort score."""
    passengers = document.get("passengers")
    if passengers is None:
        return []
    comfort = passengers["comfort_score"]
    said = "passed" if passengers["passed"] else "failed"
    score = "" if comfort is None else f", comfort score {comfort:.3f} (0 to 1, not in the driving score)"
    largest, balance = passengers["largest"], passengers["balance"]
    return [
        f"passengers        {said}{score}",
        *(f"                  {reason}" for reason in passengers["reasons"]),
        (
            f"                  up to {largest['braking_mps2']:.2f} m/s² braking, {largest['across_mps2']:.2f} across; "
            f"one has to step {100.0 * balance['step_share']:.1f} % of the time; "
            f"{' or '.join(passengers['vibration']['reactions'])}"
        ),
        *_service(passengers["service"]),
    ]


def _service(visits: list[dict[str, Any]]) -> list[str]:
    """How the timetable was kept."""
    planned = [visit for visit in visits if visit["on_time"] is not None]
    if not planned:
        return []
    delays = [visit["delay_s"] for visit in planned if visit["delay_s"] is not None]
    worst = f", {min(delays):+.0f} to {max(delays):+.0f} s" if delays else ""
    return [f"timetable         {sum(visit['on_time'] for visit in planned)} of {len(planned)} stops on time{worst}"]
