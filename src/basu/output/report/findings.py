"""All that a result tells with place, time and a sentence: infractions by number, what is not scored by letter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from basu.output.report.markup import words

PARTS_WITH_EVENTS = ("route_deviation", "outside_lanes", "wrong_way", "disengagements", "delays")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One of them."""

    label: str  # 1, 2, 3 for infractions, a, b, c for the rest
    anchor: str  # its name in the page
    kind: str
    factor: float | None  # on the infraction score; None where it is not scored
    tick: int
    t_s: float
    x_m: float
    y_m: float
    speed_mps: float | None
    route_s_m: float
    other: str | None
    detail: str

    @property
    def title(self) -> str:
        """It in a line."""
        what = "Event" if self.factor is None else "Infraction"
        return f"{what} {self.label}: {words(self.kind)} at {self.t_s:.1f} s"


def findings(document: dict[str, Any]) -> tuple[Finding, ...]:
    """All of a result: first the infractions, then the rest, each in order of time."""
    penalties = document["scoring"]["penalties"]
    scored = [
        _finding(str(number), f"infraction-{number}", penalties.get(row["kind"], 1.0), row)
        for number, row in enumerate(document["infractions"], start=1)
    ]
    events = [row for part in PARTS_WITH_EVENTS for row in (document.get(part) or {}).get("events", [])]
    events += _felt(document.get("passengers") or {})
    events.sort(key=lambda row: (row["t_s"], row["kind"]))
    rest = [_finding(_letters(number), f"event-{_letters(number)}", None, row) for number, row in enumerate(events)]
    return (*scored, *rest)


def _finding(label: str, anchor: str, factor: float | None, row: dict[str, Any]) -> Finding:
    """A row of a result."""
    return Finding(
        label=label,
        anchor=anchor,
        kind=row["kind"],
        factor=factor,
        tick=row["tick"],
        t_s=row["t_s"],
        x_m=row["x_m"],
        y_m=row["y_m"],
        speed_mps=row.get("speed_mps"),
        route_s_m=row["route_s_m"],
        other=row.get("other"),
        detail=row["detail"],
    )


def _felt(passengers: dict[str, Any]) -> list[dict[str, Any]]:
    """What the passengers hold against the ride: harsh stops at their onset, near misses."""
    stops = [
        {
            **stop,
            "kind": "phantom_stop" if stop["cause"]["kind"] == "nothing" else "harsh_stop",
            "tick": stop["onset_tick"],
            "speed_mps": stop["from_mps"],
            "detail": f"from {stop['from_mps']:.2f} m/s, felt up to {stop['strongest_mps2']:.2f} m/s²: "
            f"{stop['cause']['detail']}",
        }
        for stop in passengers.get("harsh_stops", ())
    ]
    misses = [
        {**party, "kind": "near_miss", "other": party["name"]}
        for party in passengers.get("near_misses", ())
        if party["is_near_miss"]
    ]
    return [*stops, *misses]


def _letters(number: int) -> str:
    """0, 1, 2, ... 25, 26 as a, b, c, ... z, aa."""
    text = ""
    number += 1
    while number:
        number, digit = divmod(number - 1, 26)
        text = chr(ord("a") + digit) + text
    return text
