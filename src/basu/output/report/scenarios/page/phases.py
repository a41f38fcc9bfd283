"""The phases of a case on a line of time, and the moment that was nearest."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.markup import e, percent
from basu.output.report.plots.chart import share, times

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

PHASES = {  # as a scenario passes them, and what the line calls each
    "setup": "set-up",
    "trigger": "before",
    "conflict": "conflict",
    "resolution": "resolution",
}
LEAST_SHARE = 0.09  # of the line; the name of a shorter phase would not fit in it


def phase_line(result: dict[str, Any]) -> Element | None:
    """The line; None where no phase began."""
    begun_s: dict[str, float] = result["phases_s"]
    if not begun_s:
        return None
    begin_s = min(begun_s.values())
    end_s = max(begun_s.get("end", begin_s + result["simulated_s"]), *begun_s.values(), begin_s + 0.1)
    order = [name for name in PHASES if name in begun_s]
    line = e("div", class_="phases")
    told = []
    for name, following in zip(order, [*order[1:], None], strict=True):
        from_s = begun_s[name]
        to_s = end_s if following is None else begun_s[following]
        part = (to_s - from_s) / (end_s - begin_s)
        if part <= 0.0:
            continue
        words = f"{PHASES[name]} from {from_s:.1f} s to {to_s:.1f} s"
        told.append(words)
        style = f"left:{share(from_s, begin_s, end_s)};width:{percent(part)}"
        label = PHASES[name] if part >= LEAST_SHARE else None
        line.append(e("i", label, class_=f"phase {name}", style=style, title=words))
    line.extend(_moments(result, begin_s, end_s))
    return e("div", line, times(begin_s, end_s), class_="phase-line", role="img", aria_label="; ".join(told))


def _moments(result: dict[str, Any], begin_s: float, end_s: float) -> list[Element]:
    """When the criteria that failed decided."""
    return [
        e(
            "b",
            "✗",
            class_="moment-of failed",
            style=f"left:{share(judgement['t_s'], begin_s, end_s)}",
            title=f"{judgement['criterion']} at {judgement['t_s']:.1f} s",
        )
        for judgement in result["judgements"]
        if judgement["passed"] is False and judgement["deciding"] and judgement["t_s"] is not None
    ]
